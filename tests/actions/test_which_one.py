"""Which of several things the robot chooses, regions that it enters and leaves, sides of things, days of the week."""

from __future__ import annotations

from typing import Any

import pytest

from btlang.actions import clock, errands, navigation, world
from btlang.actions import navigation as sides
from btlang.engine.clock import Clock
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world_file import WorldError, load_world, world_names
from btlang.robots.worlds.world_writing import as_data
from btlang.text.source import Source
from btlang.vocabulary.references import SELF

TEXT = """
start = { x = 5, y = 5, facing = 90 }
home = "dock"
dock = { x = 1, y = 1 }
walls = [[[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]]
places = [
  { name = "north 2", kind = "spot", x = 5, y = 8 },
  { name = "north 10", kind = "spot", x = 1, y = 5 },
  { name = "north 1", kind = "spot", x = 9, y = 5 },
  { name = "yard", x = 8, y = 8, points = [[7, 7], [10, 7], [10, 10], [7, 10]] },
]
objects = [
  { name = "first cube", kind = "cube", x = 4, y = 6 },
  { name = "second cube", kind = "cube", x = 6, y = 6.5 },
  { name = "third cube", kind = "cube", x = 7, y = 2.5 },
]
people = [{ name = "Alice", x = 3, y = 8 }, { name = "Bob", x = 7, y = 5 }]
zones = [{ name = "carpet", kind = "slow", speed = 0.3, points = [[2, 0], [8, 0], [8, 2], [2, 2]] }]
"""


@pytest.fixture
def b(bench: Any) -> Any:
    return bench(load_world(Source(TEXT)))


@pytest.mark.parametrize(
    ("how", "parts", "name"),
    [
        ("1", {}, "first cube"),
        ("2", {}, "second cube"),
        ("-1", {}, "third cube"),
        ("-2", {}, "second cube"),
        ("furthest", {}, "third cube"),
        ("leftmost", {}, "first cube"),
        ("rightmost", {}, "second cube"),
        ("nearest", {"other_than": "first cube"}, "second cube"),
        ("nearest", {"between": "yard; and dock"}, "first cube"),
    ],
)
def test_it_chooses_a_cube(b: Any, how: str, parts: dict[str, str], name: str) -> None:
    assert b.robot.choose("object", how, {"kind": "cube", **parts}) == name


def test_things_of_a_set_come_from_several_places(b: Any) -> None:
    near = {each: b.robot.described("object", {"kind": "cube", "at": each}) for each in ("north 2", "north 1")}
    both = b.robot.described("object", {"kind": "cube", "at": "north 2; and north 1"})
    assert set(both) == {cube for cubes in near.values() for cube in cubes}
    assert len(both) > max(map(len, near.values()))


def test_places_are_counted_from_where_the_mission_began(b: Any) -> None:
    line = [b.robot.choose("place", str(number), {"kind": "spot"}) for number in (1, 2, 3)]
    b.run(navigation.go_to, place=line[2])
    assert [b.robot.choose("place", str(number), {"kind": "spot"}) for number in (1, 2, 3)] == line


def test_places_are_counted_by_their_names_where_the_world_says_so(bench: Any) -> None:
    b = bench(load_world(Source(TEXT.replace("home =", 'ordinals = "name"\nhome ='))))
    line = [b.robot.choose("place", str(number), {"kind": "spot"}) for number in (1, 2, -1)]
    assert line == ["north 1", "north 2", "north 10"]


def test_another_place_is_not_where_the_robot_is(b: Any) -> None:
    nearest = b.robot.choose("place", "nearest", {"kind": "spot"})
    b.run(navigation.go_to, place=nearest)
    assert b.robot.choose("place", "nearest", {"kind": "spot"}) == nearest
    assert b.robot.choose("place", "nearest", {"kind": "spot", "other_than": SELF}) != nearest
    b.run(navigation.go_to, place="yard")
    assert "yard" not in b.robot.described("place", {"other_than": SELF})


def test_there_may_be_too_few(b: Any) -> None:
    with pytest.raises(
        RobotError, match=r"^number 4 is asked for, but there's only first cube, second cube, third cube$"
    ):
        b.robot.choose("object", "4", {"kind": "cube"})


def test_what_the_robot_sees_and_holds(b: Any) -> None:
    assert b.robot.choose("object", "nearest", {"seen_by": SELF}) == "first cube"
    with pytest.raises(RobotError, match="held by"):
        b.robot.choose("object", "nearest", {"kind": "cube", "held_by": SELF})
    b.run(errands.hold, object="third cube")
    b.run(errands.hold, object="third cube")  # it is in the hand: nothing to do
    assert b.robot.choose("object", "nearest", {"kind": "cube", "held_by": SELF}) == "third cube"
    b.run(errands.bring, object="third cube", person="Bob")
    assert b.robot.choose("object", "nearest", {"kind": "cube", "held_by": "Bob"}) == "third cube"


def test_it_goes_into_and_out_of_regions(b: Any) -> None:
    b.run(world.enter_zone, zone="carpet")
    assert world.in_zone(b.robot, "carpet")
    entered = b.robot.time
    b.run(world.enter_zone, zone="carpet")
    assert b.robot.time == entered
    b.run(world.leave_zone, zone="carpet")
    assert not world.in_zone(b.robot, "carpet")
    b.run(navigation.go_to, place="yard", via="carpet")
    assert world.in_zone(b.robot, "yard")
    b.robot.zones.close("carpet")
    with pytest.raises(ActionFailed, match="carpet, where the robot may not go"):
        b.run(world.enter_zone, zone="carpet")


@pytest.mark.parametrize(
    ("side", "where", "point"),
    [
        ("left", {"place": "north 2"}, (4.0, 8.0)),
        ("right", {"place": "north 2"}, (6.0, 8.0)),
        ("behind", {"place": "north 2"}, (5.0, 9.0)),
        ("front", {"person": "Bob"}, (6.0, 5.0)),
        ("middle", {"zone": "yard"}, (8.5, 8.5)),
    ],
)
def test_it_goes_to_sides(b: Any, side: str, where: dict[str, str], point: tuple[float, float]) -> None:
    b.run(sides.go_to_side, side=side, **where)
    assert b.robot.pose.distance_to(point) < 0.3


def test_what_has_no_region_has_no_middle(b: Any) -> None:
    with pytest.raises(ActionFailed, match=r"^the north 2 has no middle: the world doesn't say how far it reaches$"):
        b.run(sides.go_to_side, side="middle", place="north 2")


def test_a_world_says_what_home_is() -> None:
    loaded = load_world(Source(TEXT))
    assert (loaded.home, as_data(loaded)["home"]) == ("dock", "dock")
    assert ("home", "") in dict(world_names(Source(TEXT)).features["place"])["dock"]
    with pytest.raises(WorldError, match="home"):
        load_world(Source(TEXT.replace('"dock"', '"moon"')))


def test_days_of_the_week() -> None:
    now = Clock()
    assert clock.today_is(now, "Monday") is True
    assert clock.today_is(now, "weekdays") is True
    assert not clock.today_is(now, "weekends;Tuesday")
    now.week = lambda: 6
    assert clock.today_is(now, "Saturday;Sunday") is True
    assert clock.today_is(now, "weekends") is True
