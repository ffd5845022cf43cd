"""Maps of ROS: images and their YAML files, and the walls that are made from them."""

from __future__ import annotations

import io
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.maps.occupancy import OccupancyMap, borders, read_map, simplify, walls_of
from btlang.maps.reach import reached
from btlang.robots.geometry import CENTRE, Point, Pose, contains, segment_distance
from btlang.text.toml_table import Problem
from tests.profiles import searches

ABOUT: dict[str, Any] = {
    "image": "map.pgm", "resolution": 0.05, "origin": [0, 0, 0], "occupied_thresh": 0.65, "free_thresh": 0.196,
}  # fmt: skip


def pgm(*rows: bytes) -> bytes:
    return f"P5\n# a comment\n{len(rows[0])} {len(rows)}\n255\n".encode() + b"".join(rows)


def read(folder: Path, image: bytes, name: str = "map.pgm", **about: Any) -> OccupancyMap:
    (folder / name).write_bytes(image)
    return read_map({**ABOUT, "image": name, **about}, str(folder))


ROW = bytes([0, 88, 90, 205, 254])


@pytest.mark.parametrize(
    ("about", "cells"),
    [
        ({}, "##??."),
        ({"occupied_thresh": 0.6}, "###?."),
        ({"free_thresh": 0.25}, "##?.."),  # as nav2_map_server reads the grey of unknown cells
        ({"negate": 1}, ".??##"),
        ({"negate": True}, ".??##"),
        ({"mode": "scale"}, "##..."),
        ({"mode": "raw"}, ".##??"),  # the grey is the percentage; above 100 it is unknown
    ],
    ids=str,
)
def test_modes(tmp_path: Path, about: dict[str, Any], cells: str) -> None:
    found = read(tmp_path, pgm(ROW), **about)
    pairs = zip(found.occupied[0], found.free[0], strict=True)
    assert "".join("#" if occupied else "." if free else "?" for occupied, free in pairs) == cells


def test_rows_begin_in_the_south(tmp_path: Path) -> None:
    found = read(tmp_path, pgm(bytes([0, 254]), bytes([254, 254]))).occupied
    assert found.astype(int).tolist() == [[0, 0], [1, 0]]


def test_forms_of_pgm(tmp_path: Path) -> None:
    wanted = [[True, False]]
    assert read(tmp_path, b"P2 2 1 255 # grey\n0 254\n").occupied.tolist() == wanted
    assert read(tmp_path, b"P5 2 1 65535\n" + bytes([0, 0, 255, 255])).occupied.tolist() == wanted
    assert read(tmp_path, b"P5\n2\n1\n1\n" + bytes([0, 1])).occupied.tolist() == wanted


@pytest.mark.parametrize("kind", ["PNG", "BMP"])
def test_other_images(tmp_path: Path, kind: str) -> None:
    image = pytest.importorskip("PIL.Image")
    out = io.BytesIO()
    image.fromarray(np.array([[0, 205, 254]], dtype=np.uint8)).save(out, kind)
    assert read(tmp_path, out.getvalue(), f"map.{kind.lower()}").occupied.tolist() == [[True, False, False]]


