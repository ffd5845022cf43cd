"""A terminal for tests: a pty in which a command runs, with keys to press and a screen to read, drawn by pyte."""

from __future__ import annotations

import fcntl
import os
import pty
import shlex
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pyte

from btlang.support.user_dirs import user_dir

REPOSITORY = Path(__file__).parent.parent.parent
BTC = (sys.executable, "-m", "btlang")

_LOOK_AGAIN = 0.05
_PATIENCE = 30.0
_KEYS = {
    "Space": " ", "Enter": "\r", "Tab": "\t", "BSpace": "\x7f", "Escape": "\x1b", "F4": "\x1bOS",
    "Up": "\x1b[A", "Down": "\x1b[B", "Right": "\x1b[C", "Left": "\x1b[D", "C-\\": "\x1c",
}  # fmt: skip


class Terminal:
    """A terminal that sees none of the user's settings, files and environment.

    `command` runs in `folder`; without one a shell waits for commands. When the command ends the screen stays, with
    `[status N]` below it. `environment` adds variables; `HOME` is an empty folder. Close it, or use it in a `with`
    statement.
    """

    def __init__(
        self,
        *command: str,
        width: int = 80,
        height: int = 24,
        folder: Path = REPOSITORY,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self._home = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        clean = {
            "PATH": os.environ["PATH"],
            "HOME": self._home.name,
            "LANG": "C.UTF-8",
            "PS1": "$ ",
            "SHELL": "/bin/sh",
            "XDG_CACHE_HOME": str(Path(user_dir("cache")).parent),  # words are read once, not in each home
        }
        clean |= {"PYTHONPATH": str(REPOSITORY), "TERM": "xterm-256color"} | dict(environment or {})
        self._screen = _Screen(width, height, self._answer)
        self._stream = pyte.ByteStream(self._screen)
        self._reading = threading.Lock()  # of the screen
        self._master, self._slave = (
            pty.openpty()
        )  # the latter stays open until the end, else reading may find nobody there
        self._set_size(width, height)
        shell = "exec sh"
        if command:
            shell = f"trap : INT QUIT; {shlex.join(command)}; printf '[status %s]\\n' $?; exec sleep 1000"
        tty = shlex.quote(os.ttyname(self._slave))  # the leader of a session that opens a terminal gets it for its own
        self._process = subprocess.Popen(
            ["sh", "-c", f"exec <{tty} >{tty} 2>&1; {shell}"], cwd=folder, env=clean, start_new_session=True
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self) -> Terminal:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends all that runs in it."""
        for name in os.listdir("/proc"):
            if name.isdigit() and _session(int(name)) == self._process.pid:
                os.kill(int(name), signal.SIGKILL)
        self._process.wait()
        os.close(self._slave)
        self._reader.join()
        os.close(self._master)
        self._home.cleanup()

    # What the user does

    def press(self, *keys: str) -> None:
        """Presses keys by their names: `Space`, `q`, `C-c`, `M-q`, `Up`, `Enter`, `Tab`."""
        for key in keys:
            if key in _KEYS:
                self._write(_KEYS[key])
            elif key.startswith("C-"):
                self._write(chr(ord(key[2].upper()) - 64))
            else:
                self._write("\x1b" + key[2:] if key.startswith("M-") else key)

    def type(self, text: str, enter: bool = True) -> None:
        """Types a text as it is, then Enter."""
        self._write(text)
        if enter:
            self.press("Enter")

    def resize(self, width: int, height: int) -> None:
        """Makes the window another size."""
        with self._reading:
            self._screen.resize(height, width)
        self._set_size(width, height)

    # What the user sees

    def screen(self) -> str:
        """The lines on the screen without blanks at their ends."""
        with self._reading:
            return _text([self._screen.text(self._screen.buffer[row]) for row in range(self._screen.lines)])

    def colours(self) -> set[str]:
        """The names of the colours of all characters on the screen."""
        with self._reading:
            return {cell.fg for row in self._screen.buffer.values() for cell in row.values()}

    def history(self) -> str:
        """What a user sees who scrolls up, and the screen. Lines that were wrapped are one line."""
        with self._reading:
            shown = self._screen
            rows = [*shown.history.top, *(shown.buffer[row] for row in range(shown.lines))]
            text = "".join(shown.text(row) + "\n" * (not hasattr(row, "goes_on")) for row in rows)
        return _text(text.split("\n"))

    @property
    def cursor_shown(self) -> bool:
        """Whether the cursor is visible."""
        return not self._screen.cursor.hidden

    def wait_for(self, text: str, seconds: float = _PATIENCE) -> str:
        """The screen, once the text is on it. Fails after some seconds."""
        return self.wait_until(lambda screen: text in screen, f"the text {text!r}", seconds)

    def wait_until(self, holds: Callable[[str], bool], what: str = "it", seconds: float = _PATIENCE) -> str:
        """The screen, once a condition holds for it. Fails after some seconds, and shows what was on it."""
        end = time.monotonic() + seconds
        while True:
            screen = self.screen()
            if holds(screen):
                return screen
            if time.monotonic() > end:
                raise AssertionError(f"waited in vain for {what}; the screen is:\n{screen}")
            time.sleep(_LOOK_AGAIN)

    def wait_for_end(self, seconds: float = _PATIENCE) -> int:
        """The exit status of the command that the terminal was opened with, once it has ended."""
        screen = self.wait_for("[status ", seconds)
        return int(screen.rsplit("[status ", 1)[1].split("]")[0])

    def _read(self) -> None:
        while True:
            try:
                data = os.read(self._master, 65536)
            except OSError:  # nobody has the other end open any more
                return
            if not data:
                return
            with self._reading:
                self._stream.feed(data)

    def _answer(self, text: str) -> None:
        """What a terminal says of itself when it is asked."""
        os.write(self._master, text.encode())

    def _write(self, text: str) -> None:
        os.write(self._master, text.encode())

    def _set_size(self, width: int, height: int) -> None:
        fcntl.ioctl(self._master, termios.TIOCSWINSZ, struct.pack("HHHH", height, width, 0, 0))


class _Screen(pyte.HistoryScreen):
    """Hands the answers to what programs ask of a terminal to `answer`, and marks lines that go on in the next."""

    def __init__(self, width: int, height: int, answer: Callable[[str], object]) -> None:
        self._drawing = False
        self._answer = answer
        super().__init__(width, height, history=10_000)

    def write_process_input(self, data: str) -> None:
        self._answer(data)

    def draw(self, data: str) -> None:
        self._drawing = True
        super().draw(data)
        self._drawing = False

    def linefeed(self) -> None:
        if self._drawing:
            self.buffer[self.cursor.y].goes_on = True  # type: ignore[attr-defined]
        super().linefeed()

    def text(self, row: Mapping[int, Any]) -> str:
        """All characters of a line, blanks included."""
        return "".join(row[column].data for column in range(self.columns))


def _text(lines: list[str]) -> str:
    return "\n".join(line.rstrip() for line in lines).rstrip("\n") + "\n"


def _session(process: int) -> int:
    try:
        return os.getsid(process)
    except ProcessLookupError:
        return 0
