"""Short free paths over a grid of distances to obstacles: for the robot (A*), and for people who share a goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from heapq import heappop, heappush
from itertools import pairwise
from math import ceil, hypot
from random import Random

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import Point
from btlang.robots.worlds.lanes import LaneMap
from btlang.robots.worlds.obstacles import Disc, Obstacles
from btlang.robots.worlds.planning_grid import Array, ClearanceGrid
from btlang.robots.worlds.world import World
from btlang.robots.zones import Zones

CELL = 0.1
_NEEDED, _COMFORTABLE = 0.04, 0.2  # metres beside the robot
_USUAL_SPEED = 0.5  # metres a second: how much a slow zone costs
_START_SEARCH = 0.5
_GOAL_SEARCH = 0.15
_CELL = 0.2
_ROOM = 0.05  # metres beside the widest person
_MOST_GOALS = 200
_TIGHT = 3
_SEARCH = 2.0  # metres to the nearest free cell


def smooth(points: list[Point], is_clear: Callable[[Point, Point], bool]) -> list[Point]:
    """Leave out points of a path if the straight line is clear."""
    kept, at = [points[0]], 0
    while at < len(points) - 1:
        far = min(len(points) - 1, at + 60)
        while far > at + 1 and not is_clear(points[at], points[far]):
            far -= 1 if far - at < 8 else (far - at) // 4
        at = far
        kept.append(points[at])
    return kept


class PathPlanner:
    """A planner for a round robot among standing obstacles, around zones to keep out of.

    Slow zones cost as much as they slow it, and it keeps to lanes. Raises RobotError if the world is too large.
    """

    def __init__(self, world: World, obstacles: Obstacles, radius: float, zones: Zones | None = None) -> None:
        self._grid = grid = ClearanceGrid(world, CELL)
        self._lanes = LaneMap(grid, world.lanes)
        self._obstacles = obstacles
        self._zones = zones or Zones(world.zones)
        self._radius, self._needed, self._comfort = radius, radius + _NEEDED, radius + _COMFORTABLE
        self._columns, self._origin = grid.columns, grid.origin
        self._fixed: Array | None = None
        self._walls = -1
        self._planned: object = None
        self._clearance: Array = np.empty(0)
        self._blocked: npt.NDArray[np.bool_] = np.empty(0, dtype=bool)
        self._steps: list[tuple[int, float, list[float]]] = []

    def path(self, start: Point, goal: Point, reach: float = 0.0, around: Sequence[Disc] = ()) -> list[Point] | None:
        """Return points at most 0.1 m apart to the goal, or to a spot within reach of it without a wall between; None:
        no way.

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
            self._fixed, self._walls = grid.clearance(self._obstacles, self._comfort), self._obstacles.walls
        clearance = self._fixed.copy()
        for x, y, radius in (*self._obstacles.discs, *around):
            window = grid.window((x, y, x, y), radius + self._comfort)
            to_disc = np.hypot(grid.xs[window] - x, grid.ys[window] - y) - radius
            clearance[window] = np.minimum(clearance[window], to_disc)
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
        self._steps = [(*step, each) for step, each in zip(grid.steps, self._lanes.by_step(costs), strict=True)]
        self._planned = planned

    def _search(self, first: int, goal: Point, reach: float) -> list[int] | None:
        """Search with A*: cells near obstacles cost up to four times as much, blocked ones have cost 0."""
        columns, steps = self._columns, self._steps
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
            for offset, length, costs in steps:
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
        """Pull the path straight where that leaves comfortable room and no lane, then space its points evenly."""
        room, clearance = self._comfort - CELL / 2, self._clearance
        is_clear = self._grid.is_clear
        return _evenly(smooth(points, lambda a, b: self._lanes.is_uniform(a, b) and is_clear(clearance, a, b, room)))


def _walk_back(came: dict[int, int], cell: int) -> list[int]:
    cells = [cell]
    while cell in came:
        cell = came[cell]
        cells.append(cell)
    return cells[::-1]


