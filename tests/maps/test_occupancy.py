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

from btlang.maps.occupancy import OccupancyMap, outlines, read_map, simplify, walls_of
from btlang.robots.geometry import Pose, segment_distance
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
    ("about", "occupied"),
    [
        ({}, [1, 1, 0, 0, 0]),
        ({"occupied_thresh": 0.6}, [1, 1, 1, 0, 0]),
        ({"negate": 1}, [0, 0, 0, 1, 1]),
        ({"negate": True}, [0, 0, 0, 1, 1]),
        ({"mode": "scale"}, [1, 1, 0, 0, 0]),
        ({"mode": "raw"}, [0, 1, 1, 0, 0]),  # the grey is the percentage; above 100 it is unknown
    ],
    ids=str,
)
def test_modes(tmp_path: Path, about: dict[str, Any], occupied: list[int]) -> None:
    assert read(tmp_path, pgm(ROW), **about).occupied.astype(int).tolist() == [occupied]


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
    assert read(tmp_path, out.getvalue(), "map.png", mode="scale").occupied.tolist() == [[True, False]]
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


def test_walls_are_in_metres_and_turned() -> None:
    cells = drawn("####", "####", "####")
    [wall] = walls_of(OccupancyMap(cells, 0.5, Pose(1.0, 2.0, 90.0)))
    assert sorted(set(wall)) == [(-0.5, 2.0), (-0.5, 4.0), (1.0, 2.0), (1.0, 4.0)]
    assert wall[0] == wall[-1]


def test_rooms_have_an_outer_and_an_inner_outline() -> None:
    cells = drawn("######", "#....#", "#....#", "#....#", "######")
    assert [len(loop) for loop in outlines(cells)] == [4, 4]
    assert [len(wall) for wall in walls_of(OccupancyMap(cells, 0.05, Pose(0.0, 0.0)))] == [5, 5]


def test_thin_walls_are_one_line_and_slanted_ones_few() -> None:
    def pieces(cells: Any) -> int:
        return sum(len(wall) - 1 for wall in walls_of(OccupancyMap(cells, 0.05, Pose(0.0, 0.0))))

    assert pieces(drawn("#" * 30)) == 1
    assert pieces(np.eye(40, dtype=bool)) == 1
    slope = np.zeros((30, 90), dtype=bool)
    for column in range(90):
        slope[column // 3, column] = True
    assert pieces(slope) == 1


def test_nothing_occupied_is_no_wall() -> None:
    assert walls_of(OccupancyMap(np.zeros((5, 5), dtype=bool), 0.05, Pose(0.0, 0.0))) == ()


@searches(60, 3000)
@given(rows=st.lists(st.lists(st.booleans(), min_size=7, max_size=7), min_size=1, max_size=9))
def test_walls_are_within_a_cell_of_the_outlines(rows: list[list[bool]]) -> None:
    cells = np.array(rows)
    walls = walls_of(OccupancyMap(cells, 1.0, Pose(0.0, 0.0)))
    pieces = [(*a, *b) for wall in walls for a, b in pairwise(wall)]
    loops = outlines(cells)
    assert sum(len(loop) for loop in loops) >= len(pieces)
    for loop in loops:
        for corner in loop.tolist():
            assert min(segment_distance((corner[0], corner[1]), piece) for piece in pieces) <= 1.0 + 1e-9
        assert {tuple(corner) for corner in simplify(loop).tolist()} <= {tuple(corner) for corner in loop.tolist()}
    area = sum(
        (a[0] * b[1] - b[0] * a[1]) / 2
        for loop in loops
        for a, b in zip(loop.tolist(), [*loop.tolist()[1:], loop.tolist()[0]], strict=True)
    )
    assert area == cells.sum()  # outlines leave nothing out
