"""The battery and the dock."""

from __future__ import annotations

from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.world import Place

IDLE_DRAIN = 0.01
DRIVE_DRAIN = 0.1
CHARGE_RATE = 2.0
_DOCKED_WITHIN = 0.15
_UNDOCKED_BEYOND = 0.2


class Power:
    """Percent left: drains IDLE_DRAIN a second and DRIVE_DRAIN a metre, gains CHARGE_RATE a second when docked."""

    def __init__(self, level: float, dock: Place | None) -> None:
        self.level = level
        self.docked = False
        self._dock = dock

    @property
    def empty(self) -> bool:
        """True at 0 percent: the wheels get no power."""
        return self.level <= 0.0

    @property
    def charging(self) -> bool:
        """True while docked and not full."""
        return self.docked and self.level < 100.0

    def connect(self, pose: Pose) -> None:
        """Raises RobotError where there is no dock at the pose."""
        if self._dock is None:
            raise RobotError("there is no dock in this world")
        distance = pose.distance_to((self._dock.x, self._dock.y))
        if distance > _DOCKED_WITHIN:
            raise RobotError(f"the dock is {distance:.1f} m away")
        self.docked = True

    def step(self, dt: float, metres: float, pose: Pose) -> bool:
        """Moves on by `dt` seconds; returns True when the robot has just driven off its dock."""
        if self.docked and self._dock is not None and pose.distance_to((self._dock.x, self._dock.y)) > _UNDOCKED_BEYOND:
            self.docked = False
            self._drain(dt, metres)
            return True
        if self.docked:
            self.level = min(100.0, self.level + CHARGE_RATE * dt)
        else:
            self._drain(dt, metres)
        return False

    def _drain(self, dt: float, metres: float) -> None:
        self.level = max(0.0, self.level - IDLE_DRAIN * dt - DRIVE_DRAIN * metres)
