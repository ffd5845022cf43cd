"""What is outside the outer walls of a world."""

from __future__ import annotations

import pytest
from hypothesis import given

from btlang.robots.geometry import Pose
from btlang.robots.worlds.world import Door, World
from btlang.robots.worlds.world_bounds import closed_walls, is_outside
from btlang.robots.worlds.world_file import WorldError, load_world
from btlang.robots.worlds.world_writing import to_toml
from btlang.text.source import Source
from tests.profiles import searches
from tests.robots.random_worlds import worlds

START = "start = { x = 1, y = 1 }\n"
ROOM = START + "walls = [[[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]], [[3, 0], [3, 2]]]\n"


def told(text: str) -> list[tuple[int | None, str]]:
    """The lines and messages of all that is wrong with a world."""
    try:
        load_world(Source(text, "world.toml"), bounded=True)
    except WorldError as error:
        return [(each.line, each.message) for each in (error, *error.more)]
    return []


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ('places = [{ name = "lab", x = 7, y = 1 }]', 'the place "lab" at (7, 1)'),
        ("dock = { x = -1, y = 1 }", 'the place "dock" at (-1, 1)'),
        ('docks = [{ name = "bay", x = 7, y = 1 }]', 'the place "bay" at (7, 1)'),
        ('crowds = [{ name = "guest", count = 3, x = 7, y = 1, walks = [[5, 1]] }]', 'the person "guest 1" at (7, 1)'),
        ('crowds = [{ name = "guest", count = 3, x = 5, y = 1, walks = [[7, 1]] }]', 'a stop of "guest 1" at (7, 1)'),
        ('objects = [{ name = "cup", x = 7, y = 1 }]', 'the object "cup" at (7, 1)'),
        ('people = [{ name = "Vera", x = 7, y = 1 }]', 'the person "Vera" at (7, 1)'),
        ('people = [{ name = "Vera", x = 5, y = 1, walks = [[7, 1]] }]', 'a stop of "Vera" at (7, 1)'),
        ('zones = [{ name = "z", kind = "keep out", points = [[7, 0], [9, 0], [9, 2]] }]', 'the zone "z"'),
        ('doors = [{ name = "d", from = [7, 0], to = [8, 0] }]', 'the door "d"'),
    ],
)
def test_outside(line: str, what: str) -> None:
    assert told(ROOM + line) == [(3, f"{what} is outside the outer walls")]
    assert load_world(Source(ROOM + line, "world.toml"))  # it can be run all the same


@pytest.mark.parametrize(
    "line",
    [
        'objects = [{ name = "cup", x = 6, y = 1 }]',  # on the wall
        'doors = [{ name = "d", from = [6, 1], to = [7, 1] }]',  # an open leaf
        'zones = [{ name = "all", kind = "slow", speed = 1, points = [[-1, -1], [9, -1], [9, 9], [-1, 9]] }]',
        'zones = [{ name = "band", kind = "slow", speed = 1, points = [[-9, 1], [7, 1], [7, 2], [-9, 2]] }]',
    ],
)
def test_inside(line: str) -> None:
    assert told(ROOM + line) == []


def test_a_start_outside() -> None:
    assert told(ROOM.replace("x = 1,", "x = 9,")) == [(1, "the start at (9, 1) is outside the outer walls")]


def test_what_a_wall_is_around_is_inside_whichever_is_the_largest() -> None:
    far = ROOM.replace("[[3, 0]", "[[10, 0], [30, 0], [30, 20], [10, 20], [10, 0]], [[3, 0]")
    assert told(far + 'places = [{ name = "lab", x = 20, y = 10 }]') == []
    assert len(told(far + 'places = [{ name = "yard", x = 8, y = 1 }]')) == 1


def test_nothing_is_outside_open_walls() -> None:
    assert told(ROOM.replace(", [0, 0]]", "]") + 'objects = [{ name = "cup", x = 7, y = 1 }]') == []


