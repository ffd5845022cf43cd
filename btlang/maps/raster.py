"""Worlds as cells: what Nav2 and other programs for grids take."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil

import numpy as np

from btlang.maps.images import MOST_CELLS
from btlang.robots.geometry import Point, Segment
from btlang.robots.worlds.world import World

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

    Cells = npt.NDArray[np.bool_]

_MARGIN = 10.5  # cells around everything; the half puts walls at round coordinates in the middle of cells


class GridTooLarge(ValueError):
    """A world that has too many cells."""


class Grid:
    """Cells with sides of `resolution` metres that cover a world; the first one is in the south-west at `origin`."""

    def __init__(self, world: World, resolution: float) -> None:
        """Raises GridTooLarge."""
        points = [segment[at : at + 2] for segment in world.segments() for at in (0, 2)]
        points += [door_end for door in world.doors for door_end in (door.start, door.end)]
        points += [point for zone in world.zones for point in zone.points]
        points += [(place.x, place.y) for place in world.places] + [(world.start.x, world.start.y)]
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        self.resolution = resolution
        start = np.floor(low / resolution) * resolution - _MARGIN * resolution
        self.origin: Point = (round(float(start[0]), 6), round(float(start[1]), 6))
        self.width, self.height = (ceil(float(cells)) for cells in (high - start) / resolution + _MARGIN)
        if self.width * self.height > MOST_CELLS:
            message = f"{self.width:,} x {self.height:,} cells are too many; use a larger --resolution"
            raise GridTooLarge(message)

    def empty(self) -> Cells:
        """No cell, a row from the south for each first index."""
        return np.zeros((self.height, self.width), dtype=bool)

    def cell(self, point: Point) -> tuple[int, int]:
        """The column and the row of a point."""
        return tuple(int((point[axis] - self.origin[axis]) / self.resolution) for axis in (0, 1))  # type: ignore[return-value]

    def draw(self, cells: Cells, segments: Iterable[Segment]) -> None:
        """Adds the cells that segments run through."""
        for ax, ay, bx, by in segments:
            steps = ceil(max(abs(bx - ax), abs(by - ay)) / self.resolution * 4) + 1
            columns = (np.linspace(ax, bx, steps) - self.origin[0]) / self.resolution
            rows = (np.linspace(ay, by, steps) - self.origin[1]) / self.resolution
            cells[rows.astype(int), columns.astype(int)] = True

    def fill(self, cells: Cells, polygon: Sequence[Point]) -> None:
        """Adds the cells of a polygon: those whose middle is inside, and those that its sides run through."""
        self.draw(cells, ((*polygon[at - 1], *polygon[at]) for at in range(len(polygon))))
        cells |= self.inside(polygon)

    def inside(self, polygon: Sequence[Point]) -> Cells:
        """The cells whose middle is in a polygon, by the even-odd rule."""
        found = self.empty()
        columns = self.origin[0] + (np.arange(self.width) + 0.5) * self.resolution
        rows = self.origin[1] + (np.arange(self.height) + 0.5) * self.resolution
        for at in range(len(polygon)):
            (ax, ay), (bx, by) = polygon[at - 1], polygon[at]
            crossed = np.nonzero((ay > rows) != (by > rows))[0]
            for row in crossed.tolist():
                found[row] ^= columns < ax + (rows[row] - ay) * (bx - ax) / (by - ay)
        return found


def walls_in(grid: Grid, world: World) -> Cells:
    """The cells of walls, furniture and closed doors."""
    cells = grid.empty()
    grid.draw(cells, world.wall_segments())
    grid.draw(cells, ((*door.start, *door.end) for door in world.doors if not door.open))
    for box in world.boxes:
        left, low = grid.cell((box.x - box.width / 2, box.y - box.height / 2))
        right, high = grid.cell((box.x + box.width / 2, box.y + box.height / 2))
        cells[low : high + 1, left : right + 1] = True
    return cells
