"""What waits is ticked when it is due, between two periods as well."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from btlang.ros.clocks import RosPace
from btlang.run import pace
from btlang.run.bus import Bus
from btlang.run.events import PeriodPassed
from btlang.run.outcome import Outcome
from btlang.run.runner import Runner
from btlang.tree.node import Node, Tree
from tests.engine.scripted import n

from .test_pace import Driven, Steps


def forever() -> Iterator[None]:
    while True:
        yield


def run(root: Node, *, rate: float = 1.0, limit: float = 10.0, **leaves: Callable[..., Any]) -> tuple[Outcome, Steps]:
    """Runs without waiting; returns how it ended, and the steps of the robot."""
    clock, robot = Clock(), Steps()
    bindings = {id: LeafBinding(call) for id, call in {"Forever": forever, "Yes": lambda: True, **leaves}.items()}
    engine = Engine(Tree(root), bindings.get, clock=clock)
    runner = Runner(engine, bus=Bus(clock=clock), robot=robot, rate=rate, speed=math.inf, time_limit=limit)
    outcome = runner.run()
    robot.steps.pop()  # the one in which it comes to rest
    assert sum(robot.steps) == pytest.approx(outcome.seconds)
    return outcome, robot


SLEEP = n("Sleep", msec=5)


def test_a_short_sleep_below_a_timeout_succeeds() -> None:
    outcome, robot = run(n("Timeout", SLEEP, msec=50), rate=20)
    assert (outcome.status, outcome.ticks, robot.steps) == (SUCCESS, 2, [0.005])


@pytest.mark.parametrize(
    ("root", "status", "steps"),
    [
        (n("Sleep", msec=1250), SUCCESS, [1, 0.25]),
        (n("Delay", n("Sleep", msec=100), delay_msec=250), SUCCESS, [0.25, 0.1]),
        (n("Timeout", n("Forever"), msec=300), FAILURE, [0.3]),
        (n("Timeout", n("Delay", n("Yes"), delay_msec=250), msec=100), FAILURE, [0.1]),
        (n("Timeout", n("Sleep", msec=1100), msec=0), SUCCESS, [1, 0.1]),
        (n("Parallel", n("Sleep", msec=400), n("Sleep", msec=100)), SUCCESS, [0.1, 0.3]),
        (n("Parallel", n("Sleep", msec=100), n("Forever"), success_count=1), SUCCESS, [0.1]),
        (n("RetryUntilSuccessful", n("Inverter", n("Sleep", msec=200)), num_attempts=3), FAILURE, [0.2] * 3),
        (n("Repeat", n("Parallel", n("Yes"), n("Sleep", msec=200)), num_cycles=3), SUCCESS, [0.2] * 3),
        (n("PipelineSequence", n("RateController", n("Yes"), hz=4), n("Sleep", msec=600)), SUCCESS, [0.25, 0.25, 0.1]),
        (n("Sequence", n("Sleep", msec=100), n("Sleep", msec=100)), SUCCESS, [0.1, 0.1]),
    ],
    ids=lambda value: value.id if isinstance(value, Node) else None,
)
def test_who_is_due_when(root: Node, status: int, steps: list[float]) -> None:
    outcome, robot = run(root)
    assert outcome.status == status
    assert robot.steps == pytest.approx(steps)


def test_a_pause_moves_what_is_due() -> None:
    clock = Clock()
    engine = Engine(Tree(n("Sleep", msec=500)), lambda id: None, clock=clock)
    engine.tick()
    assert clock.due == 0.5
    clock.advance(0.2)
    engine.suspend()
    clock.advance(7)
    clock.due = math.inf
    engine.tick()
    assert clock.due == pytest.approx(7.5)


# Leaves


def waiting(*waits: float) -> Callable[..., Iterator[None]]:
    """A leaf that asks for a tick after so many seconds, and one more at the end."""

    def leaf(clock: Clock, wake_at: Callable[[float], None]) -> Iterator[None]:
        for seconds in waits:
            wake_at(clock.now + seconds)
            yield

    return leaf


def test_a_leaf_says_when_it_is_due() -> None:
    outcome, robot = run(n("Wait"), Wait=waiting(0.25, 3.0, 0.5))
    assert outcome.status == SUCCESS
    assert robot.steps == pytest.approx([0.25, 1.0, 0.5])


def test_a_class_says_so_too() -> None:
    class Wait:
        def __init__(self, clock: Clock, wake_at: Callable[[float], None]) -> None:
            self.clock, self.wake_at = clock, wake_at

        def start(self) -> None:
            self.wake_at(self.clock.now + 0.25)

        def tick(self) -> bool:
            return True

        def halt(self) -> None: ...

    assert run(n("Wait"), Wait=Wait)[1].steps == [0.25]


def test_no_leaf_can_hold_the_time() -> None:
    """One that is always due is ticked a thousand times a second."""
    outcome, robot = run(n("Wait"), Wait=waiting(0.0, -5.0, 1e-9))
    assert outcome.status == SUCCESS
    assert robot.steps == pytest.approx([0.001] * 3)


def test_no_rate_can_hold_the_time() -> None:
    root = n("PipelineSequence", n("RateController", n("Yes"), hz=1e9), n("Forever"))
    outcome, _ = run(root, limit=0.1)
    assert (outcome.status, outcome.stopped) == (IDLE, "time limit")
    assert outcome.ticks <= 101


def test_a_time_that_is_none_changes_nothing() -> None:
    assert run(n("Wait"), Wait=waiting(math.nan, math.inf, -math.inf))[1].steps == pytest.approx([1.0, 1.0, 0.001])


# Nodes that are RUNNING between two children


@pytest.mark.parametrize(
    "root",
    [
        n("AsyncSequence", n("Yes"), n("Yes"), n("Yes")),
        n("SequenceWithMemory", n("Yes"), n("Yes"), n("Yes")),
        n("AsyncFallback", n("No"), n("No"), n("Yes")),
    ],
    ids=lambda root: root.id,
)
def test_the_next_child_comes_at_once(root: Node) -> None:
    outcome, robot = run(root, No=lambda: False)
    assert (outcome.status, outcome.ticks, robot.steps) == (SUCCESS, 3, [])


@pytest.mark.parametrize("around", ["Repeat", "RetryUntilSuccessful", "KeepRunningUntilFailure"])
@pytest.mark.parametrize("id", ["AsyncSequence", "SequenceWithMemory", "AsyncFallback"])
def test_an_endless_loop_of_them_lets_time_pass(around: str, id: str) -> None:
    leaf, result = ("No", SUCCESS) if id == "AsyncFallback" else ("Yes", FAILURE)
    inner = n(id, n(leaf), n(leaf))
    if (around == "RetryUntilSuccessful") == (result == FAILURE):
        inner = n("Inverter", inner)
    ports = {"Repeat": {"num_cycles": -1}, "RetryUntilSuccessful": {"num_attempts": -1}}.get(around, {})
    outcome, robot = run(n(around, inner, **ports), limit=5, No=lambda: False)
    assert outcome.stopped == "time limit"
    assert outcome.ticks <= 15
    assert robot.steps == [1.0] * 5


# In real time


def driven(monkeypatch: pytest.MonkeyPatch, root: Node, takes: float = 0.0) -> tuple[list[float], list[float], int]:
    """Runs once a second; each tick of the leaf Work `takes` so long, four of them.

    Returns the steps of the robot, the seconds of real time after which they were made, and the late periods.
    """
    clock, robot, controls, late, ticks = Clock(), Steps(), Driven({}), [0], [0]
    made: list[float] = []
    monkeypatch.setattr(pace.time, "monotonic", lambda: controls.now)
    monkeypatch.setattr(pace.time, "sleep", lambda seconds: None)
    monkeypatch.setattr(robot, "step", lambda dt: (robot.steps.append(dt), made.append(controls.now - 100.0)))

    def work() -> int:
        controls.now += takes
        ticks[0] += 1
        return RUNNING if ticks[0] < 4 else SUCCESS

    def hear(event: object) -> None:
        if isinstance(event, PeriodPassed):
            late[0] = event.late

    engine = Engine(Tree(root), {"Work": LeafBinding(work)}.get, clock=clock)
    bus = Bus(clock=clock)
    bus.add(hear)
    Runner(engine, bus=bus, robot=robot, controls=controls, rate=1, speed=1.0).run()
    return robot.steps[:-1], made[:-1], late[0]


def test_the_sleep_ends_when_something_is_due(monkeypatch: pytest.MonkeyPatch) -> None:
    steps, made, late = driven(monkeypatch, n("Sleep", msec=1250))
    assert steps == pytest.approx([1.0, 0.25])
    assert made == pytest.approx([1.0, 1.25])
    assert late == 0


def test_the_time_of_a_tick_is_a_part_of_the_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    steps, made, late = driven(monkeypatch, n("ParallelAll", n("Work"), n("Sleep", msec=1500)), takes=0.25)
    assert steps == pytest.approx([1.0, 0.5, 1.0])
    assert made == pytest.approx([1.0, 1.5, 2.5])
    assert late == 0


def test_a_shorter_period_is_not_late(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tick takes longer than the sleep that it begins, and not as long as a period."""
    steps, made, late = driven(monkeypatch, n("ParallelAll", n("Work"), n("Sleep", msec=100)), takes=0.25)
    assert steps == pytest.approx([0.25, 1.0, 1.0])
    assert made == pytest.approx([0.25, 1.25, 2.25])
    assert late == 0


