"""Actions of ROS 2 that keyword files declare: goals, and what may happen to them."""

from __future__ import annotations

import pytest

from btlang.engine.status import RUNNING, SUCCESS
from tests.ros.declared import Robot, robot, words

__all__ = ["robot"]

pytest.importorskip("nav2_msgs", reason="nav2_msgs is not installed")

WORDS = words("navigation")
MISSION = "go to the kitchen"


def test_a_goal_arrives(robot: Robot) -> None:
    navigator = robot.peer("navigator", "arrive")
    assert robot.run("go to the kitchen then go to the lobby", WORDS, server=navigator) == ""
    assert navigator.expect("goal") == "goal map 4.000 -1.000 0.707 0.707"
    assert navigator.expect("goal") == "goal map 1.000 2.000 0.000 1.000"


@pytest.mark.parametrize(
    ("mode", "reason"),
    [
        ("reject", "/navigate_to_pose rejected the goal"),
        ("abort", "the way is blocked by a box"),
        ("blame", "the map is too old"),
        ("meddle", "somebody else cancelled the goal of /navigate_to_pose"),
    ],
)
def test_a_goal_fails_with_the_reason_of_the_server(robot: Robot, mode: str, reason: str) -> None:
    navigator = robot.peer("navigator", mode)
    assert robot.run(MISSION, WORDS, server=navigator) == reason


def test_halted_before_the_server_is_there(robot: Robot) -> None:
    engine = robot.load(MISSION, WORDS)
    assert engine.tick() == RUNNING
    engine.halt()
    assert robot.clients.close(1.0) == []


def test_halted_in_the_tick_that_sends_it(robot: Robot) -> None:
    navigator = robot.peer("navigator", "hang")
    robot.load(MISSION, WORDS)
    assert robot.clients.wait(10.0) == []
    assert robot.tick(lambda: True) == RUNNING
    halt(robot)
    assert not navigator.has_told("ended")
    assert navigator.has_told("cancelled") or not navigator.has_told("executing")


def test_halted_when_it_is_not_accepted_yet(robot: Robot) -> None:
    navigator = robot.peer("navigator", "slow", "1.0")
    robot.load(MISSION, WORDS)
    robot.tick(lambda: navigator.has_told("goal"))
    assert not navigator.has_told("executing")
    halt(robot)
    navigator.expect("cancelled")


def test_halted_while_it_executes(robot: Robot) -> None:
    navigator = robot.peer("navigator", "hang")
    robot.load(MISSION, WORDS)
    robot.tick(lambda: navigator.has_told("executing"))
    halt(robot)
    navigator.expect("cancelled")


def halt(robot: Robot) -> None:
    """Halts the mission; whatever it has begun ends within the limit."""
    assert robot.engine is not None
    robot.engine.halt()
    assert robot.clients.close(5.0) == []


def test_a_limit_cancels_and_the_next_goal_is_sent(robot: Robot) -> None:
    navigator = robot.peer("navigator", "hang")
    robot.load("try to go to the kitchen within 1 second; go to the lobby", WORDS)
    robot.tick(lambda: navigator.has_told("goal map 1.000"))
    robot.tick(lambda: navigator.has_told("cancelled"))


def test_what_does_not_end_is_told(robot: Robot) -> None:
    navigator = robot.peer("navigator", "slow", "3.0")
    engine = robot.load(MISSION, WORDS)
    robot.tick(lambda: navigator.has_told("goal"))
    engine.halt()
    assert robot.clients.close(0.2) == ["/navigate_to_pose hasn't answered the halted goal"]


def test_the_server_is_killed_in_the_middle(robot: Robot) -> None:
    navigator = robot.peer("navigator", "hang")
    engine = robot.load(MISSION, WORDS)
    robot.tick(lambda: navigator.has_told("executing"))
    navigator.kill()
    robot.tick(lambda: False)
    assert engine.failure is not None
    assert engine.failure.reason == "the server of /navigate_to_pose is gone"


def test_the_server_is_killed_and_another_one_takes_its_place(robot: Robot) -> None:
    """The new one does not know the goal, so its result would never come."""
    navigator = robot.peer("navigator", "hang")
    engine = robot.load(MISSION, WORDS)
    robot.tick(lambda: navigator.has_told("executing"))
    navigator.kill()
    robot.peer("navigator", "hang")
    robot.tick(lambda: False)
    assert engine.failure is not None
    assert engine.failure.reason == "the server of /navigate_to_pose is gone"


def test_the_server_starts_late(robot: Robot) -> None:
    engine = robot.load(MISSION, WORDS)
    assert engine.tick() == RUNNING
    robot.peer("navigator", "arrive", wait=False)
    assert robot.tick(lambda: False) == SUCCESS


def test_there_is_no_server(robot: Robot) -> None:
    text = WORDS.replace("goal = {", "wait = 0.5, goal = {")
    assert robot.run(MISSION, text) == "there is no action server /navigate_to_pose"
    assert robot.clients.missing() == ["there is no action server /navigate_to_pose"]


def test_a_server_whose_answer_gets_lost(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.ros.words.servers.ANSWER", 0.5)
    navigator = robot.peer("navigator", "lost")
    assert robot.run(MISSION, WORDS) == "/navigate_to_pose does not answer the goal"
    navigator.expect("cancelled")  # though nobody knows whether it accepted


def test_a_server_that_never_answers_the_goal(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.ros.words.servers.ANSWER", 0.5)
    navigator = robot.peer("navigator", "slow", "1.5")
    assert robot.run(MISSION, WORDS) == "/navigate_to_pose does not answer the goal"
    navigator.expect("executing")  # it accepts at last, and is cancelled at once
    navigator.expect("cancelled")
