"""`btc world`: what it prints and writes, and its exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.robots.worlds.world import Place
from btlang.robots.worlds.world_file import load_world

SHOP = """start = { x = 1, y = 1, facing = 90 }
dock = { x = 0.5, y = 4.5, facing = 180 }
seed = 7
walls = [[[0, 0], [8, 0], [8, 5], [0, 5], [0, 0]], [[4, 0], [4, 2]], [[4, 3], [4, 5]]]
boxes = [{ x = 7, y = 1.5, width = 1, height = 0.4 }]
places = [{ name = "shelf", x = 7, y = 4, facing = 90 }]
objects = [{ name = "mug", x = 7, y = 1.5, kind = "cup", color = "red", known = false }, { name = "lamp", x = 1, y = 3, switch = "on" }]
doors = [{ name = "shop door", from = [4, 2], to = [4, 3], open = false }, { name = "back door", from = [7, 0], to = [8, 0] }]
zones = [{ name = "wet floor", kind = "slow", speed = 0.2, points = [[5, 0], [8, 0], [8, 2]] }, { name = "stairs", kind = "keep out", points = [[5, 2.5], [6, 2.5], [6, 3.5], [5, 3.5]] }]
people = [{ name = "Vera", x = 1, y = 4, comes = 10, walks = ["shelf", { to = [5, 0.6], at = 40, stays = 10 }] }]
"""  # noqa: E501


@pytest.fixture(autouse=True)
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("shop.toml").write_text(SHOP)


def btc(*words: str) -> int:
    return main(["world", *words])


def test_summary(capsys: pytest.CaptureFixture[str]) -> None:
    assert btc("shop.toml") == 0
    assert capsys.readouterr().out.splitlines() == [
        "size: 8 m x 5 m",
        "start: (1, 1), facing 90",
        "places: shelf, dock",
        "objects: mug (red, cup, not known), lamp (is on)",
        "people: Vera (comes at 10 s, walks to 2 stops)",
        "zones: wet floor (slow, 0.2 m/s), stairs (keep out)",
        "doors: shop door (closed), back door (open)",
        "seed: 7",
    ]


def test_check(capsys: pytest.CaptureFixture[str]) -> None:
    assert btc("check", "shop.toml", "shop.toml") == 0
    assert capsys.readouterr().out == "No problems found.\n"
    Path("bad.toml").write_text('start = { x = 1 }\nwals = []\nplaces = [\n  { name = "a", x = true, y = 1 },\n]\n')
    assert btc("check", "bad.toml", "shop.toml", "none.toml") == 2
    told = capsys.readouterr()
    assert told.out == ""
    places = [line.partition(" error ")[0] for line in told.err.splitlines() if " error " in line]
    assert places == ["bad.toml:1:1:", "bad.toml:2:1:", "bad.toml:4:1:", "none.toml:1:1:"]


def test_check_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    Path("bad.toml").write_text(SHOP.replace("x = 7, y = 4,", "x = 9, y = 4,"))
    assert btc("check", "shop.toml", "bad.toml", "--format", "json") == 2
    [problem] = json.loads(capsys.readouterr().out)
    assert (problem["file"], problem["line"], problem["code"]) == ("bad.toml", 6, "BT070")
    assert 'the place "shelf" at (9, 4) is outside the outer walls' in problem["message"]
    assert btc("check", "shop.toml", "--format", "json") == 0
    assert capsys.readouterr().out == "[]\n"


def test_the_body_counts() -> None:
    Path("narrow.toml").write_text("start = { x = 1, y = 0.15 }\nwalls = [[[0, 0], [9, 0]]]\n")
    assert btc("check", "narrow.toml") == 2
    Path("small.toml").write_text('name = "small"\nradius = 0.1\n')
    assert btc("check", "narrow.toml", "--robot", "small.toml") == 0


@pytest.mark.parametrize("ending", ["svg", "png"])
def test_picture(ending: str) -> None:
    pytest.importorskip("matplotlib")
    assert btc("shop.toml", "--picture", f"shop.{ending}") == 0
    assert len(Path(f"shop.{ending}").read_bytes()) > 5000


@pytest.mark.parametrize("to", ["json", "yaml"])
def test_worlds_come_back(to: str) -> None:
    pytest.importorskip("yaml")
    assert btc("export", "shop.toml", "--to", to, "-o", f"shop.{to}") == 0
    assert btc("import", f"shop.{to}", "-o", "again.toml") == 0
    assert load_world("again.toml") == load_world("shop.toml")


def test_nav2_and_back(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("yaml")
    assert btc("export", "shop.toml", "--to", "nav2", "-o", "maps") == 0
    assert btc("import", "maps/map.yaml", "maps/waypoints.yaml", "-o", "again.toml", "--start", "1,1,90") == 0
    assert capsys.readouterr().err == 'Warning: on the map there is no way from the start to the place "shelf"\n'
    world = load_world("again.toml", bounded=True)  # the shelf is behind a closed door, in a room of the same map
    assert [(place.name, place.x, place.y) for place in world.places] == [("shelf", 7.0, 4.0), ("dock", 0.5, 4.5)]
    assert world.places[0].facing == pytest.approx(90)
    assert world.dock == Place("dock", 0.5, 4.5, world.places[1].facing)
    assert len(world.wall_segments()) == 12  # two rooms apart behind a closed door, a box


def test_walls_of_a_map_and_places_of_a_rover(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("yaml")
    assert btc("export", "shop.toml", "--to", "nav2", "-o", "maps") == 0
    points = {"desk": [2, 2, 1.57], "Desk": [2, 3], "sill": [2, 0.1], "moon": [20, 2], "in the box": [7, 1.5]}
    Path("points.json").write_text(json.dumps(points))
    capsys.readouterr()
    assert btc("import", "maps/map.yaml", "points.json", "-o", "again.toml") == 0
    told = capsys.readouterr().err.splitlines()
    assert told[0] == 'Warning: on the map there is no way from the start to the place "in the box"'
    assert told[1] == 'Warning: the name "Desk" is given twice; the second is called "Desk 2"'
    assert told[2].startswith('Warning: the place "sill" at (2, 0.1) is too near to a wall, so it is moved to (2')
    assert told[-1] == 'Warning: the place "moon" is outside the outer walls'
    world = load_world("again.toml")
    assert (world.start.x, world.start.y) == (2.0, 2.0)
    assert world.names.places[:2] == ("desk", "Desk 2")


def test_what_cannot_be_moved_is_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    rails = [[[0, 0.3 * row], [9, 0.3 * row]] for row in range(12)]
    Path("rails.json").write_text(json.dumps({"world": {"start": {"x": 5, "y": 9}, "walls": rails}}))
    Path("points.json").write_text('{"between": [4, 1.7]}')
    assert btc("import", "rails.json", "points.json", "-o", "again.toml") == 0
    assert capsys.readouterr().err == (
        'Warning: the place "between" at (4, 1.7) is too near to a wall, so it is left out\n'
    )
    assert load_world("again.toml").places == ()


def test_a_map_alone_has_a_start_where_there_is_room(capsys: pytest.CaptureFixture[str]) -> None:
    Path("map.json").write_text('{"image": "map.pgm", "resolution": 0.1, "origin": [-1, -1, 0]}')
    rows = [bytes([0] * 30), *[bytes([0] + [254] * 28 + [0])] * 20, bytes([0] * 30)]
    Path("map.pgm").write_bytes(b"P5 30 22 255\n" + b"".join(rows))
    assert btc("import", "map.json", "-o", "room.toml") == 0
    told = "Warning: the files have no start, so the robot starts at (0.05, 0.05)\n"
    assert capsys.readouterr().err == told
    assert btc("check", "room.toml") == 0
    assert btc("import", "map.json", "-o", "room.toml", "--start=-3,0") == 2
    assert "isn't on free floor of the map; give one with --start X,Y, such as --start=0.05,0.05" in (
        capsys.readouterr().err
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["import", "no.json", "-o", "a.toml"], "error BT001"),
        (["import", "shop.toml", "-o", "a.toml"], "error BT075"),
        (["import", "walls.json", "-o", "a.toml"], "there are no way points in it: write for example"),
        (["import", "bad.json", "-o", "a.toml"], '"x" must be a number; write x = 1.5'),
        (["import", "two.json", "two.json", "-o", "a.toml"], "only one of the files may be a whole world"),
        (["import", "map.json", "-o", "a.toml"], "the map has no free floor where the robot has room"),
        (["import", "map.json", "points.json", "-o", "a.toml"], "the start at (1, 1) isn't on free floor of the map"),
        (["export", "no.toml", "--to", "json", "-o", "a.json"], "error BT001"),
        (["export", "shop.toml", "--to", "json", "-o", "no/a.json"], "error BT009"),
        (["export", "shop.toml", "--to", "nav2", "-o", "shop.toml"], "error BT009"),
    ],
    ids=str,
)
def test_bad_input(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("yaml")
    Path("walls.json").write_text('{"walls": []}')
    Path("bad.json").write_text('{"world": {"start": {"x": NaN, "y": 1}, "walls": 3}}')
    Path("two.json").write_text('{"world": {"start": {"x": 1, "y": 1}}}')
    Path("points.json").write_text("[[1, 1]]")
    Path("map.json").write_text('{"image": "map.pgm", "resolution": 0.05}')
    Path("map.pgm").write_bytes(b"P5 2 2 255\n\0\0\0\0")
    assert btc(*words) == 2
    assert message in capsys.readouterr().err
    assert not Path("a.toml").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["check"], "check needs a file"),
        (["shop.toml", "more.toml"], "unexpected argument 'more.toml'"),
        (["export", "shop.toml", "-o", "a"], "choose what to export to with --to: nav2, json, yaml"),
        (["export", "shop.toml", "--to", "json"], "export needs -o OUT"),
        (["shop.toml", "--to", "json"], "--to isn't for a world alone"),
        (["check", "shop.toml", "--start", "1,2"], "--start isn't for check"),
        (["import", "a.json", "-o", "b", "--start", "here"], "expected X,Y or X,Y,FACING"),
        (["import", "a.json", "-o", "b", "--start", "nan,1"], "expected X,Y or X,Y,FACING"),
        (["import", "a.json", "-o", "b", "--origin", "91,1"], "expected LAT,LON"),
        (["shop.toml", "--picture", "a.gif"], "expected a file that ends in .svg or .png"),
        (["shop.toml", "--format", "json"], "--format json is for check and import"),
        (["export", "shop.toml", "--to", "nav2", "-o", "a", "--resolution", "0.0001"], "from 0.005 to 10"),
        (["export", "far.toml", "--to", "nav2", "-o", "a"], "cells are too many; use a larger --resolution"),
    ],
    ids=str,
)
def test_usage_errors(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("far.toml").write_text("start = { x = 1, y = 1 }\nwalls = [[[-1000000, 5], [1000000, 1000000]]]\n")
    with pytest.raises(SystemExit) as caught:
        btc(*words)
    assert caught.value.code == 2
    assert message in capsys.readouterr().err