# Over ROS 2


class Times:
    """A system's clock and a simulator's, `factor` times as fast; only waiting lets time pass."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
        self.real, self.factor = 100.0, factor
        self.controls = Driven({})
        monkeypatch.setattr(time, "monotonic", lambda: self.real)
        monkeypatch.setattr(time, "sleep", self.pass_by)
        monkeypatch.setattr(self.controls, "wait", self.pass_by)

    def pass_by(self, seconds: float) -> None:
        self.real += max(seconds, 1e-6)

    def pace(self) -> RosPace:
        pace = RosPace(self.controls, lambda: self.real * self.factor)
        pace.begin()
        return pace


@pytest.mark.parametrize("factor", [1.0, 0.2, 4.0])
def test_over_ros_as_well_by_whatever_clock(monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
    times, clock, robot = Times(monkeypatch, factor), Clock(), Steps()
    engine = Engine(Tree(n("Timeout", n("Sleep", msec=150), msec=500)), lambda id: None, clock=clock)
    outcome = Runner(
        engine, bus=Bus(clock=clock), robot=robot, rate=10, pace=lambda speed, controls: times.pace()
    ).run()
    assert (outcome.status, outcome.ticks) == (SUCCESS, 3)
    assert robot.steps[:2] == pytest.approx([0.1, 0.05], abs=0.01)


def test_over_ros_a_shorter_period_is_not_late(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch, 1.0)
    pace = times.pace()
    times.pass_by(0.03)
    assert pace.sleep(0.05, 0.01) == pytest.approx(0.03)
    assert pace.late == 0
    assert pace.sleep(0.05, 0.01) == pytest.approx(0.01, abs=0.001)
    times.pass_by(0.06)
    assert pace.sleep(0.05, 0.01) == pytest.approx(0.06)
    assert pace.late == 1
