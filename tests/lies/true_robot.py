"""What really happens: a robot between walls that does what it is told, without a watchdog."""

from __future__ import annotations

from math import cos, hypot, inf, radians, sin

import numpy as np

from btlang.robots.geometry import Pose, Segment, segment_distance, wrap
from btlang.robots.simulation.base import step_towards
from btlang.robots.worlds.scan import Array, scan

RADIUS = 0.2
BRAKE = 2.0


class TrueRobot:
    """It starts at the origin, facing a wall that is `wall` metres before its rim. Metres, degrees and seconds.

    It takes a command `late`, gets faster by `acceleration`, and `grip` of what its wheels do reaches the floor.
    """

    def __init__(
        self, wall: float = 6.0, late: float = 0.0, acceleration: float = 1.0, grip: float = 1.0, clear: bool = False
    ) -> None:
        ahead, back, side = wall + RADIUS, -4.0, 4.0
        self.walls: list[Segment] = [
            (ahead, -side, ahead, side), (ahead, side, back, side),
            (back, side, back, -side), (back, -side, ahead, -side),
        ]  # fmt: skip
        if clear:
            self.walls = []
        self._late, self._acceleration, self._grip = late, acceleration, grip
        self._waiting: list[tuple[float, float, float]] = []
        self._wanted = 0.0, 0.0
        self.time = self.x = self.y = self.heading = 0.0
        self.speed = self.spin = 0.0
        self.driven = 0.0
        self.joint = self.joint_target = 0.0
        self.touched = False

    @property
    def pose(self) -> Pose:
        """Where it is."""
        return Pose(self.x, self.y, self.heading)

    @property
    def free(self) -> float:
        """Metres between its rim and the nearest wall."""
        return min((segment_distance((self.x, self.y), wall) for wall in self.walls), default=inf) - RADIUS

    @property
    def at_rest(self) -> bool:
        """Whether it stands."""
        return self.speed == 0.0 == self.spin

    def drive(self, linear: float, angular: float) -> None:
        """It is commanded so."""
        self._waiting.append((self.time + self._late, linear, angular))

    def step(self, passed: float) -> None:
        """So many seconds pass."""
        while passed > 1e-9:
            self._move(min(passed, 0.01))
            passed -= 0.01

    def _move(self, passed: float) -> None:
        self.time += passed
        while self._waiting and self._waiting[0][0] <= self.time:
            _, *wanted = self._waiting.pop(0)
            self._wanted = wanted[0], wanted[1]
        self.speed = step_towards(self.speed, self._wanted[0], self._acceleration * passed, BRAKE * passed)
        self.spin = step_towards(self.spin, self._wanted[1], 240.0 * passed, 480.0 * passed)
        middle = radians(self.heading + self.spin * passed / 2)
        way = self.speed * self._grip * passed
        x, y = self.x + way * cos(middle), self.y + way * sin(middle)
        self.heading = wrap(self.heading + self.spin * passed)
        before, here = self.free, (self.x, self.y)
        self.x, self.y = x, y
        if self.free < 0.0 and self.free < before:
            (self.x, self.y), self.speed, self.touched = here, 0.0, True
        self.driven += hypot(self.x - here[0], self.y - here[1])
        self.joint += max(-90.0 * passed, min(90.0 * passed, self.joint_target - self.joint))

    def ranges(self) -> Array:
        """What a perfect scanner measures in 360 degrees."""
        return scan(np.array(self.walls, dtype=np.float64).reshape(-1, 4), np.empty((0, 3)), self.pose, 10.0).copy()

    def ahead(self) -> float:
        """What a perfect distance sensor on its rim measures ahead."""
        ranges = self.ranges()
        return float(min(ranges[beam % 360] for beam in range(-7, 8))) - RADIUS


class Witness:
    """Sees when a lie began, and how far the robot went and how long it took from then until it stood."""

    def __init__(self, robot: TrueRobot) -> None:
        self._robot = robot
        self.began: tuple[float, float] | None = None
        self._moved_at: tuple[float, float] | None = None

    def begin(self) -> None:
        """A lie begins now."""
        if self.began is None:
            self.began = self._moved_at = self._robot.time, self._robot.driven

    def look(self) -> None:
        """Looks at the robot; to be called after each of its steps."""
        if self.began is not None and not self._robot.at_rest:
            self._moved_at = self._robot.time, self._robot.driven

    @property
    def way(self) -> float:
        """Metres that it went."""
        return 0.0 if self.began is None or self._moved_at is None else self._moved_at[1] - self.began[1]

    @property
    def seconds(self) -> float:
        """Seconds until it stood."""
        return 0.0 if self.began is None or self._moved_at is None else self._moved_at[0] - self.began[0]
