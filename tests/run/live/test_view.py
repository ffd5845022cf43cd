"""The view and its keys on a pseudo terminal."""

from __future__ import annotations

import fcntl
import io
import os
import pty
import re
import struct
import termios
import threading
from collections.abc import Callable, Iterator

import pytest

import btlang
from btlang.api import Mission
from btlang.engine.status import SUCCESS
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.run.live.keys import Keys
from btlang.run.live.screen import Capture
from btlang.run.live.view import LiveView
from btlang.tree.node import Node, Tree
from tests.profiles import amount
from tests.trial import Trial


class Pty:
    """A terminal of 80 x 24 whose screen a thread reads."""

    def __init__(self) -> None:
        self.master, self.slave = pty.openpty()
        fcntl.ioctl(self.slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        self.file = os.fdopen(self.slave, "w", encoding="utf-8", closefd=False)
        self._seen: list[bytes] = []
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        try:
            while data := os.read(self.master, 65536):
                self._seen.append(data)
        except OSError:
            return

    def close(self) -> str:
        """What was written, without colours."""
        if self.slave >= 0:
            os.close(self.slave)
            self.slave = -1
            self._reader.join()
            os.close(self.master)
        return re.sub(r"\x1b\[[0-9;]*m", "", b"".join(self._seen).decode())


@pytest.fixture
def terminal() -> Iterator[Pty]:
    made = Pty()
    yield made
    made.close()


@pytest.mark.long
def test_a_tree_of_any_depth(terminal: Pty) -> None:
    depth = amount(3000, 10_000)  # the paths of all nodes are told, which takes the square of it
    root = Node("AlwaysSuccess")
    for _ in range(depth):
        root = Node("ForceSuccess", (root,))
    trial = Trial(Mission(Tree(root), world_vocabulary()))
    with LiveView(trial.mission, trial.controls, terminal.file) as view:
        assert trial.run(speed="max", sinks=[view]).status == SUCCESS
    assert trial.sink_errors == []
    assert re.search(rf"✓ ForceSuccess  \({depth // 100 - 1}\d\d nodes\)", terminal.close())


def test_from_another_thread(terminal: Pty) -> None:
    trial = Trial("wave then nod")

    def run() -> None:
        with LiveView(trial.mission, trial.controls, terminal.file) as view:
            trial.run(speed="max", sinks=[view])

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    written = terminal.close()
    assert "✓" in written
    assert "done   nod" in written


def test_a_terminal_that_goes_away_does_not_stop_the_mission() -> None:
    terminal = Pty()
    trial = Trial("wave then nod")
    view = LiveView(trial.mission, trial.controls, terminal.file)
    with view:
        terminal.file.close()
        assert trial.run(speed="max", sinks=[view]).status == SUCCESS
    terminal.close()


def press(terminal: Pty, keys: bytes, wait_for: Callable[[], bool]) -> None:
    os.write(terminal.master, keys)
    for _ in range(1000):
        if wait_for():
            return
        threading.Event().wait(0.01)
    raise AssertionError("waited in vain")


def test_keys_come_at_once_and_sequences_do_not(terminal: Pty) -> None:
    pressed: list[str] = []
    before = termios.tcgetattr(terminal.slave)
    keys = Keys(terminal.slave, pressed.append)
    keys.begin()
    assert not termios.tcgetattr(terminal.slave)[3] & termios.ECHO
    press(terminal, b"s \x1b[A\x1bOS\x1bsq", lambda: "q" in pressed)
    keys.end()
    assert pressed == ["s", " ", "q"]
    assert termios.tcgetattr(terminal.slave) == before


def test_a_terminal_that_cannot_be_read() -> None:
    reading, writing = os.pipe()
    with pytest.raises(OSError, match=r"."):
        Keys(reading, print)
    os.close(reading)
    os.close(writing)


def test_the_view_has_keys_only_where_there_is_a_keyboard(terminal: Pty) -> None:
    trial = Trial("wave")
    with LiveView(trial.mission, trial.controls, terminal.file, io.StringIO()) as view:
        trial.run(speed="max", sinks=[view])
    assert "✓ wave" in terminal.close()


def test_a_captured_stream_is_like_the_real_one(terminal: Pty) -> None:
    lines: list[str] = []
    capture = Capture(terminal.file, lines.append)
    print("one\ntwo", end="", file=capture)
    assert lines == ["one"]
    capture.flush()
    capture.finish()
    assert lines == ["one", "two"]
    assert (capture.encoding, capture.isatty(), capture.fileno()) == ("utf-8", True, terminal.slave)
    assert capture.writable()
    assert capture.errors == terminal.file.errors


def test_a_slow_action_is_told_above_the_tree(terminal: Pty) -> None:
    @btlang.action("dawdle")
    def dawdle() -> None:
        threading.Event().wait(0.12)

    trial = Trial("dawdle", keywords=[dawdle])
    with LiveView(trial.mission, trial.controls, terminal.file) as view:
        trial.run(sinks=[view])
    assert trial.sink_errors == []
    assert "slow   dawdle: took 0.1" in terminal.close()
