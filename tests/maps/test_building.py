"""Levels of Open-RMF buildings."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.maps.building import read_building
from btlang.robots.worlds.world import Door, Lane, Place
from btlang.robots.worlds.world_file import load_world
from btlang.text.toml_table import Problem

CHARGER = {"is_charger": [4, True], "spawn_robot_name": [1, "tiny"]}
LEVEL: dict[str, Any] = {
    "vertices": [
        [0, 0, 0, ""], [100, 0, 0, ""], [200, 0, 0, ""], [200, 100, 0, ""], [100, 100, 0, ""], [0, 100, 0, ""],
        [50, 50, 0, "front_desk"], [150, 50, 0, "charger", CHARGER], [100, 40, 0, ""], [100, 60, 0, ""],
    ],
    "walls": [[0, 1, {}], [1, 2, {}], [2, 3, {}], [3, 4, {}], [4, 5, {}], [5, 0, {}], [1, 8, {}], [9, 4, {}]],
    "doors": [[8, 9, {"name": [1, "lab_door"], "type": [1, "hinged"]}]],
    "lanes": [[6, 7, {"bidirectional": [4, True]}], [7, 6, {}], [8, 9, {"bidirectional": [4, False]}]],
    "measurements": [[0, 2, {"distance": [3, 10.0]}]],
}  # fmt: skip
LIFTS = {"lift_1": {"x": 20, "y": 20, "level_doors": {"L1": ["door1"]}}, "lift_2": {"x": 1, "y": 1, "level_doors": {}}}
BUILDING: dict[str, Any] = {"name": "lab", "levels": {"L1": LEVEL}, "lifts": LIFTS}


def test_a_level_becomes_a_world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.chdir(tmp_path)
    Path("lab.json").write_text(json.dumps(BUILDING))
    assert main(["world", "import", "lab.json", "-o", "lab.toml"]) == 0
    told = capsys.readouterr()
    assert told.out.splitlines()[0] == "lab.json: the level L1 of a building, with 3 places and 2 lanes"
    assert told.err == ""
    assert "-0]" not in Path("lab.toml").read_text()
    world = load_world("lab.toml", bounded=True)
    assert (world.start.x, world.start.y) == (7.5, -2.5)  # the drawing counts down, and is 5 cm a pixel
    assert world.docks == (Place("charger", 7.5, -2.5, 0.0),)
    assert {place.name: place.kind for place in world.places} == {"front desk": "", "lift 1": "lift", "charger": ""}
    assert world.lanes == (Lane((2.5, -2.5), (7.5, -2.5)), Lane((5.0, -2.0), (5.0, -3.0), one_way=True))
    assert world.doors == (Door("lab door", (5.0, -2.0), (5.0, -3.0)),)
    assert len(world.wall_segments()) == 8
    assert (
        main(["run", "--speed", "max", "--quiet", "--world", "lab.toml", "-c", "go to the front desk then dock"]) == 0
    )


def test_metres_are_taken_as_they_are() -> None:
    level = {**LEVEL, "measurements": []}
    found = read_building({**BUILDING, "coordinate_system": "cartesian_meters", "levels": {"L1": level}}, "L1")
    assert found.places[0] == Place("front desk", 50.0, 50.0)


@pytest.mark.parametrize(
    ("change", "level", "message"),
    [
        (
            {"levels": {"L1": LEVEL, "L2": LEVEL}},
            None,
            "the building has the levels L1, L2; choose one with --level L1",
        ),
        ({}, "L9", "there is no level 'L9'; there are: L1"),
        ({"levels": {}}, None, "there is no level None; there are: none"),
        ({"coordinate_system": "wgs84"}, None, "coordinates in 'wgs84' can't be read"),
        ({"levels": {"L1": {**LEVEL, "measurements": []}}}, None, "the level L1 has no measurements"),
        ({"levels": {"L1": {**LEVEL, "walls": [[0, 99, {}]]}}}, None, "L1.walls[0] must begin with the numbers of two"),
        ({"levels": {"L1": {**LEVEL, "vertices": [[0]]}}}, None, "L1.vertices[0] must be a list [x, y, z, name]"),
        ({"levels": {"L1": {**LEVEL, "vertices": [["a", 1]]}}}, None, "L1.vertices[0] must be a number, not 'a'"),
        ({"levels": {"L1": {**LEVEL, "doors": {}}}}, None, "L1.doors must be a list"),
        ({"lifts": {"a": {"level_doors": {"L1": ["d"]}}}}, None, "lifts.a.x must be a number, not None"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_what_may_be_wrong(change: dict[str, Any], level: str | None, message: str) -> None:
    with pytest.raises(Problem) as caught:
        read_building({**BUILDING, **change}, level)
    assert message in str(caught.value)
