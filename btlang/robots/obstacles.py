"""All that the robot can run into: fixed segments, and the discs of objects and people, which may move."""

from __future__ import annotations

from math import inf, sqrt

import numpy as np
import numpy.typing as npt

from btlang.robots.geometry import Point
from btlang.robots.world import Thing, World

Array = npt.NDArray[np.float64]


class Obstacles:
    """The obstacles of one run. `version` changes whenever something moves, so that others may cache."""

    def __init__(self, world: World) -> None:
        self.version = 0
        self.things: dict[str, Thing] = {thing.name: thing for thing in (*world.objects, *world.people)}
        self._carried: set[str] = set()
        self._boxes = world.boxes
        self._walls = len(world.wall_segments())
        segments = np.array(world.segments(), dtype=np.float64).reshape(-1, 4)
        self.starts: Array = segments[:, :2]
        self.spans: Array = segments[:, 2:] - segments[:, :2]
        self._lengths2 = np.maximum((self.spans**2).sum(axis=1), 1e-12)
        self._names: list[str] = []
        self.discs: Array = np.empty((0, 3))
        self._collect_discs()

    def move(self, name: str, x: float, y: float) -> None:
        """Puts an object or a person somewhere else. Raises KeyError for an unknown name."""
        self.things[name] = self.things[name].replace(x=x, y=y)
        self._collect_discs()

    def pick_up(self, name: str) -> None:
        """Takes an object off the floor: it is no obstacle while carried."""
        self._carried.add(name)
        self._collect_discs()

    def put_down(self, name: str, x: float, y: float) -> None:
        """The opposite of `pick_up`."""
        self._carried.discard(name)
        self.move(name, x, y)

    def is_carried(self, name: str) -> bool:
        """Whether the robot holds it."""
        return name in self._carried

    def nearest(self, x: float, y: float) -> tuple[float, str]:
        """Metres from the point to the nearest surface, and the name of what it is ("a wall" if fixed)."""
        distance, name = inf, "nothing"
        if len(self.starts):
            distance, name = self._to_segments(x, y), "a wall"
        if len(self.discs):
            gaps = np.hypot(self.discs[:, 0] - x, self.discs[:, 1] - y) - self.discs[:, 2]
            index = int(gaps.argmin())
            if gaps[index] < distance:
                distance, name = float(gaps[index]), self._names[index]
        return distance, name

    def wall_between(self, a: Point, b: Point) -> bool:
        """True when a wall (not furniture) crosses the straight line from a to b."""
        starts, spans = self.starts[: self._walls], self.spans[: self._walls]
        if not len(starts):
            return False
        dx, dy = b[0] - a[0], b[1] - a[1]
        fx, fy = starts[:, 0] - a[0], starts[:, 1] - a[1]
        cross = dx * spans[:, 1] - dy * spans[:, 0]
        cross = np.where(np.abs(cross) < 1e-12, np.nan, cross)
        t = (fx * spans[:, 1] - fy * spans[:, 0]) / cross
        u = (fx * dy - fy * dx) / cross
        return bool(((t >= 0) & (t <= 1) & (u >= 0) & (u <= 1)).any())

    def fixed_clearance(self, xs: Array, ys: Array) -> Array:
        """For many points: metres to the nearest wall or box, 0 inside a box."""
        nearest2 = np.full(xs.shape, inf)
        for (ax, ay), (dx, dy), length2 in zip(self.starts, self.spans, self._lengths2, strict=True):
            t = np.clip(((xs - ax) * dx + (ys - ay) * dy) / length2, 0.0, 1.0)
            nearest2 = np.minimum(nearest2, (xs - ax - t * dx) ** 2 + (ys - ay - t * dy) ** 2)
        for box in self._boxes:
            inside = (np.abs(xs - box.x) <= box.width / 2) & (np.abs(ys - box.y) <= box.height / 2)
            nearest2[inside] = 0.0
        clearance: Array = np.sqrt(nearest2)
        return clearance

    def _to_segments(self, x: float, y: float) -> float:
        fx, fy = x - self.starts[:, 0], y - self.starts[:, 1]
        dx, dy = self.spans[:, 0], self.spans[:, 1]
        t = np.minimum(1.0, np.maximum(0.0, (fx * dx + fy * dy) / self._lengths2))
        gaps2 = (fx - t * dx) ** 2 + (fy - t * dy) ** 2
        return sqrt(gaps2.min())

    def _collect_discs(self) -> None:
        self.version += 1
        standing = [thing for thing in self.things.values() if thing.name not in self._carried]
        self._names = [thing.name for thing in standing]
        self.discs = np.array([(t.x, t.y, t.radius) for t in standing], dtype=np.float64).reshape(-1, 3)
