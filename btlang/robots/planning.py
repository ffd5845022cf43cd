"""Finds short free paths: A* on a grid whose cells know how far the nearest obstacle is."""

from __future__ import annotations

from heapq import heappop, heappush
from itertools import pairwise
from math import ceil, hypot, sqrt

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import Point
from btlang.robots.obstacles import Obstacles
from btlang.robots.robot import RobotError
from btlang.robots.world import World

Array = npt.NDArray[np.float64]

CELL = 0.1
_NEEDED, _COMFORTABLE = 0.04, 0.2  # metres beside the robot
_MARGIN = 1.0
_MOST_AREA = 40_000  # square metres: the grid takes 250 MB
_START_SEARCH = 0.5
_GOAL_SEARCH = 0.15


class Planner:
    """Plans for a round robot among the obstacles as they stand now. Raises RobotError where the world is too large."""

    def __init__(self, world: World, obstacles: Obstacles, radius: float) -> None:
        points = [(x, y) for ax, ay, bx, by in world.segments() for x, y in ((ax, ay), (bx, by))]
        points += [(world.start.x, world.start.y), *((place.x, place.y) for place in world.places)]
        points += [(thing.x, thing.y) for thing in (*world.objects, *world.people)]
        low_x, high_x = min(p[0] for p in points) - _MARGIN, max(p[0] for p in points) + _MARGIN
        low_y, high_y = min(p[1] for p in points) - _MARGIN, max(p[1] for p in points) + _MARGIN
        self._obstacles = obstacles
        self._radius, self._needed, self._comfort = radius, radius + _NEEDED, radius + _COMFORTABLE
        self._origin = low_x, low_y
        if (high_x - low_x) * (high_y - low_y) > _MOST_AREA:
            size = f"{high_x - low_x:.0f} m by {high_y - low_y:.0f} m"
            most = f"at most {_MOST_AREA:,} square metres are possible"
            raise RobotError(f"the world is too large to plan a way: {size}, and {most}")
        self._columns, self._rows = ceil((high_x - low_x) / CELL), ceil((high_y - low_y) / CELL)
        self._xs, self._ys = np.meshgrid(
            low_x + CELL * (np.arange(self._columns) + 0.5), low_y + CELL * (np.arange(self._rows) + 0.5)
        )
        self._fixed: Array | None = None
        self._version = -1
        self._clearance: Array = np.empty(0)
        self._blocked: npt.NDArray[np.bool_] = np.empty(0, dtype=bool)
        self._costs: list[float] = []

    def path(self, start: Point, goal: Point, reach: float = 0.0) -> list[Point] | None:
        """Points at most 0.1 m apart to the goal, or to a spot within reach of it without a wall between; None: no way.

        The last point is the goal itself, or up to 0.15 m beside one that is too near to an obstacle.
        """
        self._refresh()
        first = self._free_cell(start, _START_SEARCH)
        if first is None:
            return None
        if reach:
            cells = self._search(first, goal, reach)
            return None if cells is None else self._smooth([start, *map(self._centre, cells)])
        last = self._free_cell(goal, _GOAL_SEARCH)
        if last is None:
            return None
        cells = self._search(first, self._centre(last), CELL / 4)
        if cells is None:
            return None
        exact = self._obstacles.nearest(*goal)[0] > self._radius
        ends = [goal] if exact else []
        return self._smooth([start, *map(self._centre, cells[:-1] if exact else cells), *ends])

    def _refresh(self) -> None:
        if self._version == self._obstacles.version:
            return
        if self._fixed is None:
            self._fixed = _clearance(self._obstacles, self._xs, self._ys)
        clearance = self._fixed.copy()
        for x, y, radius in self._obstacles.discs:
            np.minimum(clearance, np.hypot(self._xs - x, self._ys - y) - radius, out=clearance)
        tight = np.maximum(0.0, self._comfort - clearance) / (self._comfort - self._needed)
        costs = np.where(clearance < self._needed, 0.0, 1.0 + 3.0 * tight)
        costs[0, :] = costs[-1, :] = costs[:, 0] = costs[:, -1] = 0.0  # the rim is blocked, so neighbours always exist
        self._clearance = clearance
        self._blocked = costs.ravel() == 0.0
        self._costs = costs.ravel().tolist()
        self._version = self._obstacles.version

    def _search(self, first: int, goal: Point, reach: float) -> list[int] | None:
        """A*: cells near obstacles cost up to four times as much, blocked ones have cost 0."""
        costs, columns = self._costs, self._columns
        goal_x, goal_y = (goal[0] - self._origin[0]) / CELL - 0.5, (goal[1] - self._origin[1]) / CELL - 0.5
        steps = [(d_row * columns + d_column, sqrt(abs(d_row) + abs(d_column)))
                 for d_row in (-1, 0, 1) for d_column in (-1, 0, 1) if d_row or d_column]  # fmt: skip
        near = reach / CELL
        best = {first: 0.0}
        came: dict[int, int] = {}
        closed: set[int] = set()
        open_cells = [(0.0, first)]
        while open_cells:
            cell = heappop(open_cells)[1]
            if cell in closed:
                continue
            closed.add(cell)
            row, column = divmod(cell, columns)
            gone = hypot(column - goal_x, row - goal_y)
            if gone <= near and not (reach > CELL and self._obstacles.wall_between(self._centre(cell), goal)):
                return _walk_back(came, cell)
            here = best[cell]
            for offset, length in steps:
                other = cell + offset
                cost = costs[other]
                if not cost or other in closed:
                    continue
                total = here + length * cost
                if total < best.get(other, 1e9):
                    best[other] = total
                    came[other] = cell
                    row, column = divmod(other, columns)
                    heappush(open_cells, (total + hypot(column - goal_x, row - goal_y), other))
        return None

    def _free_cell(self, point: Point, within: float) -> int | None:
        distances = np.hypot(self._xs - point[0], self._ys - point[1]).ravel()
        distances[self._blocked] = np.inf
        cell = int(distances.argmin())
        return cell if distances[cell] <= within else None

    def _centre(self, cell: int) -> Point:
        row, column = divmod(cell, self._columns)
        return self._origin[0] + CELL * (column + 0.5), self._origin[1] + CELL * (row + 0.5)

    def _smooth(self, points: list[Point]) -> list[Point]:
        """Pulls the path straight where that leaves comfortable room, then spaces its points evenly."""
        kept, at = [points[0]], 0
        while at < len(points) - 1:
            far = min(len(points) - 1, at + 60)
            while far > at + 1 and not self._comfortable(points[at], points[far]):
                far -= 1 if far - at < 8 else (far - at) // 4
            at = far
            kept.append(points[at])
        return _evenly(kept)

    def _comfortable(self, a: Point, b: Point) -> bool:
        count = ceil(hypot(b[0] - a[0], b[1] - a[1]) / (CELL / 2)) + 1
        columns = (np.linspace(a[0], b[0], count) - self._origin[0]) / CELL
        rows = (np.linspace(a[1], b[1], count) - self._origin[1]) / CELL
        return bool((self._clearance[rows.astype(int), columns.astype(int)] >= self._comfort - CELL / 2).all())