def test_what_is_transparent_in_a_scale_map_is_unknown(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    out = io.BytesIO()
    image.fromarray(np.array([[[0, 255], [0, 0]]], dtype=np.uint8)).save(out, "PNG")
    found = read(tmp_path, out.getvalue(), "map.png", mode="scale")
    assert (found.occupied.tolist(), found.free.tolist()) == ([[True, False]], [[False, False]])
    assert read(tmp_path, out.getvalue(), "map.png").occupied.tolist() == [[True, True]]


GOOD = pgm(ROW)


@pytest.mark.parametrize(
    ("image", "about", "message"),
    [
        (GOOD, {"resolution": "5 cm"}, "\"resolution\" must be a number, not '5 cm'"),
        (GOOD, {"resolution": 0}, '"resolution" must be from 0.001 to 1000, not 0'),
        (GOOD, {"resolution": float("nan")}, '"resolution" must be a number from'),
        (GOOD, {"origin": [0, 0]}, '"origin" must be a list of 3 numbers'),
        (GOOD, {"origin": [0, 0, "east"]}, "\"origin\" must be a number, not 'east'"),
        (GOOD, {"mode": "fancy"}, '"mode" must be trinary, scale or raw, not \'fancy\''),
        (GOOD, {"mode": ["raw"]}, '"mode" must be trinary, scale or raw, not a list'),
        (GOOD, {"negate": "no"}, '"negate" must be 0 or 1'),
        (GOOD, {"negate": []}, '"negate" must be 0 or 1'),
        (GOOD, {"occupied_thresh": 65}, '"occupied_thresh" must be from 0 to 1, not 65'),
        (b"", {}, "the image can't be read"),
        (b"P5 x", {}, "the image has no complete PGM header"),
        (b"P5 5 5 255\n1", {}, "the image ends before its 25 pixels"),
        (b"P2 2 1 255\n1 x", {}, "a pixel of the image isn't a number"),
        (b"P5 2 1 0\n11", {}, "its white must be from 1 to 65535"),
        (b"P5 999999 999999 255\n1", {}, "an image must have from 1 to 25,000,000 pixels, not 999,999 x 999,999"),
        (b"P5 0 5 255\n", {}, "an image must have from 1"),
    ],
)  # fmt: skip
def test_what_may_be_wrong(tmp_path: Path, image: bytes, about: dict[str, Any], message: str) -> None:
    pytest.importorskip("PIL")
    with pytest.raises(Problem) as caught:
        read(tmp_path, image, **about)
    assert message in str(caught.value)


def test_a_large_png_is_not_unpacked(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    out = io.BytesIO()
    image.new("1", (20_000, 2_000)).save(out, "PNG")
    with pytest.raises(Problem, match="pixels, not 20,000 x 2,000"):
        read(tmp_path, out.getvalue(), "map.png")


@pytest.mark.parametrize("name", ["../map.pgm", "/etc/passwd", "link.pgm", "no.pgm", "a\0b", "", 3])
def test_images_are_in_the_folder_of_the_map(tmp_path: Path, name: Any) -> None:
    folder = tmp_path / "maps"
    folder.mkdir()
    (tmp_path / "map.pgm").write_bytes(GOOD)
    (folder / "link.pgm").symlink_to(tmp_path / "map.pgm")
    with pytest.raises(Problem, match=r'must be in the folder of the map|there is no image|"image" must be'):
        read_map({**ABOUT, "image": name}, str(folder))


def drawn(*rows: str) -> Any:
    """Cells, the row in the north first."""
    return np.array([[cell == "#" for cell in row] for row in rows])[::-1]


def test_a_map_that_was_saved_elsewhere_has_its_image_beside_it(tmp_path: Path) -> None:
    (tmp_path / "lab.pgm").write_bytes(GOOD)
    assert read_map({**ABOUT, "image": "/home/somebody/maps/lab.pgm"}, str(tmp_path)).occupied.any()


def drawn_map(*rows: str, resolution: float = 1.0, origin: Pose = CENTRE) -> OccupancyMap:
    free = drawn(*(row.replace("#", "?").replace(".", "#") for row in rows))
    return OccupancyMap(drawn(*rows), free, resolution, origin)


def walls(found: OccupancyMap, start: Point, smallest: float = 0.0) -> tuple[tuple[Point, ...], ...]:
    return walls_of(found, reached(found.free, [found.cell(start)]), smallest)


def test_walls_are_in_metres_and_turned() -> None:
    found = drawn_map("#####", "#...#", "#...#", "#####", resolution=0.5, origin=Pose(1.0, 2.0, 90.0))
    [wall] = walls(found, found.position(1.5, 1.5))
    assert set(wall) == {(0.75, 2.25), (0.75, 4.25), (-0.75, 4.25), (-0.75, 2.25)}
    assert wall[0] == wall[-1]


def test_the_room_is_what_the_start_can_reach() -> None:
    """A thin wall with a gap has a closed outline, too, but it isn't around the room."""
    found = drawn_map("?????????", "?#######?", "?#.....#?", "?#..#...#", "?#......?", "?#######?")
    [outer, pillar] = sorted(walls(found, (3.5, 1.5)), key=len, reverse=True)
    assert contains(outer[:-1], (3.5, 1.5))
    assert {(1.5, 0.5), (1.5, 4.5)} <= set(outer)
    assert pillar == ((4.25, 2.5), (4.75, 2.5))


def test_floor_that_the_scanner_missed_is_floor() -> None:
    rows = ["##########", "#........#", "#..?.....#", "#......#?#", "#........#", "##########"]
    assert len(walls(drawn_map(*rows), (2.5, 1.5), smallest=1.0)) == 1
    assert len(walls(drawn_map(*rows), (2.5, 1.5))) == 2
    assert len(walls(drawn_map(*(row.replace("?.", "??") for row in rows)), (2.5, 1.5), smallest=1.0)) == 2


def test_a_map_ends_at_its_edge() -> None:
    [wall] = walls(drawn_map("...", "..."), (0.5, 0.5))
    assert contains(wall[:-1], (1.5, 1.0))
    assert not contains(wall[:-1], (4.0, 1.0))


def test_thin_walls_are_one_line_and_slanted_ones_few() -> None:
    def pieces(wall: Any) -> int:
        solid = np.pad(wall, 3)
        found = OccupancyMap(solid, ~solid, 1.0, Pose(0.0, 0.0))
        return sum(len(each) - 1 for each in walls(found, (0.5, 0.5))) - 4  # of the edge

    assert pieces(drawn("#" * 30)) == 1
    assert pieces(np.eye(40, dtype=bool)) == 1
    slope = np.zeros((30, 90), dtype=bool)
    for column in range(90):
        slope[column // 3, column] = True
    assert pieces(slope) == 1


def test_where_the_robot_has_room() -> None:
    room = drawn_map("." * 9, *["." * 9] * 8, resolution=0.1, origin=Pose(-0.7, -0.7))
    assert room.spot_with_room(0.25) == pytest.approx((-0.25, -0.25))
    assert room.spot_with_room(0.5) is None
    assert room.free_near((5.0, 5.0), 0.5) is None
    assert room.free_near((0.45, 0.04), 0.5) == (8, 7)


@searches(60, 3000)
@given(rows=st.lists(st.lists(st.booleans(), min_size=7, max_size=7), min_size=1, max_size=9))
def test_walls_run_near_all_cells_beside_free_ones(rows: list[list[bool]]) -> None:
    solid = np.pad(np.array(rows), 1, constant_values=True)
    free = np.pad(~solid, 1)
    beside = solid & (free[:-2, 1:-1] | free[2:, 1:-1] | free[1:-1, :-2] | free[1:-1, 2:])
    paths = borders(solid)
    assert {tuple(cell) for path in paths for cell in path.tolist()} == {(x, y) for y, x in np.argwhere(beside)}
    for path in paths:
        corners = simplify(path).tolist() if len(path) > 1 else [*path.tolist()] * 2
        assert {*map(tuple, corners)} <= {*map(tuple, path.tolist())}
        for x, y in path.tolist():
            assert min(segment_distance((x, y), (*a, *b)) for a, b in pairwise(corners)) <= 0.7 + 1e-9


@searches(40, 3000)
@given(rows=st.lists(st.lists(st.booleans(), min_size=6, max_size=6), min_size=1, max_size=7), seed=st.integers(0, 41))
def test_what_is_reached_is_joined_to_the_seed_and_all_of_it(rows: list[list[bool]], seed: int) -> None:
    free = np.array(rows)
    start = (seed % 6, min(seed // 6, len(rows) - 1))
    wanted, left = set[tuple[int, int]](), [start]
    while left:
        column, row = left.pop()
        if (column, row) not in wanted and 0 <= row < len(rows) and 0 <= column < 6 and rows[row][column]:
            wanted.add((column, row))
            left += [(column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)]
    assert {(x, y) for y, x in np.argwhere(reached(free, [start, (-1, 9)]))} == wanted
