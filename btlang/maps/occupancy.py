"""Maps of ROS: a YAML file and its image become occupied cells, and these become walls."""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Mapping
from math import ceil, cos, floor, radians, sin

import numpy as np

from btlang.diagnostics.files import is_below, os_error_reason, real_path
from btlang.maps.data_text import missing_package, number, numbers, shown
from btlang.robots.geometry import Point, Pose
from btlang.support.record import Record
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    import numpy.typing as npt

    Corners = npt.NDArray[np.int64]
    Cells = npt.NDArray[np.bool_]

MOST_CELLS = 25_000_000
"""The most cells of a map."""
_MOST_IN_TEXT = 4_000_000  # pixels; each is an object while it is read
_MOST_BYTES = 60_000_000
_GAP = rb"(?:\s|#[^\n]*\n)+"
_PGM = re.compile(rb"P([25])" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,5})(?:#[^\n]*\n|\s)")
_MODES = ("trinary", "scale", "raw")
_MOST_SIDES = 2_000_000  # of cells, on outlines; following so many takes seconds
_NEAR = 0.7  # cells; walls are this near to the middle of the cells beside free ones (a line of slope 1/3 is one wall)
_DOT = 0.25  # cells; half the length of the wall that a single cell becomes
_FREE_BELOW = 0.25  # where a file has no free_thresh, as in nav2_map_server
_RIGHT, _AHEAD, _LEFT = 3, 0, 1  # quarters of a turn to the left


class MapImage(Record):
    """Brightness from 0 (black) to 1, a row from the top for each first index; `alpha` (1 is opaque) None for none."""

    shades: npt.NDArray[np.float32]
    alpha: npt.NDArray[np.float32] | None = None


def read_image(path: str) -> MapImage:
    """Read a PGM, PNG or BMP file. Raises Problem, OSError, and MissionError (BT087) if it needs Pillow."""
    with open(path, "rb") as file:
        data = file.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise Problem(f"the image may have at most {_MOST_BYTES:,} bytes")
    return _read_pgm(data) if data[:2] in (b"P2", b"P5") else _read_other(data)


def _read_pgm(data: bytes) -> MapImage:
    header = _PGM.match(data)
    if header is None:
        raise Problem("the image has no complete PGM header")
    width, height, white = int(header[2]), int(header[3]), int(header[4])
    _check_size(width, height)
    if not 0 < white < 65_536:
        raise Problem("the image has a wrong PGM header: its white must be from 1 to 65535")
    count, body = width * height, data[header.end() :]
    if header[1] == b"5":
        wide = np.dtype(">u2") if white > 255 else np.dtype(np.uint8)
        if len(body) < count * wide.itemsize:
            raise Problem(f"the image ends before its {count:,} pixels")
        pixels = np.frombuffer(body, wide, count).astype(np.float32)
    else:
        if count > _MOST_IN_TEXT:
            raise Problem(f"an image whose pixels are text may have at most {_MOST_IN_TEXT:,} pixels, not {count:,}")
        words = re.sub(rb"#[^\n]*", b"", body).split(None, count)[:count]
        if len(words) < count:
            raise Problem(f"the image ends before its {count:,} pixels")
        if not all(word.isdigit() and len(word) < 6 for word in words):
            raise Problem("a pixel of the image isn't a number")
        pixels = np.array(words, dtype=np.float32)
    return MapImage(np.minimum(pixels / np.float32(white), 1.0).reshape(height, width))


def _read_other(data: bytes) -> MapImage:
    try:
        from PIL import Image
    except ImportError:
        raise missing_package("images that aren't PGM", "Pillow") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a large image; it is looked at here
            with Image.open(io.BytesIO(data), formats=("PNG", "BMP", "PPM")) as image:
                _check_size(*image.size)
                if image.mode.startswith(("I", "F")):  # 16 bits a pixel, which Pillow would cut off
                    return MapImage(np.minimum(np.asarray(image, dtype=np.float32) / 65_535, 1.0))
                has_alpha = image.has_transparency_data
                pixels = np.asarray(image.convert("RGBA"), dtype=np.uint8)
    except Problem:
        raise
    except Exception as error:  # what a decoder raises for a broken file is not one class
        raise Problem(
            f"the image can't be read: {str(error).splitlines()[0] if str(error) else 'it is broken'}"
        ) from None
    shades = pixels[:, :, :3].mean(axis=2, dtype=np.float32) / np.float32(255)
    return MapImage(shades, pixels[:, :, 3].astype(np.float32) / np.float32(255) if has_alpha else None)


def _check_size(width: int, height: int) -> None:
    if width < 1 or height < 1 or width * height > MOST_CELLS:
        raise Problem(f"an image must have from 1 to {MOST_CELLS:,} pixels, not {width:,} x {height:,}")


class OccupancyMap(Record):
    """The occupied and the free cells of a map, a row from the south for each first index; the others are unknown.

    A cell has sides of `resolution` metres; `origin` is the corner of the first cell and the direction of its row.
    """

    occupied: Cells
    free: Cells
    resolution: float
    origin: Pose

    def position(self, column: float, row: float) -> Point:
        """Return the point, in metres, so many cells from the corner of the first cell."""
        x, y = self.origin.ahead(column * self.resolution, row * self.resolution)
        return round(x, 4), round(y, 4)

    def cell(self, point: Point) -> tuple[int, int]:
        """Return the column and the row of the cell of a point, which may be outside the map."""
        dx, dy = point[0] - self.origin.x, point[1] - self.origin.y
        c, s = cos(radians(self.origin.heading)), sin(radians(self.origin.heading))
        return floor((dx * c + dy * s) / self.resolution), floor((dy * c - dx * s) / self.resolution)

    def free_near(self, point: Point, within: float) -> tuple[int, int] | None:
        """Return the free cell nearest to a point, at most so many metres away; None if there isn't any."""
        column, row = self.cell(point)
        reach = ceil(within / self.resolution)
        west, south = max(column - reach, 0), max(row - reach, 0)
        rows, columns = np.nonzero(self.free[south : max(row + reach + 1, 0), west : max(column + reach + 1, 0)])
        if not len(rows):
            return None
        distances = np.hypot(rows + south - row, columns + west - column)
        nearest = int(np.argmin(distances))
        return (int(columns[nearest]) + west, int(rows[nearest]) + south) if distances[nearest] <= reach else None

    def spot_with_room(self, room: float) -> Point | None:
        """Return the point nearest to the origin of the world, where maps mostly begin, with a square of free cells at
        least so many metres to each side; None if there isn't any.
        """
        reach = ceil(room / self.resolution) + 1
        side = 2 * reach + 1
        if min(self.free.shape) < side:
            return None
        sums = np.pad(np.cumsum(np.cumsum(self.free, axis=0, dtype=np.int64), axis=1), ((1, 0), (1, 0)))
        counts = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
        rows, columns = np.nonzero(counts == side * side)
        if not len(rows):
            return None
        column, row = self.cell((0.0, 0.0))
        nearest = int(np.argmin(np.hypot(columns + reach - column, rows + reach - row)))
        return self.position(float(columns[nearest]) + reach + 0.5, float(rows[nearest]) + reach + 0.5)


def is_map(data: object) -> bool:
    """Return whether the data of a file are a map."""
    return isinstance(data, Mapping) and "image" in data and "resolution" in data


def read_map(data: Mapping[str, Any], folder: str) -> OccupancyMap:
    """Return a map whose image is in the folder of its YAML file.

    Cells are interpreted as nav2_map_server does it; in "raw" images a cell is occupied as in "scale": above
    `occupied_thresh`. What isn't occupied in "scale" and "raw" is free, unless it is unknown. Raises Problem, and
    MissionError (BT087).
    """
    resolution = number(data["resolution"], '"resolution"', 0.001, 1000.0)
    x, y, angle = numbers(data.get("origin", [0.0, 0.0, 0.0]), '"origin"', 3)
    occupied_above = number(data.get("occupied_thresh", 0.65), '"occupied_thresh"', 0.0, 1.0)
    free_below = number(data.get("free_thresh", _FREE_BELOW), '"free_thresh"', 0.0, 1.0)
    mode = data.get("mode", _MODES[0])
    if mode not in _MODES:
        raise Problem(f'"mode" must be trinary, scale or raw, not {shown(mode)}')
    negate = data.get("negate", 0)
    if negate not in (0, 1):
        raise Problem(f'"negate" must be 0 or 1, not {shown(negate)}')
    image = _image(data["image"], folder)
    occupied, free = _classify(image, str(mode), bool(negate), occupied_above, free_below)
    return OccupancyMap(occupied[::-1], free[::-1], resolution, Pose(x, y, float(np.degrees(angle))))


def _image(name: Any, folder: str) -> MapImage:
    if not isinstance(name, str) or not name:
        raise Problem(f'"image" must be the name of a file, not {shown(name)}')
    path = real_path(os.path.join(folder, name))
    beside = real_path(os.path.join(folder, os.path.basename(name)))
    if os.path.isabs(name) and is_below(beside, folder) and os.path.isfile(beside):  # saved on another computer
        path = beside
    if not is_below(path, folder):
        raise Problem(f"the image {shown(name)} must be in the folder of the map, or below it; move it there")
    if not os.path.isfile(path):
        raise Problem(f"there is no image {shown(name)}")
    try:
        return read_image(path)
    except OSError as error:
        raise Problem(f"I can't read the image {shown(name)}: {os_error_reason(error)}") from None


def _classify(image: MapImage, mode: str, negate: bool, above: float, below: float) -> tuple[Cells, Cells]:
    """Return which pixels are occupied, and which are free."""
    shades, alpha = image.shades, image.alpha
    if mode == "raw":
        percent = np.rint(shades * 255)
        known, occupied = percent <= 100, percent > above * 100
        return known & occupied, known & ~occupied
    if mode == "trinary" and alpha is not None:
        shades = (shades * np.float32(3) + alpha) / np.float32(4)  # as nav2_map_server does it
    darkness = shades if negate else 1 - shades
    occupied = darkness > above
    if mode == "trinary":
        return occupied, ~occupied & (darkness < below)
    known = alpha == 1 if alpha is not None else np.ones_like(occupied)
    return known & occupied, known & ~occupied


def walls_of(occupancy: OccupancyMap, free: Cells, smallest: float) -> tuple[tuple[Point, ...], ...]:
    """Return the walls around these free cells: lines through the middle of the cells beside them.

    Unknown cells are walls, too, but for holes of less than `smallest` metres with nothing occupied around them: floor
    that a scanner has missed. Raises Problem for too many.
    """
    solid = np.pad(~free, 1, constant_values=True)
    occupied = np.pad(occupancy.occupied, 1)
    walls = []
    for path in borders(solid):
        size = float(np.hypot(*np.ptp(path, axis=0))) * occupancy.resolution
        if size >= smallest or occupied[path[:, 1], path[:, 0]].any():
            corners = (
                simplify(_square(path, solid)).tolist() if len(path) > 1 else [path[0] - (_DOT, 0), path[0] + (_DOT, 0)]
            )
            walls.append(tuple(occupancy.position(column - 0.5, row - 0.5) for column, row in corners))
    return tuple(walls)


def borders(solid: Cells) -> list[Corners]:
    """Return the closed paths of solid cells (column, row) along other cells; those at the edge must be solid.

    On each path the other cells are on the right. Cells that touch at a corner are one thing. Raises Problem.
    """
    sides = _sides(solid)
    left = set(sides)
    across = solid.shape[1] + 1
    steps = (1, across, -1, -across)
    inward = (0, -1, -1 - across, -across)  # from the first corner of a side to the number of its solid cell
    found: list[Corners] = []
    for first in sides:
        if first not in left:
            continue
        path: list[int] = []
        at = -1
        corner, way = first // 4 + steps[first % 4], first % 4
        while at != first:
            turn = next(turn for turn in (_RIGHT, _AHEAD, _LEFT) if corner * 4 + (way + turn) % 4 in left)
            way = (way + turn) % 4
            at = corner * 4 + way
            left.remove(at)
            cell = corner + inward[way]
            if not path or path[-1] != cell:
                path.append(cell)
            corner += steps[way]
        if len(path) > 1 and path[0] == path[-1]:
            path.pop()
        found.append(np.stack(np.divmod(np.array(path, dtype=np.int64), across)[::-1], axis=1))
    return found


def _sides(solid: Cells) -> list[int]:
    """Return the sides between solid cells and others, each as four times its first corner plus its direction.

    Directions count from east in quarters of a turn; the solid cell is on the left.
    """
    padded = np.pad(solid, 1, mode="edge")
    inner, across = solid, solid.shape[1] + 1
    others = (padded[:-2, 1:-1], padded[1:-1, 2:], padded[2:, 1:-1], padded[1:-1, :-2])  # south, east, north, west
    corners = (0, 1, across + 1, across)
    parts = []
    for way, (other, corner) in enumerate(zip(others, corners, strict=True)):
        rows, columns = np.nonzero(inner & ~other)
        parts.append((rows * across + columns + corner) * 4 + way)
    sides = np.sort(np.concatenate(parts))
    if len(sides) > _MOST_SIDES:
        raise Problem(f"the map has too much detail: {len(sides):,} sides of walls, at most {_MOST_SIDES:,}")
    found: list[int] = sides.tolist()
    return found


def _square(path: Corners, solid: Cells) -> Corners:
    """Return a path with the cells in the corners of rooms, where two straight pieces of it meet."""
    steps = np.roll(path, -1, axis=0) - path
    before, after = np.roll(steps, 1, axis=0), np.roll(steps, -1, axis=0)
    is_straight = (np.abs(before).sum(axis=1) == 1) & (np.abs(after).sum(axis=1) == 1)
    meet = is_straight & (np.abs(steps).sum(axis=1) == 2) & (steps == before + after).all(axis=1)
    corners = (path + before)[meet]
    places = np.nonzero(meet)[0] + 1
    kept = solid[corners[:, 1], corners[:, 0]]
    return np.insert(path, places[kept], corners[kept], axis=0)


def simplify(loop: Corners) -> Corners:
    """Return a closed path in few pieces (Ramer-Douglas-Peucker), each point at most 0.7 cells from them.

    It ends where it begins; what is as thin as a cell becomes one line.
    """
    first = int(np.lexsort((loop[:, 1], loop[:, 0]))[0])
    loop = np.concatenate([loop[first:], loop[: first + 1]])
    far = int(np.argmax(((loop - loop[0]) ** 2).sum(axis=1)))
    kept = {0, far, len(loop) - 1}
    pieces = [(0, far), (far, len(loop) - 1)]
    while pieces:
        start, end = pieces.pop()
        if end - start < 2:
            continue
        distances = _distances(loop[start + 1 : end], loop[start], loop[end])
        worst = int(np.argmax(distances))
        if distances[worst] > _NEAR:
            middle = start + 1 + worst
            kept.add(middle)
            pieces += [(start, middle), (middle, end)]
    return loop[sorted(kept)] if len(kept) > 3 else loop[[0, far]]


def _distances(points: Corners, start: Corners, end: Corners) -> npt.NDArray[np.float64]:
    """Return the distances of points from the piece between two of them."""
    along = (end - start).astype(np.float64)
    length = float(along @ along)
    if not length:
        return np.asarray(np.hypot(*(points - start).T))
    share = np.clip((points - start) @ along / length, 0.0, 1.0)
    gaps = points - start - share[:, None] * along
    return np.asarray(np.hypot(gaps[:, 0], gaps[:, 1]))
