"""Lanes for the planner of ways: a robot keeps to them, in their direction, unless that is a long way round."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import Point
from btlang.robots.worlds.planning_grid import ClearanceGrid
from btlang.robots.worlds.world import Lane

_HALF_WIDTH = 0.15  # metres, more than the distance of two cells
_BESIDE = 3.0  # how much a metre costs beside the lanes, or against one


class LaneMap:
    """The cells of a grid that lanes lead through, and the steps between cells that they allow."""

    def __init__(self, grid: ClearanceGrid, lanes: Sequence[Lane]) -> None:
        self._grid, self._lanes = grid, lanes
        self._on = np.zeros((len(grid.steps), *grid.xs.shape), dtype=bool)  # by step: the cells that it may lead to
        for lane in lanes:
            window, near = grid.beside((*lane.start, *lane.end), _HALF_WIDTH)
            along, up = lane.end[0] - lane.start[0], lane.end[1] - lane.start[1]
            for step, (row, column) in enumerate(grid.directions):
                if not lane.one_way or column * along + row * up >= 0.0:
                    self._on[(step, *window)] |= near
        self._any = np.logical_or.reduce(self._on)

    def by_step(self, costs: npt.NDArray[np.float64]) -> list[list[float]]:
        """Return the costs of all cells for each step of the grid: without lanes, those of the cells."""
        if not self._lanes:
            return [costs.ravel().tolist()] * len(self._on)
        return [np.where(on, costs, _BESIDE * costs).ravel().tolist() for on in self._on]

    def is_uniform(self, a: Point, b: Point) -> bool:
        """Return whether a straight line is all on lanes, or all beside them."""
        if not self._lanes:
            return True
        on = self._any[self._grid.line(a, b)]
        return bool(on.all() or not on.any())
