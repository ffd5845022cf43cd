"""The runner with a clock of its own and a robot that only counts."""

from __future__ import annotations

import math
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import ActionFailed, LeafBinding
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.bus import Bus
from btlang.run.events import Ended, PeriodPassed, StatusChanged, StatusesChanged, Troubled
from btlang.run.runner import Runner, trace_engine
from btlang.tree.node import Node, Tree


class Robot:
    """Rolls on for some seconds after it was stopped."""

    def __init__(self, rolls_on: float = 0.0) -> None:
        self.left = rolls_on
        self.stopped = 0
        self.seconds = 0.0

    @property
    def moving(self) -> bool:
        return self.left > 1e-9

    def step(self, dt: float) -> None:
        self.seconds += dt
        if self.stopped:
            self.left -= dt

    def stop(self) -> None:
        self.stopped += 1


def forever() -> Iterator[None]:
    while True:
        yield


SLEEP = Node("Sleep", ports=(("msec", "1000"),))


def make(
    root: Node, calls: dict[str, Callable[..., Any]] | None = None, **options: Any
) -> tuple[Runner, Engine, Clock]:
    bus = options.pop("bus", None) or Bus()
    clock = bus.clock
    bindings = {id: LeafBinding(call) for id, call in {"Forever": forever, **(calls or {})}.items()}
    engine = Engine(Tree(root), bindings.get, clock=clock)
    return Runner(engine, bus=bus, **{"speed": math.inf, **options}), engine, clock


def test_a_mission_runs_to_its_end() -> None:
    robot = Robot()
    runner, _, clock = make(SLEEP, robot=robot)
    outcome = runner.run()
    assert (outcome.status, outcome.ticks, outcome.stopped, outcome.failure) == (SUCCESS, 21, "", None)
    assert outcome.seconds == pytest.approx(1.0)
    assert clock.now == pytest.approx(1.05)  # one period more, so that the robot takes commands again
    assert robot.seconds == pytest.approx(1.05)
    assert robot.stopped == 1


def test_rate() -> None:
    runner, _, _ = make(SLEEP, rate=100)
    assert runner.run().ticks == 101


def test_a_failure_is_told() -> None:
    def lost() -> None:
        raise ActionFailed("lost")

    runner, _, _ = make(Node("Sequence", (SLEEP, Node("Lost"))), {"Lost": lost})
    outcome = runner.run()
    assert outcome.status == FAILURE
    assert outcome.failure is not None
    assert (outcome.failure.path, outcome.failure.reason) == ("/1", "lost")


def test_a_skipped_mission_ends() -> None:
    runner, _, _ = make(Node("AlwaysSuccess", ports=(("_skipIf", "true"),)))
    assert runner.run().status == SKIPPED


def test_time_limit_halts() -> None:
    runner, engine, _ = make(Node("Forever"), time_limit=3)
    outcome = runner.run()
    assert (outcome.status, outcome.stopped, outcome.ticks) == (IDLE, "time limit", 60)
    assert outcome.seconds == pytest.approx(3)
    assert engine.status == IDLE


def test_the_robot_comes_to_rest() -> None:
    for rolls_on, expected in ((0.5, 0.5), (60.0, 2.0)):
        robot = Robot(rolls_on)
        runner, _, clock = make(Node("AlwaysSuccess"), robot=robot)
        outcome = runner.run()
        assert outcome.seconds == 0
        assert robot.seconds == pytest.approx(expected)
        assert clock.now == pytest.approx(expected)


def test_interrupt_within_a_leaf() -> None:
    log: list[str] = []

    def drive() -> Iterator[None]:
        try:
            while True:
                yield
        finally:
            log.append("drive stopped")

    def interrupt() -> Iterator[None]:
        yield
        yield
        raise KeyboardInterrupt

    robot = Robot(0.2)
    runner, _, _ = make(
        Node("Parallel", (Node("Drive"), Node("Press"))), {"Drive": drive, "Press": interrupt}, robot=robot
    )
    outcome = runner.run()
    assert (outcome.status, outcome.stopped, outcome.failure) == (IDLE, "interrupted", None)
    assert log == ["drive stopped"]
    assert robot.stopped == 1
    assert not robot.moving


