"""The battery and the dock."""

from __future__ import annotations

from btlang.robots.body import Battery, Body, Dock
from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.world import Place

_ENDLESS = Battery(0.0, 0.0, 0.0)  # of a robot whose file knows of no battery
_NO_DOCK = Dock(0.0, 0.0, 0.0)


class Power:
    """Percent left: drains with time and with metres, and gains when docked, as the body says."""

    def __init__(self, level: float, dock: Place | None, body: Body) -> None:
        self._battery, self._docking = body.battery or _ENDLESS, body.dock or _NO_DOCK
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

    def set_level(self, percent: float) -> None:
        """The battery is that full from now on, 0 to 100."""
        self.level = min(100.0, max(0.0, percent))

    def connect(self, pose: Pose) -> None:
        """Raises RobotError where there is no dock at the pose."""
        if self._dock is None:
            raise RobotError("there is no dock in this world")
        distance = pose.distance_to((self._dock.x, self._dock.y))
        if distance > self._docking.within:
            raise RobotError(f"the dock is {distance:.1f} m away")
        self.docked = True

    def step(self, dt: float, metres: float, pose: Pose) -> bool:
        """Moves on by `dt` seconds; returns True when the robot has just driven off its dock."""
        dock = self._dock
        if self.docked and dock is not None and pose.distance_to((dock.x, dock.y)) > self._docking.beyond:
            self.docked = False
            self._drain(dt, metres)
            return True
        if self.docked:
            self.level = min(100.0, self.level + self._battery.charging * dt)
        else:
            self._drain(dt, metres)
        return False

    def _drain(self, dt: float, metres: float) -> None:
        self.level = max(0.0, self.level - self._battery.idle * dt - self._battery.driving * metres)
