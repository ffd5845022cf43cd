"""Worlds as files of Nav2, read as nav2_map_server reads them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from btlang.maps.importing import import_world
from btlang.maps.nav2 import nav2_files
from btlang.maps.occupancy import read_image, read_map
from btlang.robots.geometry import Pose, segment_distance
from btlang.robots.worlds.world import KEEP_OUT, SLOW, Door, FurnitureBox, Place, World, Zone
from tests.profiles import searches

ROOM = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0))
WORLD = World(
    Pose(1.0, 1.0),
    walls=(ROOM,),
    boxes=(FurnitureBox(3.0, 0.5, 0.4, 0.4),),
    places=(Place("lab", 1.0, 2.0, -90.0), Place('the "ä\U0001f600" bay', 2.0, 2.0)),
    zones=(
        Zone("stairs", KEEP_OUT, ((2.0, 1.0), (3.0, 1.0), (3.0, 2.0))),
        Zone("floor", SLOW, ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)), 0.2),
        Zone("drop", SLOW, ((0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0)), 0.1),
        Zone("ramp", SLOW, ((3.2, 2.2), (3.8, 2.2), (3.8, 2.8), (3.2, 2.8)), 2.0),
    ),
    doors=(Door("open", (0.0, 1.5), (0.5, 1.5)), Door("closed", (2.0, 2.5), (3.0, 2.5), open=False)),
)


@pytest.fixture
def yaml(tmp_path: Path) -> Any:
    for name, content in nav2_files(WORLD, 0.05, 0.5).items():
        (tmp_path / name).write_bytes(content)
    module = pytest.importorskip("yaml")
    return lambda name: module.safe_load((tmp_path / name).read_text())


def grey(folder: Path, yaml: Any, name: str, x: float, y: float) -> int:
    """The grey of an image of a map at a point of the world."""
    about = yaml(f"{name}.yaml")
    assert about["image"] == f"{name}.pgm"
    shades = read_image(str(folder / about["image"])).shades[::-1]
    column, row = ((at - about["origin"][axis]) / about["resolution"] for axis, at in enumerate((x, y)))
    return round(float(shades[int(row), int(column)]) * 255)


def test_the_map(tmp_path: Path, yaml: Any) -> None:
    points = {(2, 0): 0, (3, 0.5): 0, (2.5, 2.5): 0, (0.25, 1.5): 254, (1, 1): 254, (2.9, 1.1): 254, (-0.3, 1): 205}
    assert {point: grey(tmp_path, yaml, "map", *point) for point in points} == points


def test_the_keep_out_mask(tmp_path: Path, yaml: Any) -> None:
    points = {(2.8, 1.2): 0, (2.1, 1.9): 254, (0.5, 0.5): 254, (2, 0): 254}
    assert {point: grey(tmp_path, yaml, "keepout_mask", *point) for point in points} == points
    assert read_map(yaml("keepout_mask.yaml"), str(tmp_path)).occupied.any()


def test_the_speed_mask(tmp_path: Path, yaml: Any) -> None:
    assert yaml("speed_mask.yaml")["mode"] == "raw"
    info = yaml("filters.yaml")["speed_costmap_filter_info_server"]["ros__parameters"]
    assert info["type"] == 1

    def percent(x: float, y: float) -> float:
        value = grey(tmp_path, yaml, "speed_mask", x, y)
        return 100 if value == 0 else info["base"] + info["multiplier"] * value  # 0: no limit

    # of 0.5 m/s; where two zones overlap the slower counts, and none makes the robot faster
    assert [percent(*at) for at in ((0.2, 0.5), (0.7, 0.5), (3.5, 2.5), (2, 1.5))] == [40, 20, 100, 100]


def test_way_points_are_those_of_rviz(yaml: Any) -> None:
    points = yaml("waypoints.yaml")["waypoints"]
    assert list(points) == ["lab", 'the "ä\U0001f600" bay']
    assert points["lab"]["pose"] == [1.0, 2.0, 0.0]
    assert points["lab"]["orientation"] == pytest.approx([0.707107, 0, 0, -0.707107])


_numbers = st.floats(0.0, 6.0).map(lambda value: round(value, 2))
_walls = st.lists(st.tuples(_numbers, _numbers), min_size=2, max_size=4, unique=True).map(tuple)


@searches(15, 1000, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(walls=st.lists(_walls, min_size=1, max_size=3).map(tuple), resolution=st.sampled_from([0.05, 0.1, 0.13]))
def test_walls_come_back_within_two_cells(tmp_path: Path, walls: Any, resolution: float) -> None:
    pytest.importorskip("yaml")
    world = World(Pose(-5.0, -5.0), walls=walls)
    for name, content in nav2_files(world, resolution, 0.5).items():
        (tmp_path / name).write_bytes(content)
    again, notes = import_world([str(tmp_path / "map.yaml")], 0.2, world.start)
    assert notes == []
    assert farthest(world, again) <= 2 * resolution
    assert farthest(again, world) <= 2 * resolution


def farthest(one: World, other: World) -> float:
    """Metres that a point on the walls of one world is at most from those of another."""
    points = [
        (ax + (bx - ax) * share, ay + (by - ay) * share)
        for ax, ay, bx, by in one.wall_segments()
        for share in np.linspace(0, 1, 9).tolist()
    ]
    return max(min(segment_distance(point, piece) for piece in other.wall_segments()) for point in points)
