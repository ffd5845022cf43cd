"""WaitForTime follows the time of day, wherever that comes from."""

from __future__ import annotations

import math

import pytest

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine, EngineError
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.run.bus import Bus
from btlang.run.runner import Runner
from btlang.text.time_of_day import DAY, local, seconds_of, shown
from btlang.tree.node import Node, Tree

from .scripted import n

MINUTE, HOUR = 60.0, 3600.0


def engine(clock: Clock, time: str, root: Node | None = None) -> Engine:
    return Engine(Tree(root or n("WaitForTime", time=time)), lambda id: None, clock=clock)


class Day:
    """A clock on the wall, which can be set."""

    def __init__(self, time: str) -> None:
        self.seconds = seconds_of(time)
        self.clock = Clock()
        self.clock.day = lambda: self.seconds % DAY

    def pass_by(self, seconds: float) -> None:
        self.seconds += seconds
        self.clock.advance(seconds)


def test_a_run_waits_for_the_next_one() -> None:
    clock = Clock()
    runner = Runner(engine(clock, "09:30"), bus=Bus(clock=clock), rate=1.0, speed=math.inf)
    assert runner.run().seconds == pytest.approx(30 * MINUTE)


@pytest.mark.parametrize(("now", "left"), [("17:59", MINUTE), ("18:00", DAY), ("18:01", DAY - MINUTE)])
def test_it_is_due_at_the_next_such_minute(now: str, left: float) -> None:
    day = Day(now)
    assert engine(day.clock, "18:00").tick() == RUNNING
    assert day.clock.due == pytest.approx(left)


def test_a_loop_of_it_comes_round_once_a_day() -> None:
    day, counts = Day("17:59"), 0
    ticked = engine(day.clock, "", n("Repeat", n("WaitForTime", time="18:00"), num_cycles=3))
    while ticked.tick() == RUNNING:
        day.pass_by(day.clock.due - day.clock.now)
        day.clock.due = math.inf
        counts += 1
    assert day.clock.now == pytest.approx(2 * DAY + MINUTE)
    assert counts == 3


@pytest.mark.parametrize(("elapsed", "status"), [(59.9, RUNNING), (60.0, SUCCESS), (13 * HOUR, SUCCESS)])
def test_a_suspension_keeps_it_and_a_halt_forgets_it(elapsed: float, status: int) -> None:
    for keeps in (True, False):
        day = Day("17:59")
        waiting = engine(day.clock, "18:00")
        waiting.tick()
        waiting.suspend() if keeps else waiting.halt()
        day.pass_by(elapsed)
        assert waiting.tick() == (status if keeps else RUNNING)


def test_a_clock_that_is_set() -> None:
    day = Day("17:00")
    waiting = engine(day.clock, "18:00")
    waiting.tick()
    day.pass_by(59 * MINUTE)
    day.seconds -= HOUR
    day.clock.due = math.inf
    assert waiting.tick() == RUNNING
    assert day.clock.due - day.clock.now == pytest.approx(61 * MINUTE)
    day.seconds += 2 * HOUR
    assert waiting.tick() == SUCCESS


def test_a_clock_that_is_slower_than_the_mission() -> None:
    day = Day("17:59")
    waiting = engine(day.clock, "18:00")
    waiting.tick()
    day.pass_by(MINUTE)
    day.seconds -= 0.02
    day.clock.due = math.inf
    assert waiting.tick() == RUNNING
    day.pass_by(day.clock.due - day.clock.now)
    assert waiting.tick() == SUCCESS
    assert waiting.tick() == RUNNING  # and not twice


@pytest.mark.parametrize("time", ["", "25:00", "6 pm", "18:60", "18"])
def test_a_port_that_is_no_time(time: str) -> None:
    with pytest.raises(EngineError, match="needs a port time" if not time else "time must be a time of day such as"):
        engine(Clock(), time)


def test_a_time_on_the_blackboard() -> None:
    waiting = engine(Clock(), "{t}")
    assert waiting.tick() == FAILURE
    waiting.blackboard.set("t", "noon")
    assert waiting.tick() == FAILURE
    assert waiting.failure is not None
    assert "not 'noon'" in waiting.failure.reason
    waiting.blackboard.set("t", "9:01")
    assert waiting.tick() == RUNNING


def test_times_as_texts() -> None:
    assert [seconds_of(text) for text in ("00:00", "9:05", "23:59")] == [0, 32700, 86340]
    assert [shown(seconds) for seconds in (0, 32700.9, 86399, DAY)] == ["00:00", "09:05", "23:59:59", "00:00"]


def test_the_time_of_this_computer() -> None:
    assert 0 <= local(1.25) < DAY
    assert local(61.25) - local(1.25) == pytest.approx(60)
