"""Ways of people through a world: for each goal the distances of all cells, so that many people cost one search."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from math import hypot
from random import Random

import numpy as np

from btlang.robots.geometry import Point
from btlang.robots.grid import Grid, smooth
from btlang.robots.obstacles import Obstacles
from btlang.robots.world import World

_CELL = 0.2
_ROOM = 0.05  # metres beside the widest person
_MOST_GOALS = 200
_TIGHT = 3
_SEARCH = 2.0  # metres to the nearest free cell


class Walkways:
    """Ways around walls, closed doors and furniture for somebody of a radius in metres."""

    def __init__(self, world: World, obstacles: Obstacles, radius: float) -> None:
        self._grid, self._obstacles, self._room = Grid(world, _CELL), obstacles, radius + _ROOM
        self._walls = -1
        self._blocked = np.empty(0, dtype=bool)
        self._free: list[bool] = []
        self._distances: dict[int, list[float]] = {}

    def path(self, start: Point, goal: Point) -> list[Point]:
        """The corners of the way, from the start on; empty if there is none."""
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
        """Whether the straight line leaves room beside walls and furniture; who stands too near to one may leave it."""
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
        """Whether somebody can stand there."""
        self._refresh()
        return self._free[self._grid.cell_of(point)]

    def near(self, point: Point, random: Random, within: float, good: Callable[[Point], bool]) -> Point | None:
        """A good free point by chance, to which a straight line leads; None where a few tries find none."""
        for _ in range(12):
            x, y = point[0] + random.uniform(-within, within), point[1] + random.uniform(-within, within)
            if self.is_free((x, y)) and good((x, y)) and self.is_clear(point, (x, y)):
                return x, y
        return None

    def _refresh(self) -> None:
        if self._walls == self._obstacles.walls:
            return
        self._walls = self._obstacles.walls
        free = self._grid.clearance(self._obstacles) >= self._room
        free[0, :] = free[-1, :] = free[:, 0] = free[:, -1] = False  # so that neighbours always exist
        self._blocked, self._free = ~free.ravel(), free.ravel().tolist()
        self._distances.clear()

    def _cell(self, point: Point) -> int | None:
        cell = self._grid.cell_of(point)
        return cell if self._free[cell] else self._grid.nearest_free(point, self._blocked, _SEARCH)

    def _to(self, goal: int) -> list[float]:
        """Dijkstra's distances of all cells from a goal, in cells."""
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
