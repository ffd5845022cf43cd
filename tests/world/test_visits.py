"""Who comes again and again: once on each of some days, between two times."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.robots.robot import RobotError
from btlang.robots.worlds.world import Visits
from btlang.robots.worlds.world_file import WorldError, load_world
from btlang.text.source import Source
from btlang.text.time_of_day import DAY
from tests.profiles import only_long
from tests.world.test_people import Life

CROWD = """
clock = "2026-03-03 09:59"
start = { x = 1, y = 1 }
places = [{ name = "entrance", x = 1, y = 3 }, { name = "table", x = 6, y = 4 }]
walls = [[[0, 0], [8, 0], [8, 5], [0, 5], [0, 0]]]

[[crowds]]
name = "guest"
count = 3
x = 2
y = 3
visits = { from = "10:00", until = "10:05", stays = 60, days = ["Tuesday"] }
asks = ["Where is the cafe?"]
"""


@given(
    start=st.floats(0, 40_000), length=st.floats(60, 40_000), share=st.floats(0.1, 1), now=st.floats(0, 20 * DAY),
    days=st.sets(st.integers(0, 6), min_size=1), weekday=st.integers(0, 6),
)  # fmt: skip
def test_a_visit_lies_between_its_times(
    start: float, length: float, share: float, now: float, days: set[int], weekday: int
) -> None:
    visits = Visits(start, start + length, share * length, tuple(days))
    comes, leaves = visits.next(now, weekday, "1 Vera")
    day = comes // DAY
    assert now <= comes < leaves
    assert start - 1e-3 <= comes - day * DAY
    assert leaves - day * DAY <= start + length + 1e-3
    assert (weekday + day) % 7 in days
    assert comes - now < 15 * DAY
    assert visits.next(now, weekday, "1 Vera") == (comes, leaves)


@only_long
def test_a_crowd_comes_on_its_day_and_not_on_the_next() -> None:
    life = Life(load_world(Source(CROWD, "world.toml")))
    life.after(420)
    comes = [name for kind, name in life.kinds("come")]
    assert sorted(comes) == ["guest 1", "guest 2", "guest 3"]
    assert all(life.point(name) is None for name in comes)
    until = life.robot.time + DAY
    while life.robot.time < until:
        life.robot.step(60.0)
    assert len(life.kinds("come")) == 3


def test_nobody_knows_where_somebody_is_who_has_not_come_yet() -> None:
    life = Life(load_world(Source(CROWD, "world.toml")))
    with pytest.raises(RobotError, match="haven't seen the guest 1"):
        life.robot.locate("guest 1")


def test_somebody_of_a_crowd_asks_the_robot() -> None:
    text = CROWD.replace("y = 3\nvisits", "y = 1.2\nspeed = 0.05\nvisits").replace("stays = 60", "stays = 300")
    life = Life(load_world(Source(text, "world.toml")))
    life.after(360)
    assert ("speak", "Where is the cafe?") in life.kinds("speak") or ("hear", "Where is the cafe?") in life.kinds(
        "hear"
    )


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('from = "10:00"', 'from = "ten"', '"from" must be a time of day'),
        ('until = "10:05"', 'until = "9:05"', '"until" must be later'),
        ("stays = 60", "stays = 6000", '"stays" must be'),
        ('"Tuesday"', '"Dienstag"', "is no day"),
        ("count = 3", "count = 0", '"count" must be'),
        ("asks", "comes = 3\nasks", "not both"),
    ],
)
def test_wrong_crowds_are_refused(old: str, new: str, reason: str) -> None:
    with pytest.raises(WorldError) as caught:
        load_world(Source(CROWD.replace(old, new), "world.toml"))
    assert reason in str(caught.value)
