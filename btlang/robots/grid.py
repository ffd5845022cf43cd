"""A grid over a world whose cells know how far the nearest wall or piece of furniture is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, hypot, sqrt

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import Point, edges
from btlang.robots.obstacles import Obstacles
from btlang.robots.robot import RobotError
from btlang.robots.world import World

Array = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

_MARGIN = 1.0
_MOST_AREA = 40_000  # square metres: the grid of a planner takes 250 MB


class Grid:
    """Square cells of `size` metres. `xs` and `ys` are their centres, a row of the arrays has one y. `steps` lead from
    a cell to its neighbours: what to add to its number, and the length in cells.

    Raises RobotError where the world is too large.
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
        self.steps = [(row * self.columns + column, sqrt(abs(row) + abs(column)))
                      for row in (-1, 0, 1) for column in (-1, 0, 1) if row or column]  # fmt: skip
        self.xs, self.ys = np.meshgrid(
            low_x + size * (np.arange(self.columns) + 0.5), low_y + size * (np.arange(self.rows) + 0.5)
        )

    def clearance(self, obstacles: Obstacles) -> Array:
        """Metres from each cell to the nearest wall, closed door or box, 0 inside a box."""
        nearest2 = np.full(self.xs.shape, np.inf)
        for segment in obstacles.segments:
            nearest2 = np.minimum(nearest2, self._squared(segment))
        for box in obstacles.boxes:
            inside = (np.abs(self.xs - box.x) <= box.width / 2) & (np.abs(self.ys - box.y) <= box.height / 2)
            nearest2[inside] = 0.0
        clearance: Array = np.sqrt(nearest2)
        return clearance

    def to_polygon(self, points: Sequence[Point]) -> Array:
        """Metres from each cell to a polygon, 0 inside."""
        distances = self._to_border(points)
        distances[self._inside(points)] = 0.0
        return distances

    def depth(self, points: Sequence[Point]) -> Array:
        """Metres from each cell in a polygon to its border, 0 outside."""
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
        """The cell in which a point lies; of one outside the grid the nearest."""
        column = int((point[0] - self.origin[0]) / self.size)
        row = int((point[1] - self.origin[1]) / self.size)
        return min(max(row, 0), self.rows - 1) * self.columns + min(max(column, 0), self.columns - 1)

    def centre(self, cell: int) -> Point:
        """Of a cell."""
        row, column = divmod(cell, self.columns)
        return self.origin[0] + self.size * (column + 0.5), self.origin[1] + self.size * (row + 0.5)

    def nearest_free(self, point: Point, blocked: Bools, within: float) -> int | None:
        """The cell nearest to a point that isn't blocked, None where none is within so many metres."""
        distances = np.hypot(self.xs - point[0], self.ys - point[1]).ravel()
        distances[blocked] = np.inf
        cell = int(distances.argmin())
        return cell if distances[cell] <= within else None

    def is_clear(self, clearance: Array, a: Point, b: Point, room: float) -> bool:
        """Whether all cells on a straight line have so many metres of room."""
        count = ceil(hypot(b[0] - a[0], b[1] - a[1]) / (self.size / 2)) + 1
        columns = (np.linspace(a[0], b[0], count) - self.origin[0]) / self.size
        rows = (np.linspace(a[1], b[1], count) - self.origin[1]) / self.size
        return bool((clearance[rows.astype(int), columns.astype(int)] >= room).all())

    def _squared(self, segment: tuple[float, float, float, float]) -> Array:
        """Squared metres from each cell to a segment."""
        ax, ay, bx, by = segment
        dx, dy = bx - ax, by - ay
        t = np.clip(((self.xs - ax) * dx + (self.ys - ay) * dy) / max(dx**2 + dy**2, 1e-12), 0.0, 1.0)
        squared: Array = (self.xs - ax - t * dx) ** 2 + (self.ys - ay - t * dy) ** 2
        return squared

    def _inside(self, points: Sequence[Point]) -> Bools:
        inside = np.zeros(self.xs.shape, dtype=bool)
        for (ax, ay), (bx, by) in edges(points):
            if ay != by:
                crosses = ((ay > self.ys) != (by > self.ys)) & (self.xs < ax + (self.ys - ay) * (bx - ax) / (by - ay))
                inside ^= crosses
        return inside


def smooth(points: list[Point], is_clear: Callable[[Point, Point], bool]) -> list[Point]:
    """Leaves out points of a path where the straight line is clear."""
    kept, at = [points[0]], 0
    while at < len(points) - 1:
        far = min(len(points) - 1, at + 60)
        while far > at + 1 and not is_clear(points[at], points[far]):
            far -= 1 if far - at < 8 else (far - at) // 4
        at = far
        kept.append(points[at])
    return kept
