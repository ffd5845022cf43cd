"""Grids of distances to walls, furniture and borders of zones, in which ways are planned."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, hypot, sqrt

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import Point, Segment, edges
from btlang.robots.robot import RobotError
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import World

Array = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

_MARGIN = 1.0
_MOST_AREA = 40_000  # square metres: the grid of a planner takes 250 MB


class ClearanceGrid:
    """Square cells of `size` metres. Raises RobotError if the world is too large.

    `xs` and `ys` are their centres, a row of the arrays has one y. `directions` lead from a cell to its neighbours, in
    rows and columns, and so do `steps`: what to add to its number, and the length in cells.
    """

    def __init__(self, world: World, size: float) -> None:
        points = [(x, y) for ax, ay, bx, by in world.segments() for x, y in ((ax, ay), (bx, by))]
        points += [(world.start.x, world.start.y), *((place.x, place.y) for place in world.places)]
        points += [(thing.x, thing.y) for thing in (*world.objects, *world.people)]
        points += [(stop.x, stop.y) for person in world.people for stop in person.walks]
        low_x, high_x = min(p[0] for p in points) - _MARGIN, max(p[0] for p in points) + _MARGIN
        low_y, high_y = min(p[1] for p in points) - _MARGIN, max(p[1] for p in points) + _MARGIN
        if (high_x - low_x) * (high_y - low_y) > _MOST_AREA:
            extent = f"{high_x - low_x:.0f} m by {high_y - low_y:.0f} m"
            most = f"at most {_MOST_AREA:,} square metres are possible"
            raise RobotError(f"the world is too large to plan a way: {extent}, and {most}")
        self.size, self.origin = size, (low_x, low_y)
        self.columns, self.rows = ceil((high_x - low_x) / size), ceil((high_y - low_y) / size)
        self.directions = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1) if row or column]
        self.steps = [(row * self.columns + column, sqrt(abs(row) + abs(column))) for row, column in self.directions]
        self.xs, self.ys = np.meshgrid(
            low_x + size * (np.arange(self.columns) + 0.5), low_y + size * (np.arange(self.rows) + 0.5)
        )

    def clearance(self, obstacles: Obstacles, within: float) -> Array:
        """Return the metres from each cell to the nearest wall, closed door or box, 0 inside a box.

        A cell that is farther than `within` from all of them may have any greater number.
        """
        nearest2 = np.full(self.xs.shape, np.inf)
        for segment in obstacles.segments:  # maps have thousands, so only the cells around each are looked at
            window = self.window(segment, within)
            nearest2[window] = np.minimum(nearest2[window], self._squared(segment, window))
        for box in obstacles.boxes:
            inside = (np.abs(self.xs - box.x) <= box.width / 2) & (np.abs(self.ys - box.y) <= box.height / 2)
            nearest2[inside] = 0.0
        clearance: Array = np.sqrt(nearest2)
        return clearance

    def to_polygon(self, points: Sequence[Point]) -> Array:
        """Return the metres from each cell to a polygon, 0 inside."""
        distances = self._to_border(points)
        distances[self._inside(points)] = 0.0
        return distances

    def depth(self, points: Sequence[Point]) -> Array:
        """Return the metres from each cell in a polygon to its border, 0 outside."""
        distances = self._to_border(points)
        distances[~self._inside(points)] = 0.0
        return distances

    def _to_border(self, points: Sequence[Point]) -> Array:
        nearest2 = np.full(self.xs.shape, np.inf)
        for start, end in edges(points):
            nearest2 = np.minimum(nearest2, self._squared((*start, *end)))
        distances: Array = np.sqrt(nearest2)
        return distances

    def cell_of(self, point: Point) -> int:
        """Return the cell of a point; the nearest one for a point outside the grid."""
        column = int((point[0] - self.origin[0]) / self.size)
        row = int((point[1] - self.origin[1]) / self.size)
        return min(max(row, 0), self.rows - 1) * self.columns + min(max(column, 0), self.columns - 1)

    def centre(self, cell: int) -> Point:
        """Return the centre of a cell."""
        row, column = divmod(cell, self.columns)
        return self.origin[0] + self.size * (column + 0.5), self.origin[1] + self.size * (row + 0.5)

    def nearest_free(self, point: Point, blocked: Bools, within: float) -> int | None:
        """Return the cell nearest to a point that isn't blocked, None if there is none within so many metres."""
        distances = np.hypot(self.xs - point[0], self.ys - point[1]).ravel()
        distances[blocked] = np.inf
        cell = int(distances.argmin())
        return cell if distances[cell] <= within else None

    def is_clear(self, clearance: Array, a: Point, b: Point, room: float) -> bool:
        """Return whether all cells on a straight line have so many metres of room."""
        return bool((clearance[self.line(a, b)] >= room).all())

    def line(self, a: Point, b: Point) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Return the rows and the columns of cells on a straight line."""
        count = ceil(hypot(b[0] - a[0], b[1] - a[1]) / (self.size / 2)) + 1
        columns = (np.linspace(a[0], b[0], count) - self.origin[0]) / self.size
        rows = (np.linspace(a[1], b[1], count) - self.origin[1]) / self.size
        return rows.astype(int), columns.astype(int)

    def beside(self, segment: Segment, within: float) -> tuple[tuple[slice, slice], Bools]:
        """Return a window of the grid, and which of its cells are that near to a segment."""
        window = self.window(segment, within)
        return window, self._squared(segment, window) < within**2

    def window(self, segment: Segment, within: float) -> tuple[slice, slice]:
        """Return the rows and the columns of the cells that may be so near to a segment."""
        ax, ay, bx, by = segment
        spans = zip((min(ay, by), min(ax, bx)), (max(ay, by), max(ax, bx)), self.origin[::-1], strict=True)
        rows, columns = (
            slice(max(int((low - within - start) / self.size), 0), max(int((high + within - start) / self.size) + 1, 0))
            for low, high, start in spans
        )
        return rows, columns

    def _squared(self, segment: Segment, window: tuple[slice, slice] = (slice(None), slice(None))) -> Array:
        """Return the squared metres from each cell, in a window, to a segment."""
        ax, ay, bx, by = segment
        dx, dy = bx - ax, by - ay
        xs, ys = self.xs[window], self.ys[window]
        t = np.clip(((xs - ax) * dx + (ys - ay) * dy) / max(dx**2 + dy**2, 1e-12), 0.0, 1.0)
        squared: Array = (xs - ax - t * dx) ** 2 + (ys - ay - t * dy) ** 2
        return squared

    def _inside(self, points: Sequence[Point]) -> Bools:
        inside = np.zeros(self.xs.shape, dtype=bool)
        for (ax, ay), (bx, by) in edges(points):
            if ay != by:
                crosses = ((ay > self.ys) != (by > self.ys)) & (self.xs < ax + (self.ys - ay) * (bx - ax) / (by - ay))
                inside ^= crosses
        return inside
