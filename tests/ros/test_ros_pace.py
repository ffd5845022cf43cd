"""The pace of a run whose time passes by itself. Needs no ROS 2."""

from __future__ import annotations

import time

import pytest

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.ros.clocks import RosPace
from btlang.run.bus import Bus
from btlang.run.controls import Controls
from btlang.run.runner import Runner
from btlang.tree.node import Node, Tree


class Times:
    """A system's clock and a simulator's, `factor` times as fast, that waiting moves on."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, factor: float = 1.0) -> None:
        self.real, self.simulated, self.factor = 100.0, 5.0, factor
        self.controls = Controls()
        monkeypatch.setattr(time, "monotonic", lambda: self.real)
        monkeypatch.setattr(time, "sleep", self.pass_by)
        monkeypatch.setattr(self.controls, "wait", lambda seconds: self.pass_by(seconds))

    def pass_by(self, seconds: float) -> None:
        seconds = max(seconds, 1e-6)  # no wait is so short that no time passes
        self.real += seconds
        self.simulated += seconds * self.factor

    def pace(self) -> RosPace:
        pace = RosPace(self.controls, lambda: self.simulated)
        pace.begin()
        return pace


def test_a_period_is_one_of_the_simulator(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch, factor=4.0)
    assert times.pace().sleep(0.05) == pytest.approx(0.05, abs=0.01)
    assert times.real - 100.0 == pytest.approx(0.0125, abs=0.003)


def test_a_tick_that_takes_long_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch)
    pace = times.pace()
    times.pass_by(0.3)
    assert pace.sleep(0.05) == pytest.approx(0.3)
    assert pace.late == 1
    assert pace.sleep(0.05) == pytest.approx(0.05, abs=0.003)


def test_waking_ends_the_sleep(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch)
    pace = times.pace()
    times.pass_by(0.01)
    pace.wake()
    assert pace.sleep(0.05) == pytest.approx(0.01)


def test_a_clock_that_stands_still_is_not_waited_for_without_end(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch, factor=0.0)
    pace = times.pace()
    assert pace.sleep(0.05) == pytest.approx(0.05, abs=0.01)
    assert times.real - 100.0 == pytest.approx(1.05, abs=0.01)
    assert pace.sleep(0.05) == pytest.approx(0.05, abs=0.01)
    assert times.real - 100.0 == pytest.approx(1.1, abs=0.02)


def test_time_does_not_go_back_where_a_simulator_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch)
    pace = times.pace()
    times.simulated = 0.0
    assert 0.0 <= pace.sleep(0.05) <= 0.06


@pytest.mark.parametrize("factor", [-1.0, -0.001, 0.0, 0.0001])
def test_a_run_ends_in_time_whatever_the_clock_does(monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
    """It runs backwards, or as good as not: the limit counts, and so does the time in which the robot gets to rest."""
    times, clock = Times(monkeypatch, factor), Clock()
    engine = Engine(Tree(Node("Sleep", (), (("msec", "60000"),))), lambda id: None, clock=clock)
    warnings: list[str] = []
    runner = Runner(
        engine,
        bus=Bus(clock=clock),
        robot=Rolling(),
        time_limit=4.0,
        controls=times.controls,
        pace=lambda speed, given: RosPace(times.controls, lambda: times.simulated, warnings.append),
    )
    assert runner.run().stopped == "time limit"
    assert times.real - 100.0 == pytest.approx(1.0 + 4.0 + 1.0, abs=0.2)
    assert len(warnings) == 1


def test_of_two_clocks_in_turn_one_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch)
    looks = iter(range(10**9))
    pace = RosPace(times.controls, lambda: times.simulated + (1000.0 if next(looks) % 2 else 0.0))
    pace.begin()
    passed = sum(pace.sleep(0.05) for _ in range(100))
    assert passed == pytest.approx(5.0, abs=0.1)
    assert times.real - 100.0 == pytest.approx(5.0, abs=0.2)


def test_a_clock_that_has_leapt_is_followed_from_there(monkeypatch: pytest.MonkeyPatch) -> None:
    times = Times(monkeypatch)
    pace = times.pace()
    times.simulated += 500.0
    passed = sum(pace.sleep(0.05) for _ in range(40))
    assert passed == pytest.approx(2.0, abs=0.1)
    assert times.real - 100.0 == pytest.approx(3.0, abs=0.2)


class Rolling:
    """A robot that does not come to rest."""

    moving = True

    def step(self, dt: float) -> None:
        pass

    def stop(self) -> None:
        pass


def test_a_robot_gets_its_time_to_come_to_rest_by_the_clock_of_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the simulator is slow, and the run was stopped."""
    times, clock = Times(monkeypatch, factor=0.2), Clock()
    engine = Engine(Tree(Node("Sleep", (), (("msec", "5000"),))), lambda id: None, clock=clock)
    controls = times.controls
    runner = Runner(
        engine, bus=Bus(clock=clock), robot=Rolling(), controls=controls, pace=lambda speed, given: times.pace()
    )
    controls.stop()
    assert runner.run().stopped == "interrupted"
    assert clock.now == pytest.approx(2.0, abs=0.1)
    assert times.simulated - 5.0 == pytest.approx(2.0, abs=0.1)
    assert times.real - 100.0 == pytest.approx(10.0, abs=0.5)
