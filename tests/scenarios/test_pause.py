"""Pause, resume and single steps of a run on the simulated robot, driven by the events of the run itself."""

from __future__ import annotations

from typing import Any

import pytest

import btlang
from btlang.engine.status import SUCCESS
from btlang.run.events import PeriodPassed, Said
from tests.trial import Trial

LAB = (6.0, 6.2)


class Interrupter:
    """Pauses at given times; once the robot rests it notes where, and resumes."""

    def __init__(self, tree: Trial, *times: float) -> None:
        self.tree = tree
        self.times = list(times)
        self.before: Any = None
        self.rests: list[tuple[float, float, float]] = []  # time of the mission at pause and at rest, distance rolled
        self.periods = 0
        self.poses: list[Any] = []

    def __call__(self, event: object) -> None:
        if not isinstance(event, PeriodPassed):
            return
        robot: Any = event.robot
        self.poses.append((event.t, robot.pose))
        if not self.tree.controls.paused:
            if self.times and event.t >= self.times[0] - 1e-9:
                self.times.pop(0)
                self.before, self.periods = (event.t, robot.pose), 0
                self.tree.controls.pause()
            return
        self.periods += 1
        if not robot.moving:
            began, pose = self.before
            self.rests.append((began, event.t, pose.distance_to((robot.pose.x, robot.pose.y))))
            self.tree.controls.resume()


def run(text: str, *times: float, limit: float | None = 300) -> tuple[Any, Trial, Interrupter, list[str]]:
    tree = Trial(text)
    interrupter = Interrupter(tree, *times)
    told: list[str] = []
    outcome = tree.run(
        speed="max",
        time_limit=limit,
        sinks=[interrupter, lambda event: told.append(getattr(event, "tag", ""))],
    )
    assert not tree.sink_errors
    assert len(interrupter.rests) == len(times)
    return outcome, tree, interrupter, told


@pytest.mark.parametrize(
    "text",
    [
        "go to the lab",
        "repeat go to the lab 2 times",
        "go to the lab within 60 s",
        "go to the lab and say hello",
        "raise your right arm and go to the lab",
        "if the battery is full, go to the lab",
        "go to the lab as long as the battery is not low",
        "way is go to the lab\nway",
    ],
)
def test_a_journey_is_interrupted_and_goes_on(text: str) -> None:
    limit = 60 if "as long as" in text else 300
    straight = btlang.parse_tree(text).run(speed="max", time_limit=limit)
    outcome, tree, interrupter, told = run(text, 3.0, 4.0, limit=limit)
    for began, rested, rolled in interrupter.rests:
        assert rested == began  # the time of the mission stands still
        assert rolled < 0.1  # the brakes hold at once: 0.5 m/s, 4 m/s2 and what a period passes
    assert interrupter.periods <= 4
    assert told.count("stop") >= 2
    assert outcome.status == straight.status
    if straight.status == SUCCESS:
        assert tree.robot.pose.distance_to(LAB) < 0.05
        assert outcome.seconds < straight.seconds + 6  # it speeds up anew, and turns to the way


def test_the_wheels_stop_within_one_tick() -> None:
    _, _, interrupter, _ = run("go to the lab", 4.0)
    poses = [pose for t, pose in interrupter.poses if t == pytest.approx(4.0)]
    first, rest = poses[0].distance_to((poses[1].x, poses[1].y)), poses[1].distance_to((poses[-1].x, poses[-1].y))
    assert first < 0.5 * 0.05  # the brakes are on in the very next period
    assert rest < 0.02


def test_the_timer_of_within_stands_still() -> None:
    seconds = btlang.parse_tree("go to the lab").run(speed="max").seconds
    outcome, *_ = run(f"go to the lab within {seconds + 4:.0f} s", *(2.0 + i / 2 for i in range(4)))
    assert outcome.status == SUCCESS


def test_counts_and_positions_are_kept() -> None:
    told: list[str] = []
    tree = Trial("repeat 3 times: say one then wait 1 s then say two")
    interrupter = Interrupter(tree, 0.8, 2.9)
    tree.run(
        speed="max",
        sinks=[
            interrupter,
            lambda e: told.append(e.text) if isinstance(e, Said) else None,
        ],
    )
    assert told == ["one", "two"] * 3
    assert len(interrupter.rests) == 2


def test_the_time_limit_does_not_count_a_pause() -> None:
    outcome, *_ = run("go to the lab then wait 100 s", 1.0, 2.0, limit=5)
    assert (outcome.stopped, outcome.seconds) == ("time limit", pytest.approx(5))


def test_single_steps_add_up() -> None:
    """A simulated world stands still between two single steps, so that stepping is the same run in slow motion."""
    plain = Trial("move forward 1 m then turn left")
    plain.run(speed="max")
    tree = Trial("move forward 1 m then turn left")
    seen: list[float] = []

    def stepping(event: object) -> None:
        if isinstance(event, PeriodPassed):
            seen.append(event.t)
            tree.controls.step()

    outcome = tree.run(speed="max", sinks=[stepping])
    assert outcome.status == SUCCESS
    assert tree.robot.pose == plain.robot.pose
    assert seen[: outcome.ticks] == [pytest.approx(i * 0.05) for i in range(outcome.ticks)]


def test_stop_while_paused() -> None:
    tree = Trial("go to the lab")

    def stops(event: object) -> None:
        if isinstance(event, PeriodPassed) and event.t >= 2:
            if tree.controls.paused:
                tree.controls.stop()
            tree.controls.pause()

    outcome = tree.run(speed="max", sinks=[stops])
    assert (outcome.stopped, round(outcome.seconds, 6)) == ("interrupted", 2)
    assert not tree.robot.moving


def test_controls_before_a_run_are_those_of_the_next() -> None:
    tree = Trial("go to the lab")
    tree.controls.stop()
    assert tree.run(speed="max").stopped == "interrupted"
    assert tree.run(speed="max").status == SUCCESS
