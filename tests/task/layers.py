"""A robot with its task layer, for tests."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from btlang.task.commands.client import USUAL_NAME
from btlang.task.commands.socket_server import SocketServer
from btlang.task.layer import TaskLayer
from btlang.task.store.records import Task, TaskState

Btc = Callable[..., tuple[int, str]]
"""Runs a command of `btc`: its exit code, and what it prints anywhere."""
LONG = 20.0
"""Seconds for what should happen soon."""


@contextmanager
def layer_in(folder: Path, **options: Any) -> Iterator[TaskLayer]:
    """A robot that is up; simulated, 50 times as fast as real time."""
    with TaskLayer(folder=str(folder), **{"speed": 50.0, **options}) as layer:
        yield layer


@contextmanager
def robot_up(folder: Path, name: str = USUAL_NAME, **options: Any) -> Iterator[TaskLayer]:
    """One with its sockets, for other processes; the folder of these needs a short path."""
    with (
        layer_in(folder, **options) as layer,
        closing(SocketServer(name, layer.handle, layer.stop, layer.feed.watch)) as door,
    ):
        door.start()
        yield layer


def ask(layer: TaskLayer, command: str, **fields: Any) -> dict[str, Any]:
    """The data of an answer, which has to be a good one."""
    answer = layer.handle({"command": command, **fields}, "ann")
    assert answer.ok, answer.text
    return dict(answer.data)


def refusal(layer: TaskLayer, command: str, **fields: Any) -> str:
    """Why a command is refused."""
    answer = layer.handle({"command": command, **fields}, "ann")
    assert not answer.ok, answer.text
    return answer.text


def submit(layer: TaskLayer, text: str, **fields: Any) -> int:
    """The number of a new task."""
    return int(ask(layer, "submit", text=text, **fields)["task"]["id"])


def task(layer: TaskLayer, number: int) -> Task:
    """A task as the store has it."""
    found = layer.store.task(number)
    assert found is not None
    return found


def wait_until(holds: Callable[[], object], seconds: float = LONG) -> None:
    """Until something holds."""
    until = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < until
        time.sleep(0.005)


def wait_for(layer: TaskLayer, number: int, *states: TaskState) -> Task:
    """Until a task is in one of some states; the task then."""
    wait_until(lambda: task(layer, number).state in states)
    return task(layer, number)