def _evenly(points: list[Point]) -> list[Point]:
    """Return the same polyline with a point at least every CELL metres."""
    spaced = [points[0]]
    for a, b in pairwise(points):
        pieces = max(1, ceil(hypot(b[0] - a[0], b[1] - a[1]) / CELL))
        spaced += [(a[0] + (b[0] - a[0]) * i / pieces, a[1] + (b[1] - a[1]) * i / pieces) for i in range(1, pieces + 1)]
    return spaced


class Walkways:
    """Ways around walls, closed doors and furniture for somebody with a radius in metres."""

    def __init__(self, world: World, obstacles: Obstacles, radius: float) -> None:
        self._grid, self._obstacles, self._room = ClearanceGrid(world, _CELL), obstacles, radius + _ROOM
        self._walls = -1
        self._blocked = np.empty(0, dtype=bool)
        self._free: list[bool] = []
        self._distances: dict[int, list[float]] = {}

    def path(self, start: Point, goal: Point) -> list[Point]:
        """Return the corners of the way, from the start on; empty if there is none."""
        self._refresh()
        first = self._cell(start)
        last = self._cell(goal)
        if first is None or last is None:
            return []
        distances = self._to(last)
        if distances[first] == np.inf:
            return []
        cells, at = [first], first
        while at != last:
            at = min([at + offset for offset, _ in self._grid.steps], key=distances.__getitem__)
            cells.append(at)
        return smooth([start, *map(self._grid.centre, cells[1:-1]), goal], self.is_clear)

    def is_clear(self, a: Point, b: Point) -> bool:
        """Return whether the straight line leaves room beside walls and furniture; somebody too near to one may leave
        it.
        """
        self._refresh()
        free, grid = self._free, self._grid
        (x, y), (low_x, low_y), size, columns = a, grid.origin, grid.size, grid.columns
        pieces = int(2 * hypot(b[0] - x, b[1] - y) / size) + 1
        step_x, step_y = (b[0] - x) / pieces, (b[1] - y) / pieces
        tight = _TIGHT  # pieces in which it may still be near to a wall
        for _ in range(pieces):  # plain numbers: these lines are too short for numpy
            x, y = x + step_x, y + step_y
            if free[int((y - low_y) / size) * columns + int((x - low_x) / size)]:
                tight = 0
            elif tight:
                tight -= 1
            else:
                return False
        return True

    def is_free(self, point: Point) -> bool:
        """Return whether somebody can stand there."""
        self._refresh()
        return self._free[self._grid.cell_of(point)]

    def near(self, point: Point, random: Random, within: float, good: Callable[[Point], bool]) -> Point | None:
        """Return a random free point to which a straight line leads; None if a few tries find none."""
        for _ in range(12):
            x, y = point[0] + random.uniform(-within, within), point[1] + random.uniform(-within, within)
            if self.is_free((x, y)) and good((x, y)) and self.is_clear(point, (x, y)):
                return x, y
        return None

    def _refresh(self) -> None:
        if self._walls == self._obstacles.walls:
            return
        self._walls = self._obstacles.walls
        free = self._grid.clearance(self._obstacles, self._room) >= self._room
        free[0, :] = free[-1, :] = free[:, 0] = free[:, -1] = False  # so that neighbours always exist
        self._blocked, self._free = ~free.ravel(), free.ravel().tolist()
        self._distances.clear()

    def _cell(self, point: Point) -> int | None:
        cell = self._grid.cell_of(point)
        return cell if self._free[cell] else self._grid.nearest_free(point, self._blocked, _SEARCH)

    def _to(self, goal: int) -> list[float]:
        """Return Dijkstra's distances of all cells from a goal, in cells."""
        if goal in self._distances:
            return self._distances[goal]
        if len(self._distances) >= _MOST_GOALS:
            self._distances.clear()
        steps, free = self._grid.steps, self._free
        distances = [np.inf] * len(free)
        distances[goal] = 0.0
        cells = [(0.0, goal)]
        while cells:
            gone, cell = heappop(cells)
            if gone > distances[cell]:
                continue
            for offset, length in steps:
                other, total = cell + offset, gone + length
                if free[other] and total < distances[other]:
                    distances[other] = total
                    heappush(cells, (total, other))
        self._distances[goal] = distances
        return distances
