"""The time of day as a condition."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.actions.clock import time_of_day
from btlang.engine.clock import Clock
from btlang.engine.leaves.leaf import reason_text
from btlang.text.time_of_day import seconds_of


@pytest.mark.parametrize(
    ("now", "night", "work", "after", "before"),
    [
        ("00:00", True, False, False, True),
        ("05:59", True, False, False, True),
        ("06:00", True, True, False, True),
        ("06:01", False, True, False, True),
        ("17:59", False, True, False, True),
        ("18:00", False, True, False, False),
        ("18:01", False, False, True, False),
        ("21:59", False, False, True, False),
        ("22:00", True, False, True, False),
        ("23:59", True, False, True, False),
    ],
)
def test_when(now: str, night: bool, work: bool, after: bool, before: bool) -> None:
    clock = Clock()
    clock.day = lambda: seconds_of(now)
    assert bool(time_of_day(clock, at_least="22:00", at_most="06:00")) == night
    assert bool(time_of_day(clock, at_least="06:00", at_most="18:00")) == work
    assert bool(time_of_day(clock, above="18:00")) == after
    assert bool(time_of_day(clock, below="18:00")) == before


def test_why_not() -> None:
    answer = time_of_day(Clock(), above="18:00")
    assert not answer
    assert reason_text(answer.reason) == "it is 09:00"  # type: ignore[union-attr]


def test_the_clock_of_the_world(tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    world.write_text('clock = "2026-03-02 17:58"\nstart = { x = 1, y = 1 }')
    first = btlang.parse_tree("as soon as it is after 6 pm, nod", world=str(world))
    second = btlang.parse_tree("check that it is between 6 pm and 6:01 pm", world=str(world))
    with btlang.Session(world=str(world)) as session:
        outcome = session.run(first, speed="max").outcome
        again = session.run(second, speed="max").outcome
    assert outcome is not None
    assert again is not None
    assert 120 <= outcome.seconds < 122
    assert again.succeeded  # the world goes on, and so does its clock
