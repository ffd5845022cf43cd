"""The map in a terminal: a picture of cells, and what it leaves out where there is no room."""

from __future__ import annotations

import pytest

from btlang.pictures.terminal_map import TerminalMap
from btlang.robots.geometry import Pose
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import read_world
from btlang.run.robot_state import RobotState
from btlang.text.source import Source

WORLD = """
start = { x = 1, y = 1 }
walls = [[[0, 0], [10, 0], [10, 5], [0, 5], [0, 0]], [[6, 0], [6, 3]]]
places = [{ name = "kitchen", x = 3, y = 4 }, { name = "lab", x = 8, y = 1 }]
objects = [{ name = "cup", x = 3, y = 3.9 }]
people = [{ name = "Zoë", x = 8, y = 4 }]
"""


@pytest.fixture
def world() -> World:
    return read_world(Source(WORLD, "world.toml"))


def drawn(shown: TerminalMap, state: RobotState | None, width: int = 40, height: int = 12) -> list[str]:
    columns, rows = shown.size(width, height)
    return ["".join(text for text, _ in line) for line in shown.lines(state, columns, rows)]


def test_with_the_signs_of_ascii(world: World) -> None:
    shown = TerminalMap(world, unicode=False)
    for step in range(30):
        shown.note(RobotState(pose=Pose(1 + step / 10, 1.0, 0.0)))
    lines = drawn(shown, RobotState(pose=Pose(4.0, 1.0, 0.0)))
    assert "\n".join(line.rstrip() for line in lines).rstrip() + "\n" == MAP


def test_a_wall_has_dots_and_the_robot_an_arrow(world: World) -> None:
    shown = TerminalMap(world, unicode=True)
    lines = drawn(shown, RobotState(pose=Pose(4.0, 1.0, 90.0)))
    assert sum(line.count("↑") for line in lines) == 1
    assert all(any(0x2800 < ord(sign) < 0x2900 for sign in line) for line in lines[1:-1])
    lines = drawn(shown, RobotState(pose=Pose(4.0, 1.0, -135.0)))
    assert sum(line.count("↙") for line in lines) == 1


def test_who_is_elsewhere_is_shown_there_and_who_is_gone_is_not(world: World) -> None:
    shown = TerminalMap(world, unicode=True)
    before = drawn(shown, None)
    [row] = [at for at, line in enumerate(before) if "Zoë" in line]
    after = drawn(shown, RobotState(things=(("Zoë", 8.0, 1.9, True),)))
    assert next(at for at, line in enumerate(after) if "Zoë" in line) > row
    assert not any("Zoë" in line for line in drawn(shown, RobotState(things=(("Zoë", None, None, False),))))


def test_a_name_that_would_touch_another_one_is_above_or_below_it(world: World) -> None:
    lines = drawn(TerminalMap(world, unicode=True), None)
    [kitchen] = [at for at, line in enumerate(lines) if "kitchen" in line]
    [cup] = [at for at, line in enumerate(lines) if "cup" in line]
    assert abs(kitchen - cup) == 1


def test_a_name_without_room_is_a_letter_that_hides_no_other_name() -> None:
    places = (("one", 3), ("two", 3), ("hidden", 3), ("wide name", 4.3))
    objects = ",".join(f'{{ name = "{name}", x = {x}, y = 4 }}' for name, x in places)
    text = f"{WORLD.split('objects')[0]}objects = [{objects}]"
    lines = "\n".join(drawn(TerminalMap(read_world(Source(text, "world.toml")), unicode=True), None))
    assert all(name in lines for name in ("kitchen", "one", "two"))
    assert "hidden" not in lines
    assert "kitchen w" in lines


def test_zones_have_an_outline_and_a_name() -> None:
    zones = """[[zones]]
name = "stairs"
kind = "keep out"
points = [[3, 2.5], [9, 2.5], [9, 4], [3, 4]]
[[zones]]
name = "hall"
kind = "area"
points = [[0, 0], [1, 0], [1, 1]]
"""
    world = f"start = {{ x = 1, y = 1 }}\nwalls = [[[0, 0], [10, 0], [10, 5], [0, 5], [0, 0]]]\n{zones}"
    shown = TerminalMap(read_world(Source(world, "world.toml")), unicode=False)
    lines = drawn(shown, None)
    assert "\n".join(lines).count("x") > 20
    assert any("stairs" in line for line in lines)
    assert not any("hall" in line for line in lines)
    columns, rows = shown.size(40, 12)
    styles = {style for line in shown.lines(None, columns, rows) for text, style in line if "x" in text}
    assert styles == {"red"}


@pytest.mark.parametrize(("width", "height"), [(15, 30), (80, 4), (0, 0)])
def test_where_there_is_no_room(width: int, height: int, world: World) -> None:
    assert TerminalMap(world, unicode=True).size(width, height) == (0, 0)


def test_it_keeps_to_its_room_in_any_size(world: World) -> None:
    shown = TerminalMap(world, unicode=True)
    shown.note(RobotState(pose=Pose(50.0, -70.0, 0.0)))  # off the map
    for width in range(16, 120, 7):
        for height in range(5, 60, 5):
            lines = drawn(shown, RobotState(pose=Pose(50.0, -70.0, 0.0)), width, height)
            assert len(lines) <= height
            assert max(map(len, lines)) <= width


MAP = """\
 ######################################
 #         cup                        #
 #       kitchen              Zoë     #
 #                                    #
 #                     #              #
 #                     #              #
 #                     #              #
 #                     #              #
 #  ............>      #      lab     #
 ######################################
"""
