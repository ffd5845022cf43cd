"""Time in which this process ran, on a clock that the test moves. Needs no ROS 2."""

from __future__ import annotations

import math

from btlang.ros.clocks import AwakeClock


class Real:
    """Seconds of real time."""

    def __init__(self) -> None:
        self.seconds = 100.0

    def __call__(self) -> float:
        return self.seconds


def test_time_in_which_nobody_looked_is_no_time() -> None:
    real = Real()
    clock = AwakeClock(real)
    clock.watch()
    real.seconds += 1.0
    assert (clock.now(), clock.since_woke()) == (101.0, math.inf)
    real.seconds += 12.0
    assert (clock.now(), clock.naps, clock.nap) == (101.0, 1, 12.0)
    real.seconds += 0.5
    assert (clock.now(), clock.since_woke()) == (101.5, 0.5)


def test_where_no_node_watches_nothing_is_a_nap() -> None:
    real = Real()
    clock = AwakeClock(real)
    clock.watch()
    clock.unwatch()
    real.seconds += 300.0
    assert (clock.now(), clock.naps) == (400.0, 0)
