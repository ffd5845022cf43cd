"""Random commands, between tasks and while one is under way, against a plain model of the queue, on both stores."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import pytest

from btlang.task.store.records import Restart, TaskState
from tests.profiles import amount

from .driven import Driven
from .queue_model import MISSION, Command, Model, drawn_commands, smallest


def problem(robot: Driven, commands: list[Command]) -> str:
    """What the robot does otherwise than the model, "" for nothing."""
    try:
        model = Model(robot)
        for name, fields in commands:
            getattr(model, name)(**fields)
            model.check()
    except Exception as error:
        robot.restart()
        return f"{type(error).__name__}: {error}"
    return ""


@pytest.fixture(params=["sqlite", "postgres"])
def robot(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Driven]:
    for waited in ("_LOOK", "_ANSWER"):  # who would be waited for is this thread
        monkeypatch.setattr(f"btlang.task.execution.executor.{waited}", 0.0)
    driven = Driven(request.param)
    yield driven
    driven.close()


@pytest.mark.long
@pytest.mark.parametrize("part", range(amount(1, 4)))
def test_random_commands(robot: Driven, part: int) -> None:
    """In a long run 10,000 sequences on each store."""
    for number in range(amount(20, 2500)):
        commands = drawn_commands(Random(f"{part} {number}"))
        if problem(robot, commands):
            least = smallest(commands, lambda fewer: bool(problem(robot, fewer)))
            pytest.fail("\n".join([*map(str, least), problem(robot, least)]))


@pytest.mark.parametrize(
    ("first", "second", "accepted", "state"),
    [
        ("cancel", "interrupt", False, TaskState.CANCELED),
        ("kill", "cancel", True, TaskState.KILLED),
        ("interrupt", "kill", True, TaskState.KILLED),
        ("interrupt", "interrupt", False, TaskState.DELAYED),
    ],
)
def test_two_who_ask_in_the_same_tick(robot: Driven, first: str, second: str, accepted: bool, state: TaskState) -> None:
    """What the first one was told holds, unless the second one asks for more."""
    answers = []
    robot.printed = lambda task, text: answers.extend(robot.ask(act, task=task) for act in (first, second))
    number = robot.ask("submit", text=MISSION).data["task"]["id"]
    robot.turn()
    assert [answer.ok for answer in answers] == [True, accepted]
    task = robot.layer.store.task(number)
    assert task is not None
    assert (task.state, task.token) == (state, answers[0].data["token"] if state is TaskState.DELAYED else "")


@pytest.mark.parametrize("restart", list(Restart))
def test_a_stop_that_is_released_at_once_kills_the_task(robot: Driven, restart: Restart) -> None:
    """Also if the robot isn't yet at rest when it may move again."""
    robot.printed = lambda task, text: [robot.ask(act) for act in ("emergency_stop", "release")]
    number = robot.ask("submit", text=MISSION, restart=restart).data["task"]["id"]
    robot.turn()
    task = robot.layer.store.task(number)
    assert task is not None
    assert (task.state, task.reason) == (TaskState.KILLED, "emergency stop by ann")


@pytest.mark.parametrize("restart", list(Restart))
def test_a_crash_right_after_a_stop_does_not_undo_it(robot: Driven, restart: Restart) -> None:
    def stop(task: int, text: str) -> None:
        robot.ask("emergency_stop")
        robot.crash()

    robot.printed = stop
    number = robot.ask("submit", text=MISSION, restart=restart).data["task"]["id"]
    robot.turn()
    robot.restart()
    task = robot.layer.store.task(number)
    assert task is not None
    assert (task.state, task.reason) == (TaskState.KILLED, "emergency stop by ann")
