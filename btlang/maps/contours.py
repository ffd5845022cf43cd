"""Occupied cells of a map to walls: their outlines, in few straight pieces."""

from __future__ import annotations

from math import cos, radians, sin

import numpy as np

from btlang.maps.occupancy import OccupancyMap
from btlang.robots.geometry import Point
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

    Corners = npt.NDArray[np.int64]

_MOST_SIDES = 2_000_000  # of cells, on outlines; following so many takes seconds
_NEAR = 1.0  # cells; walls are this near to the outlines
_RIGHT, _AHEAD, _LEFT = 3, 0, 1  # quarters of a turn to the left


def walls_of(occupancy: OccupancyMap) -> tuple[tuple[Point, ...], ...]:
    """The walls around the occupied cells, at most one cell from their outlines. Raises Problem for too many."""
    return tuple(
        tuple(_metres(corner, occupancy) for corner in simplified(loop).tolist())
        for loop in outlines(occupancy.occupied)
    )


def _metres(corner: list[int], occupancy: OccupancyMap) -> Point:
    origin, size = occupancy.origin, occupancy.resolution
    c, s = cos(radians(origin.heading)) * size, sin(radians(origin.heading)) * size
    column, row = corner
    return round(origin.x + column * c - row * s, 4), round(origin.y + column * s + row * c, 4)


def outlines(occupied: npt.NDArray[np.bool_]) -> list[Corners]:
    """The closed outlines of what is occupied, as the corners (column, row) where they turn.

    They go around occupied cells counter-clockwise; cells that touch at a corner are one thing. Raises Problem.
    """
    sides = _sides(occupied)
    left = set(sides)
    across = occupied.shape[1] + 1
    steps = (1, across, -1, -across)
    found: list[Corners] = []
    for first in sides:
        if first not in left:
            continue
        loop: list[int] = []
        at = -1
        corner, way = first // 4 + steps[first % 4], first % 4
        while at != first:
            turn = next(turn for turn in (_RIGHT, _AHEAD, _LEFT) if corner * 4 + (way + turn) % 4 in left)
            way = (way + turn) % 4
            at = corner * 4 + way
            left.remove(at)
            if turn:
                loop.append(corner)
            corner += steps[way]
        found.append(np.stack(np.divmod(np.array(loop, dtype=np.int64), across)[::-1], axis=1))
    return found


def _sides(occupied: npt.NDArray[np.bool_]) -> list[int]:
    """The sides between occupied cells and others, each as four times its first corner plus its direction.

    Directions count from east in quarters of a turn; the occupied cell is on the left.
    """
    padded = np.pad(occupied, 1)
    inner, across = padded[1:-1, 1:-1], occupied.shape[1] + 1
    others = (padded[:-2, 1:-1], padded[1:-1, 2:], padded[2:, 1:-1], padded[1:-1, :-2])  # south, east, north, west
    corners = (0, 1, across + 1, across)
    parts = []
    for way, (other, corner) in enumerate(zip(others, corners, strict=True)):
        rows, columns = np.nonzero(inner & ~other)
        parts.append((rows * across + columns + corner) * 4 + way)
    sides = np.sort(np.concatenate(parts))
    if len(sides) > _MOST_SIDES:
        raise Problem(f"the map has too much detail: {len(sides):,} sides of occupied cells, at most {_MOST_SIDES:,}")
    found: list[int] = sides.tolist()
    return found


def simplified(loop: Corners) -> Corners:
    """A closed outline in few pieces (Ramer-Douglas-Peucker), each corner at most one cell from them.

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
    """Of points from the piece between two."""
    along = (end - start).astype(np.float64)
    length = float(along @ along)
    if not length:
        return np.asarray(np.hypot(*(points - start).T))
    share = np.clip((points - start) @ along / length, 0.0, 1.0)
    gaps = points - start - share[:, None] * along
    return np.asarray(np.hypot(gaps[:, 0], gaps[:, 1]))
