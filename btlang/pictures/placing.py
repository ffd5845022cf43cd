"""Finds a free spot for a label near the point that it belongs to."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

_DIRECTIONS = 16
_RINGS = (0.0, 7.0, 16.0, 28.0, 44.0, 66.0)  # further and further from the point
_OUTSIDE = 1e4
_OVERLAP = 60.0  # that there is one at all
_PER_POINT = 6.0  # cost of a point of a line below the label, in square points of overlap


class Area(Record):
    """A rectangle in points."""

    x: float
    y: float
    width: float
    height: float

    @property
    def middle(self) -> tuple[float, float]:
        """Its centre."""
        return self.x + self.width / 2, self.y + self.height / 2

    def overlap(self, other: Area) -> float:
        """Square points that both cover."""
        across = min(self.x + self.width, other.x + other.width) - max(self.x, other.x)
        down = min(self.y + self.height, other.y + other.height) - max(self.y, other.y)
        return across * down if across > 0 and down > 0 else 0.0


class Placer:
    """Labels go within `sheet`. What is `taken` is not covered if there is room elsewhere, lines are avoided."""

    def __init__(self, sheet: Area) -> None:
        self._sheet = sheet
        self.taken: list[Area] = []
        self._points: npt.NDArray[np.float64] = np.zeros((0, 2))

    def avoid(self, points: Iterable[tuple[float, float]]) -> None:
        """Points of lines that labels should not hide."""
        self._points = np.concatenate([self._points, np.array(list(points), dtype=float).reshape(-1, 2)])

    def place(self, x: float, y: float, width: float, height: float, gap: float) -> tuple[Area, float]:
        """The best area of that size at least `gap` away from the point, now taken, and how much it overlaps."""
        best, least, overlap = Area(x, y, width, height), float("inf"), 0.0
        for ring in _RINGS:
            for step in range(_DIRECTIONS):
                area = _beside(x, y, width, height, gap + ring, 2 * pi * step / _DIRECTIONS)
                covered = self._covered(area)
                cost = (
                    (_OVERLAP + 4 * covered if covered else 0)
                    + self._hidden(area)
                    + 1.5 * ring
                    + (0 if step % 4 == 0 else 1)
                )
                if cost < least:
                    best, least, overlap = area, cost, covered
            if least < 1.5 * ring + 2:  # further out it cannot be better
                break
        self.taken.append(best)
        return best, overlap

    def _covered(self, area: Area) -> float:
        sheet = self._sheet
        inside = area.overlap(sheet) >= area.width * area.height - 1e-6
        return sum(area.overlap(other) for other in self.taken) + (0.0 if inside else _OUTSIDE)

    def _hidden(self, area: Area) -> float:
        xs, ys = self._points[:, 0], self._points[:, 1]
        within = (xs > area.x) & (xs < area.x + area.width) & (ys > area.y) & (ys < area.y + area.height)
        return _PER_POINT * float(np.count_nonzero(within))


def _beside(x: float, y: float, width: float, height: float, gap: float, angle: float) -> Area:
    """The area whose nearest edge is `gap` away from the point in a direction."""
    dx, dy = cos(angle), sin(angle)
    return Area(x + dx * (gap + width / 2) - width / 2, y + dy * (gap + height / 2) - height / 2, width, height)


def along(points: list[tuple[float, float]], step: float) -> list[tuple[float, float]]:
    """Points on a line, one for each `step` of its length, with both ends."""
    found = points[:1]
    left = step
    for (ax, ay), (bx, by) in pairwise(points):
        length = hypot(bx - ax, by - ay)
        at = left
        while at <= length and length > 0:
            found.append((ax + (bx - ax) * at / length, ay + (by - ay) * at / length))
            at += step
        left = at - length
    return found + points[-1:]