def _clearance(obstacles: Obstacles, xs: Array, ys: Array) -> Array:
    """For many points: metres to the nearest wall or box, 0 inside a box."""
    nearest2 = np.full(xs.shape, np.inf)
    for ax, ay, bx, by in obstacles.segments:
        dx, dy = bx - ax, by - ay
        t = np.clip(((xs - ax) * dx + (ys - ay) * dy) / max(dx**2 + dy**2, 1e-12), 0.0, 1.0)
        nearest2 = np.minimum(nearest2, (xs - ax - t * dx) ** 2 + (ys - ay - t * dy) ** 2)
    for box in obstacles.boxes:
        inside = (np.abs(xs - box.x) <= box.width / 2) & (np.abs(ys - box.y) <= box.height / 2)
        nearest2[inside] = 0.0
    clearance: Array = np.sqrt(nearest2)
    return clearance


def _walk_back(came: dict[int, int], cell: int) -> list[int]:
    cells = [cell]
    while cell in came:
        cell = came[cell]
        cells.append(cell)
    return cells[::-1]


def _evenly(points: list[Point]) -> list[Point]:
    """The same polyline with a point at least every CELL metres."""
    spaced = [points[0]]
    for a, b in pairwise(points):
        pieces = max(1, ceil(hypot(b[0] - a[0], b[1] - a[1]) / CELL))
        spaced += [(a[0] + (b[0] - a[0]) * i / pieces, a[1] + (b[1] - a[1]) * i / pieces) for i in range(1, pieces + 1)]
    return spaced
