"""Worlds as files of Nav2, read as nav2_map_server reads them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from btlang.maps.importing import import_world
from btlang.maps.nav2 import CellGrid, nav2_files
from btlang.maps.occupancy import OccupancyMap, read_image, read_map
from btlang.maps.reach import reached
from btlang.robots.geometry import Pose, segment_distance
from btlang.robots.worlds.world import KEEP_OUT, SLOW, Door, FurnitureBox, Place, World, Zone
from btlang.robots.worlds.world_file import load_world
from btlang.robots.worlds.world_writing import to_toml
from btlang.text.source import Source
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
_walls = st.lists(st.tuples(_numbers, _numbers), min_size=2, max_size=2, unique=True).map(tuple)


@searches(15, 1000, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(walls=st.lists(_walls, min_size=1, max_size=3).map(tuple), resolution=st.sampled_from([0.05, 0.1, 0.13]))
def test_walls_come_back_within_two_cells(tmp_path: Path, walls: Any, resolution: float) -> None:
    pytest.importorskip("yaml")
    world = World(Pose(-5.0, -5.0), walls=walls)
    for name, content in nav2_files(world, resolution, 0.5).items():
        (tmp_path / name).write_bytes(content)
    imported = import_world([str(tmp_path / "map.yaml")], 0.2, world.start)
    assert imported.warnings == ()
    again = imported.world.replace(walls=imported.world.walls[1:])  # the first one is around the map
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


def made_map(seed: int) -> OccupancyMap:
    """A map as a robot makes it: thin slanted walls with gaps, clutter, noise, and floor that wasn't seen."""
    random = np.random.default_rng(seed)
    height, width = random.integers(150, 220, 2).tolist()
    occupied = np.zeros((height, width), dtype=bool)

    def draw(ax: float, ay: float, bx: float, by: float) -> None:
        steps = int(max(abs(bx - ax), abs(by - ay))) + 2
        occupied[np.linspace(ay, by, steps).astype(int), np.linspace(ax, bx, steps).astype(int)] = True

    corners = [(12, 9), (width - 14, 9 + seed % 5), (width - 10, height - 15), (10 + 2 * (seed % 9), height - 11)]
    for at in range(4):
        draw(*corners[at - 1], *corners[at])
    for _ in range(5):  # walls inside, at any angle
        (x, y), angle, length = random.integers(40, 110, 2), random.uniform(0, 6.3), random.uniform(10, 35)
        draw(x, y, x + length * np.cos(angle), y + length * np.sin(angle))
    gap = random.integers(30, height - 60)
    occupied[gap : gap + 4, width - 20 :] = False  # the scanner saw through a door
    occupied |= random.random(occupied.shape) < 0.001
    seen = np.zeros_like(occupied)
    seen[8 : height - 9, 10 : width - 3] = True
    return OccupancyMap(occupied, seen & ~occupied & (random.random(occupied.shape) > 0.002), 0.05,
                        Pose(*random.uniform(-9, 9, 2).round(3).tolist()))  # fmt: skip


def shades(found: OccupancyMap) -> bytes:
    cells = np.where(found.occupied, 0, np.where(found.free, 254, 205)).astype(np.uint8)
    return f"P5\n{cells.shape[1]} {cells.shape[0]}\n255\n".encode() + cells[::-1].tobytes()


@pytest.mark.parametrize("seed", range(20))
def test_the_free_cells_of_a_map_come_back(tmp_path: Path, seed: int) -> None:
    map = made_map(seed)
    start = map.position(60.5, 30.5)
    cell = map.free_near(start, 0.5)
    assert cell is not None
    x, y = map.origin.x, map.origin.y
    about = {"image": "map.pgm", "resolution": map.resolution, "origin": [x, y, 0.0]}
    (tmp_path / "map.pgm").write_bytes(shades(map))
    (tmp_path / "map.json").write_text(json.dumps({**about, "free_thresh": 0.196}))
    world = import_world([str(tmp_path / "map.json")], 0.2, Pose(*start)).world
    grid = CellGrid(world, map.resolution)
    again = nav2_files(world, map.resolution, 0.5)["map.pgm"]
    kept = np.frombuffer(again, np.uint8, offset=len(again) - grid.width * grid.height)
    free = kept.reshape(grid.height, grid.width)[::-1] == 254
    rows, columns = np.indices(map.free.shape)
    rows += round((map.origin.y - grid.origin[1]) / map.resolution)
    columns += round((map.origin.x - grid.origin[0]) / map.resolution)
    inside = (rows >= 0) & (rows < grid.height) & (columns >= 0) & (columns < grid.width)
    back = np.zeros_like(map.free)
    back[inside] = free[rows[inside], columns[inside]]
    assert (back == reached(map.free, [cell])).mean() >= 0.99
    assert load_world(Source(to_toml(world), "world.toml"), bounded=True)  # nothing is outside the outer walls
