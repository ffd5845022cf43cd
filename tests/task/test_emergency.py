"""The emergency stop where the usual ways to the robot are gone: no process, no sockets, a latch that is no file."""

from __future__ import annotations

import os
import shutil
import socket
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.task.commands import socket_server
from btlang.task.commands.client import data_folder, socket_path
from btlang.task.commands.socket_server import SocketServer
from btlang.task.execution.emergency import EmergencyLatch, latch_path, shut_latch
from btlang.task.messages import Answer
from btlang.task.store.records import TaskState

from .layers import ask, layer_in, robot_up, submit, wait_for, wait_until


@pytest.fixture
def folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where robots keep what belongs to them; its path is short, for sockets."""
    with tempfile.TemporaryDirectory() as short:
        for variable, name in (("XDG_RUNTIME_DIR", "r"), ("XDG_DATA_HOME", "d")):
            Path(short, name).mkdir(mode=0o700)
            monkeypatch.setenv(variable, str(Path(short, name)))
        yield Path(short)


def test_a_stop_between_a_crash_and_the_next_start(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with layer_in(Path(data_folder("q"))) as layer:
        ask(layer, "pause")
        number = submit(layer, "go to the lab")
    assert main(["robot", "stop", "--name", "q", "--reason", "smoke"]) == 0
    assert "it stays stopped when it comes up" in capsys.readouterr().out
    with layer_in(Path(data_folder("q"))) as layer:
        assert layer.emergency.reason.endswith(": smoke")
        ask(layer, "resume")
        again = layer.handle({"command": "resume"}, "ann")
        assert again.text == "Nothing was paused. The robot is stopped until 'release'."
        assert layer.store.task(number).state is TaskState.QUEUED  # type: ignore[union-attr]
        ask(layer, "release")
        wait_for(layer, number, TaskState.COMPLETED)


def test_a_stop_of_nobody(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["--name", "nobody"], []):
        assert main(["robot", "stop", *words]) == 2
        assert "BT185" in capsys.readouterr().err


def answer_of(path: str) -> bytes:
    """What somebody is told who connects to a socket, b"" while it doesn't listen yet."""
    with socket.socket(socket.AF_UNIX) as connection, suppress(ConnectionRefusedError):
        connection.connect(path)
        return connection.recv(16)
    return b""


def test_a_robot_whose_sockets_were_taken_away(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with robot_up(Path(data_folder("q")), "q") as layer:
        wait_for(layer, submit(layer, "repeat 99 times: wait 20 s"), TaskState.UNDERWAY)
        os.unlink(socket_path("q", stop=True))
        assert main(["robot", "stop", "--name", "q"]) == 0  # over the other socket
        assert layer.emergency.is_latched
        ask(layer, "release")
        shutil.rmtree(folder / "r" / "btlang")
        wait_for(layer, submit(layer, "repeat 99 times: wait 20 s"), TaskState.UNDERWAY)
        assert main(["robot", "stop"]) == 0  # by its file
        wait_until(lambda: layer.emergency.is_latched)
        wait_until(lambda: os.path.exists(socket_path("q")) and os.path.exists(socket_path("q", stop=True)))
        wait_until(lambda: answer_of(socket_path("q", stop=True)) == b"stopped\n")
    capsys.readouterr()


def test_a_door_that_is_closed_leaves_no_socket(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(socket_server, "_LOOK", 0.0002)  # so that it often looks just then
    for _ in range(100):
        door = SocketServer("q", lambda data, person: Answer(True), lambda person: None)
        door.start()
        door.close()
        assert not os.path.exists(socket_path("q"))
        assert not os.path.exists(socket_path("q", stop=True))


def test_all_robots_that_are_up_are_stopped(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with robot_up(Path(data_folder("p")), "p") as first, robot_up(Path(data_folder("q")), "q") as second:
        assert main(["robot", "stop"]) == 0
        assert first.emergency.is_latched
        assert second.emergency.is_latched
    assert capsys.readouterr().out.count("is stopped") == 2


@pytest.mark.parametrize("odd", ["folder", "link", "pipe", "device", "garbage"])
def test_a_latch_that_is_no_file(tmp_path: Path, odd: str) -> None:
    path, target = tmp_path / "emergency_stop", tmp_path / "target"
    target.write_text("mine")
    if odd == "folder":
        path.mkdir()
    elif odd == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero" if odd == "device" else target) if odd != "garbage" else path.write_text("[]")
    stops: list[int] = []
    latch = EmergencyLatch(str(path), lambda: stops.append(1))
    assert latch.reason == "its latch can't be read"
    latch.stop("ann")
    assert stops == [1]
    latch.close()
    assert target.read_text() == "mine"


def test_a_latch_that_somebody_shuts(tmp_path: Path) -> None:
    stops: list[int] = []
    latch = EmergencyLatch(latch_path(str(tmp_path)), lambda: stops.append(1))
    shut_latch(str(tmp_path), "bo", "fire")
    wait_until(lambda: stops)
    assert latch.reason == "emergency stop by bo: fire"
    latch.release()
    assert EmergencyLatch(latch_path(str(tmp_path)), int).reason == ""
    latch.close()