def test_walls_and_doors_are_joined() -> None:
    walls = (((0.0, 0.0), (4.0, 0.0)), ((4.0, 3.0), (4.0, 0.0)), ((0.0, 3.0), (0.0, 1.0)), ((4.0, 3.0), (0.0, 3.0)))
    world = World(Pose(1.0, 1.0), walls=walls)
    assert closed_walls(world) == []
    [wall] = closed_walls(world.replace(doors=(Door("front door", (0.0, 0.0), (0.0, 1.0)),)))
    assert set(wall) == {(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 1.0)}


def test_walls_that_meet_three_by_three_are_closed() -> None:
    corners = [(0.0, 0.0), (4.0, 0.0), (8.0, 0.0), (8.0, 3.0), (4.0, 3.0), (0.0, 3.0)]
    walls = tuple((corners[at - 1], corners[at]) for at in range(6))
    more = (((4.0, 0.0), (4.0, 3.0)), ((4.0, 3.0), (5.0, 2.0)), ((8.5, 3.5), (8.5, 3.0)))
    [outline] = closed_walls(World(Pose(1.0, 1.0), walls=(*walls, *more)))
    assert [is_outside([outline], point) for point in ((2, 1), (6, 1), (9, 1), (4, 4))] == [False, False, True, True]


def test_a_closed_room_is_no_outer_wall_of_an_open_building() -> None:
    room = ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0), (1.0, 1.0))
    hall = ((0.0, 0.0), (9.0, 0.0), (9.0, 6.0), (0.0, 6.0), (0.0, 5.0))
    assert closed_walls(World(Pose(1.0, 1.0), walls=(room, hall))) == []
    assert len(closed_walls(World(Pose(1.0, 1.0), walls=(room, (*hall, (0.0, 0.0)))))) == 2


def test_all_is_told_at_once_and_at_its_line() -> None:
    text = ROOM + (
        'places = [\n  { name = "lab", x = "east", y = 1 },\n  { name = "bay", x = 9, y = 1 },\n'
        '  { name = "bay", x = 3.1, y = 1 },\n]\n[[zones]]\nname = "z"\nkind = "hot"\npoints = 3\ncolour = 1\n'
    )
    assert told(text) == [
        (4, '"x" must be a number; write x = 1.5'),
        (10, '"kind" must be one of "keep out", "slow", "area"'),
        (6, 'the name "bay" is given twice (places and places); give one another name'),
        (6, 'the place "bay" at (3.1, 1) is inside a wall or a box; leave 0.2 m to every wall'),
        (5, 'the place "bay" at (9, 1) is outside the outer walls'),
    ]


def test_docks_and_crowds_are_told_at_their_lines() -> None:
    text = START + (
        'dock = { x = 2, y = 1 }\nplaces = [\n  { name = "bay", x = 4, y = 1 },\n'
        '  { name = "Dock", x = 4, y = 1 },\n]\n'
        '[[docks]]\nname = "lab dock"\nx = "east"\ny = 1\n[[docks]]\nname = "Bay"\nx = 5\ny = 1\n'
        '[[crowds]]\nname = "guest"\ncount = 2\nx = 5\ny = 1\n[[crowds]]\nname = "Guest"\ncount = 1\nx = 5\ny = 1\n'
    )
    assert told(text) == [
        (9, '"x" must be a number; write x = 1.5'),
        (2, 'the name "dock" is given twice (places and dock); give one another name'),
        (12, 'the name "Bay" is given twice (places and docks); give one another name'),
        (21, 'the name "Guest 1" is given twice (crowds and crowds); give one another name'),
    ]


def test_no_more_than_a_hundred() -> None:
    assert len(told(START + "places = [\n" + "{ name = 3 },\n" * 5000 + "]")) == 100


@searches(40, 2000)
@given(world=worlds())
def test_any_world_has_bounds_or_none(world: World) -> None:
    assert all(" is outside the outer walls" in message for _, message in told(to_toml(world)))
