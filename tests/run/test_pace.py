"""The sleep between two ticks, and what ends it."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import RUNNING, SUCCESS
from btlang.run import pace
from btlang.run.bus import Bus
from btlang.run.controls import Controls
from btlang.run.runner import Runner
from btlang.tree.node import Node, Tree


class Steps:
    """A robot that notes the lengths of its steps."""

    moves_by_itself = False

    def __init__(self) -> None:
        self.steps: list[float] = []

    def step(self, dt: float) -> None:
        self.steps.append(dt)

    def stop(self) -> None:
        pass


class Driven(Controls):
    """Time that passes only in `wait`. `at` says what happens after so many seconds of real time."""

    def __init__(self, at: dict[float, Callable[[], object]]) -> None:
        super().__init__()
        self.now = 100.0
        self.at = {100.0 + seconds: what for seconds, what in at.items()}

    def wait(self, seconds: float | None) -> None:
        assert seconds is not None
        assert seconds > 0
        until = min([self.now + seconds, *self.at])
        self.now = until
        if until in self.at:
            self.at.pop(until)()


def run_driven(
    monkeypatch: pytest.MonkeyPatch, at: dict[float, Callable[[Runner], object]], ticks: int, **options: Any
) -> tuple[list[float], list[float], Runner]:
    """Runs a leaf for some ticks; returns the times of the mission at which it was ticked, the steps and the runner."""
    clock, robot, times = Clock(), Steps(), []

    def leaf(clock: Clock) -> int:
        times.append(clock.now)
        return RUNNING if len(times) < ticks else SUCCESS

    engine = Engine(Tree(Node("A")), {"A": LeafBinding(leaf)}.get, clock=clock)
    controls = Driven({seconds: lambda what=what: what(runner) for seconds, what in at.items()})
    monkeypatch.setattr(pace.time, "monotonic", lambda: controls.now)
    monkeypatch.setattr(time, "sleep", lambda _: None)
    runner = Runner(
        engine, bus=Bus(clock=clock), robot=robot, controls=controls, **{"rate": 1, "speed": 1.0, **options}
    )
    runner.run()
    return times, robot.steps, runner


def wake(runner: Runner) -> None:
    runner._engine.on_wake()  # type: ignore[misc]


def test_without_a_wake_all_periods_are_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    times, steps, _ = run_driven(monkeypatch, {}, 4)
    assert times == [0.0, 1.0, 2.0, 3.0]
    assert steps == [1.0] * 4


def test_a_wake_ticks_at_once_and_the_world_moves_on_by_what_has_passed(monkeypatch: pytest.MonkeyPatch) -> None:
    times, steps, _ = run_driven(monkeypatch, {0.25: wake, 2.75: wake}, 6)
    assert times == [0.0, 0.25, 1.25, 2.25, 2.75, 3.75]
    assert steps == [0.25, 1.0, 1.0, 0.5, 1.0, 1.0]


def test_a_wake_at_another_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    times, _, _ = run_driven(monkeypatch, {0.125: wake}, 3, speed=4.0)
    assert times == [0.0, 0.5, 1.5]


def test_without_waiting_there_is_nothing_to_wake(monkeypatch: pytest.MonkeyPatch) -> None:
    times, _, _ = run_driven(monkeypatch, {0.25: wake}, 3, speed=math.inf)
    assert times == [0.0, 1.0, 2.0]


def test_a_stop_ends_the_sleep(monkeypatch: pytest.MonkeyPatch) -> None:
    times, steps, runner = run_driven(monkeypatch, {1.5: lambda runner: runner.controls.stop()}, 9)
    assert times == [0.0, 1.0]
    assert steps == [1.0, 0.5, 1.0]
    assert runner.ticks == 2


def test_a_pause_does_not_end_the_sleep(monkeypatch: pytest.MonkeyPatch) -> None:
    def pause_and_resume(runner: Runner) -> None:
        runner.controls.pause()
        runner.controls.resume()

    times, steps, _ = run_driven(monkeypatch, {0.5: pause_and_resume}, 3)
    assert (times, steps) == ([0.0, 1.0, 2.0], [1.0] * 3)


def test_a_wake_during_a_tick_means_the_next_one(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, times = Clock(), []

    def leaf(wake: Callable[[], None]) -> int:
        times.append(clock.now)
        if len(times) == 1:
            wake()
        return RUNNING if len(times) < 3 else SUCCESS

    controls = Driven({})
    monkeypatch.setattr(pace.time, "monotonic", lambda: controls.now)
    engine = Engine(Tree(Node("A")), {"A": LeafBinding(leaf)}.get, clock=clock)
    Runner(engine, bus=Bus(clock=clock), controls=controls, rate=1, speed=1.0).run()
    assert times == [0.0, 0.0, 1.0]


def test_the_last_period_ends_with_the_time_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    times, steps, runner = run_driven(monkeypatch, {}, 9, time_limit=1.5)
    assert (times, steps) == ([0.0, 1.0], [1.0, 0.5, 1.0])
    assert runner.controls.now == pytest.approx(101.5)  # type: ignore[attr-defined]


def test_a_leaf_wakes_the_run_from_another_thread() -> None:
    """At one tick in 5 s: what has ended is noticed in a small part of that."""
    ended: list[float] = []

    def look(wake: Callable[[], None]) -> Iterator[None]:
        def work() -> None:
            ended.append(time.monotonic())
            wake()

        thread = threading.Timer(0.05, work)
        thread.start()
        yield  # in a busy process the thread may have ended by now
        while thread.is_alive() and not ended:
            yield
        ended.append(time.monotonic())

    clock = Clock()
    engine = Engine(Tree(Node("Look")), {"Look": LeafBinding(look)}.get, clock=clock)
    outcome = Runner(engine, bus=Bus(clock=clock), rate=0.2, speed=1.0).run()
    assert (outcome.status, outcome.ticks) == (SUCCESS, 2)
    assert ended[1] - ended[0] < 1.5
    assert 0.04 < outcome.seconds < 2.0


def test_the_service_does_nothing_without_a_runner() -> None:
    engine = Engine(Tree(Node("A")), {"A": LeafBinding(lambda wake: wake() is None)}.get, clock=Clock())
    assert engine.tick() == SUCCESS
