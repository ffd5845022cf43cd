"""World files: what they may hold, and one message for everything that may be wrong with them."""

import subprocess
import sys
from pathlib import Path

import pytest

from btlang.robots.geometry import Pose
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import Place
from btlang.robots.worlds.world_file import DEFAULT_WORLD, WorldError, load_world, world_names

WORLDS = sorted((Path(__file__).parents[2] / "examples" / "worlds").glob("*.toml"))


def test_the_default_world():
    names = world_names()
    assert {"lobby", "lab", "kitchen", "office", "hall", "dock", "door"} <= set(names.places)
    assert {"Alice", "Bob"} <= set(names.people)
    assert {"cup", "red ball", "book"} <= set(names.objects)
    assert load_world() == load_world(DEFAULT_WORLD)


@pytest.mark.parametrize("path", WORLDS, ids=lambda path: path.stem)
def test_examples_load(path):
    assert load_world(path).names.places


def test_names_need_no_numpy():
    code = (
        "import sys; from btlang.robots.worlds.world_file import world_names; world_names(); "
        "print('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"


def test_everything_is_read(tmp_path):
    path = tmp_path / "world.toml"
    path.write_text(
        """
        start = { x = 1, y = 2, facing = 90, battery = 50 }
        dock = { x = 5, y = 5, facing = -90 }
        walls = [[[0, 0], [9, 0], [9, 9]]]
        boxes = [{ x = 7, y = 7, width = 1, height = 1 }]
        [[places]]
        name = "red  room"
        x = 3
        y = 3
        [[faults]]
        kind = "slip"
        grip = 0.5
        from = 2
        """
    )
    world = load_world(path)
    assert world.start == Pose(1.0, 2.0, 90.0)
    assert world.battery == 50.0
    assert world.names.places == ("red room", "dock")
    assert world.dock == Place("dock", 5.0, 5.0, -90.0)
    assert len(world.segments()) == 6
    assert (world.faults[0].start, world.faults[0].wheel) == (2.0, "both")


def test_a_place_may_be_added_or_moved():
    world = load_world().with_places([Place("Lab", 1.0, 1.0), Place("bay", 2.0, 2.0)])
    assert world.names.places.count("lab") == 0
    assert world.names.places[-2:] == ("Lab", "bay")


def test_the_time_of_day(tmp_path):
    path = tmp_path / "world.toml"
    path.write_text('clock = "2026-03-02 23:59"\nstart = { x = 1, y = 2 }')
    robot = SimulatedRobot(load_world(path))
    assert robot.time_of_day == 23 * 3600 + 59 * 60
    robot.step(61.5)
    assert robot.time_of_day == pytest.approx(1.5)
    assert SimulatedRobot(load_world()).time_of_day == 9 * 3600


START = "start = { x = 1, y = 1 }\n"


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", None, 'a world needs a table "start"'),
        ("start = 3", 1, '"start" must be a table; write start = { x = 1, y = 1 }'),
        ("start = { x = 1 }", 1, 'start needs a number "y"'),
        ("x = = 3", 1, "this isn't TOML: Invalid value (at line 1, column 5)"),
        (START + "wals = []", 2, 'unknown key "wals" in a world; the keys are start, walls,'),
        (START + "walls = 3", 2, '"walls" must be a list; write walls = [ ... ]'),
        (START + "walls = [\n[[0, 0], [4, 0]],\n[[0, 0]],\n]", 4, "a wall is a list of two or more points"),
        (START + "[[walls]]\nx = 1", 2, "a wall is a list of two or more points"),
        (START + "walls = [[[0, 0], [4, true]]]", 2, "a wall is a list of two or more points"),
        (START + "places = [3]", 2, '"places" must be a list of tables; write [[places]] above each'),
        (START + "[[places]]\nname = 3\nx = 1\ny = 1", 3, '"name" must be text in quotes; write name = "kitchen"'),
        (START + '[[places]]\nname = " "\nx = 1\ny = 1', 3, '"name" must be text in quotes'),
        (START + '[[places]]\nname = "a"\nx = "1"\ny = 1', 4, '"x" must be a number; write x = 1'),
        (START + '[[places]]\nname = "a"\nx = nan\ny = 1', 4, '"x" must be a number'),
        (START + '[[places]]\nname = "a"\ny = 1', 2, 'places needs a number "x"'),
        (
            START + '[[places]]\nname = "a"\nx = 1\ny = 1\nface = 3',
            6,
            'unknown key "face" in places; the keys are facing',
        ),
        (
            START + '[[people]]\nname = "A"\nx = 3\ny = 3\n[[objects]]\nname = "a"\nx = 2\ny = 2',
            3,
            'the name "A" is given',
        ),
        (START + '[[objects]]\nname = "a"\nx = 3\ny = 3\nradius = 0', 6, '"radius" must be at least 0.01, not 0'),
        (START + "clock = 9", 2, '"clock" must be a date and a time in quotes; write clock = "2026-03-02 08:55"'),
        (START + 'clock = "08:55"', 2, '"clock" must be a date and a time'),
        (START + 'clock = "2026-02-30 08:55"', 2, '"clock" must be a date and a time'),
        (START + 'clock = "2026-03-02 24:00"', 2, '"clock" must be a date and a time'),
        ("start = { x = 1, y = 1, battery = 120 }", 1, '"battery" must be from 0 to 100, not 120'),
        (START + "walls = [[[0, 1], [4, 1]]]", 1, "the start at (1, 1) is inside a wall or a box; leave 0.2 m"),
        (START + "boxes = [{ x = 1, y = 1, width = 5, height = 5 }]", 1, "the start at (1, 1) is inside"),
        (
            START + 'walls = [[[3, 0], [3, 4]]]\nplaces = [\n{ name = "a", x = 2, y = 2 },\n'
            '{ name = "b", x = 3.1, y = 2 },\n]',
            5,
            'the place "b" at (3.1, 2) is inside',
        ),
        (START + "dock = { x = 3.1, y = 2 }\nwalls = [[[3, 0], [3, 4]]]", 2, 'the place "dock" at (3.1, 2) is inside'),
        (
            START + '[[faults]]\nkind = "fire"',
            3,
            '"kind" must be one of "blocked", "slip", "silent scanner", "weak hand", "dock"',
        ),
        (
            START + '[[faults]]\nkind = "blocked"\nplace = "moon"',
            4,
            '"place" must be one of nothing, because there is none',
        ),
        (START + '[[faults]]\nkind = "slip"\ngrip = 2', 4, '"grip" must be from 0 to 1, not 2'),
        (START + '[[faults]]\nkind = "silent scanner"\nhand = "left"', 4, 'unknown key "hand" in faults'),
        (START + '[[faults]]\nkind = "weak hand"\nhand = "both"', 4, '"hand" must be one of "left", "right"'),
        (START + '[[faults]]\nkind = "dock"\ntimes = 0', 4, '"times" must be at least 1, not 0'),
    ],
)
def test_what_may_be_wrong(tmp_path, text, line, message):
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(WorldError) as caught:
        load_world(path)
    assert message in caught.value.message
    assert caught.value.line == line
    assert caught.value.path == str(path)


def test_unreadable_files(tmp_path):
    with pytest.raises(WorldError, match="cannot read the world file: No such file"):
        load_world(tmp_path / "none.toml")
    with pytest.raises(WorldError, match="cannot read the world file"):
        load_world(tmp_path)
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(WorldError, match="a world file must be UTF-8 text"):
        load_world(binary)