def test_an_exit_in_a_leaf_fails_it_and_stops_the_robot() -> None:
    def leave() -> None:
        sys.exit(3)

    robot = Robot(0.2)
    runner, _, _ = make(Node("Leave"), {"Leave": leave}, robot=robot)
    outcome = runner.run()
    assert (outcome.status, outcome.failure and outcome.failure.reason) == (FAILURE, "SystemExit: 3")
    assert robot.stopped == 1
    assert not robot.moving


def test_stop_from_another_thread_wakes_the_sleep() -> None:
    def stopped_soon() -> Iterator[None]:
        threading.Timer(0.05, runner.controls.stop).start()
        yield from forever()

    runner, engine, _ = make(Node("Forever"), {"Forever": stopped_soon}, speed=1.0, rate=0.01)
    began = time.monotonic()
    outcome = runner.run()
    assert time.monotonic() - began < 5
    assert outcome.stopped == "interrupted"
    assert outcome.ticks == 1
    assert engine.status == IDLE


def test_stop_before_the_first_tick() -> None:
    runner, _, _ = make(Node("Forever"))
    runner.controls.stop()
    assert runner.run().ticks == 0


def test_real_time_is_kept_over_a_schedule_and_speed() -> None:
    runner, _, _ = make(Node("Sleep", ports=(("msec", "5000"),)), speed=20.0)
    began = time.monotonic()
    runner.run()
    assert 0.24 < time.monotonic() - began < 4.0


def test_overruns_are_counted() -> None:
    def slow() -> int:
        time.sleep(0.01)
        return RUNNING

    seen: list[Any] = []
    runner, _, _ = make(Node("Slow"), {"Slow": slow}, speed=1.0, rate=1000, time_limit=0.005, bus=bus_to(seen.append))
    runner.run()
    assert [event.overruns for event in seen if isinstance(event, PeriodPassed)] == [0, 1, 2, 3, 4, 5]


def test_step() -> None:
    robot = Robot()
    runner, _, clock = make(Node("Forever"), robot=robot)
    assert runner.tick() == RUNNING
    assert (clock.now, robot.seconds, runner.ticks) == (0.05, 0.05, 1)


# Events


def bus_to(*sinks: Callable[[Any], object]) -> Bus:
    bus = Bus()
    for sink in sinks:
        bus.add(sink)
    return bus


def changes(events: list[Any]) -> list[StatusChanged]:
    return [change for event in events if isinstance(event, StatusesChanged) for change in event]


def test_status_changes_go_into_the_stream() -> None:
    seen: list[Any] = []
    bus = bus_to(seen.append)

    def lost() -> None:
        raise ActionFailed("lost")

    root = Node("Sequence", (SLEEP, Node("Lost")))
    engine = trace_engine(Tree(root), {"Lost": LeafBinding(lost)}.get, bus=bus)
    Runner(engine, bus=bus, speed=math.inf).run()
    told = [(round(e.t, 6), e.index, e.path, e.node.id, e.before, e.status, e.reason) for e in changes(seen)]
    assert told == [
        (0.0, 1, "/0", "Sleep", IDLE, RUNNING, ""),
        (0.0, 0, "/", "Sequence", IDLE, RUNNING, ""),
        (1.0, 1, "/0", "Sleep", RUNNING, SUCCESS, ""),
        (1.0, 2, "/1", "Lost", IDLE, FAILURE, "lost"),
        (1.0, 0, "/", "Sequence", RUNNING, FAILURE, ""),
    ]


def test_a_sink_that_raises_is_dropped_and_the_mission_goes_on() -> None:
    problem = OSError("disk full")

    def full(event: object) -> None:
        raise problem

    seen: list[Any] = []
    bus = bus_to(full, seen.append)
    engine = trace_engine(Tree(SLEEP), lambda id: None, bus=bus)
    assert Runner(engine, bus=bus, speed=math.inf).run().status == SUCCESS
    assert bus.errors == [problem]
    assert [change.status for change in changes(seen)] == [RUNNING, SUCCESS]


def test_exceptions_while_halting_are_events() -> None:
    def stubborn() -> Iterator[None]:
        try:
            yield
        finally:
            raise ValueError("stuck")

    seen: list[Any] = []
    runner, _, _ = make(Node("Stubborn"), {"Stubborn": stubborn}, time_limit=0.05, bus=bus_to(seen.append))
    runner.run()
    told = [(event.t, event.text, event.path) for event in seen if isinstance(event, Troubled)]
    assert told == [(0.05, "Stubborn did not halt: ValueError: stuck", "/")]
    assert isinstance(seen[-1], Ended)
