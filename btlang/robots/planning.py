"""Finds short free paths: A* on a grid whose cells know how far the nearest obstacle is."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush
from itertools import pairwise
from math import ceil, hypot

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import Point
from btlang.robots.grid import Array, Grid, smooth
from btlang.robots.obstacles import Disc, Obstacles
from btlang.robots.world import World
from btlang.robots.zones import Zones

CELL = 0.1
_NEEDED, _COMFORTABLE = 0.04, 0.2  # metres beside the robot
_USUAL_SPEED = 0.5  # metres a second: how much a slow zone costs
_START_SEARCH = 0.5
_GOAL_SEARCH = 0.15


class Planner:
    """Plans for a round robot among what stands still, around zones to keep out of; slow zones cost as they slow it.

    Raises RobotError where the world is too large.
    """

    def __init__(self, world: World, obstacles: Obstacles, radius: float, zones: Zones | None = None) -> None:
        self._grid = grid = Grid(world, CELL)
        self._obstacles = obstacles
        self._zones = zones or Zones(world.zones)
        self._radius, self._needed, self._comfort = radius, radius + _NEEDED, radius + _COMFORTABLE
        self._columns, self._origin = grid.columns, grid.origin
        self._fixed: Array | None = None
        self._walls = -1
        self._planned: object = None
        self._clearance: Array = np.empty(0)
        self._blocked: npt.NDArray[np.bool_] = np.empty(0, dtype=bool)
        self._costs: list[float] = []

    def path(self, start: Point, goal: Point, reach: float = 0.0, around: Sequence[Disc] = ()) -> list[Point] | None:
        """Points at most 0.1 m apart to the goal, or to a spot within reach of it without a wall between; None: no way.

        The last point is the goal itself, or up to 0.15 m beside one that is too near to an obstacle. The way leads
        `around` these discs, too.
        """
        self._refresh(tuple(around))
        first = self._grid.nearest_free(start, self._blocked, _START_SEARCH)
        if first is None:
            return None
        if reach:
            cells = self._search(first, goal, reach)
            return None if cells is None else self._smooth([start, *map(self._grid.centre, cells)])
        last = self._grid.nearest_free(goal, self._blocked, _GOAL_SEARCH)
        if last is None:
            return None
        cells = self._search(first, self._grid.centre(last), CELL / 4)
        if cells is None:
            return None
        exact = self._obstacles.nearest(*goal)[0] > self._radius
        ends = [goal] if exact else []
        return self._smooth([start, *map(self._grid.centre, cells[:-1] if exact else cells), *ends])

    def _refresh(self, around: tuple[Disc, ...]) -> None:
        planned = self._obstacles.layout, self._zones.version, around
        if self._planned == planned:
            return
        grid = self._grid
        if self._fixed is None or self._walls != self._obstacles.walls:
            self._fixed, self._walls = grid.clearance(self._obstacles), self._obstacles.walls
        clearance = self._fixed.copy()
        for x, y, radius in (*self._obstacles.discs, *around):
            np.minimum(clearance, np.hypot(grid.xs - x, grid.ys - y) - radius, out=clearance)
        for zone in self._zones.closed:
            np.minimum(clearance, grid.to_polygon(zone.points), out=clearance)
        for confines in self._zones.confines:
            depth = np.maximum.reduce([grid.depth(zone.points) for zone in confines])
            np.minimum(clearance, depth, out=clearance)
        tight = np.maximum(0.0, self._comfort - clearance) / (self._comfort - self._needed)
        costs = np.where(clearance < self._needed, 0.0, 1.0 + 3.0 * tight)
        for zone in self._zones.slow:
            costs[grid.to_polygon(zone.points) < self._radius] *= max(1.0, _USUAL_SPEED / zone.speed)
        costs[0, :] = costs[-1, :] = costs[:, 0] = costs[:, -1] = 0.0  # the rim is blocked, so neighbours always exist
        self._clearance = clearance
        self._blocked = costs.ravel() == 0.0
        self._costs = costs.ravel().tolist()
        self._planned = planned

    def _search(self, first: int, goal: Point, reach: float) -> list[int] | None:
        """A*: cells near obstacles cost up to four times as much, blocked ones have cost 0."""
        costs, columns, steps = self._costs, self._columns, self._grid.steps
        goal_x, goal_y = (goal[0] - self._origin[0]) / CELL - 0.5, (goal[1] - self._origin[1]) / CELL - 0.5
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
            if gone <= near and not (reach > CELL and self._obstacles.wall_between(self._grid.centre(cell), goal)):
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

    def _smooth(self, points: list[Point]) -> list[Point]:
        """Pulls the path straight where that leaves comfortable room, then spaces its points evenly."""
        room = self._comfort - CELL / 2
        return _evenly(smooth(points, lambda a, b: self._grid.is_clear(self._clearance, a, b, room)))


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
