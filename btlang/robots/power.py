"""The battery and the dock."""

from __future__ import annotations

from collections.abc import Callable

from btlang.robots.body import Battery, Body, Dock
from btlang.robots.geometry import Pose, segment_distance
from btlang.robots.robot import RobotError
from btlang.robots.world import NEVER, Place, World

_ENDLESS = Battery(0.0, 0.0, 0.0)  # of a robot whose file knows of no battery
_NO_DOCK = Dock(0.0, 0.0, 0.0)
_SHARES = (1.0, 0.75, 0.5, 0.25)  # of the way in front of a dock for which a wall may leave room
NO_CONTACT = "the dock doesn't connect"
_NOWHERE = "there is no dock in this world"


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

    def connect(self, pose: Pose, fails: Callable[[], bool]) -> None:
        """Raises RobotError where there is no dock at the pose, or it `fails` to connect."""
        if self._dock is None:
            raise RobotError(_NOWHERE)
        if not self.is_near_dock(pose):
            raise RobotError(f"the dock is {pose.distance_to((self._dock.x, self._dock.y)):.1f} m away")
        if fails():
            raise RobotError(NO_CONTACT)
        self.docked = True

    def is_near_dock(self, pose: Pose) -> bool:
        """Whether it can connect there."""
        return self._dock is not None and pose.distance_to((self._dock.x, self._dock.y)) <= self._docking.within

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


def staging_pose(world: World, body: Body) -> Pose:
    """Where the robot stands before it drives straight into the dock: so far in front of it as the body says, or nearer
    where walls leave less room. Raises RobotError where the world has no dock.
    """
    if world.dock is None:
        raise RobotError(_NOWHERE)
    dock = Pose(world.dock.x, world.dock.y, world.dock.facing or 0.0)
    wanted = (body.dock or _NO_DOCK).staging
    spots = (Pose(*dock.ahead(-share * wanted), dock.heading) for share in _SHARES)
    return next((spot for spot in spots if _is_free(spot, world, body.radius)), dock)


def _is_free(spot: Pose, world: World, radius: float) -> bool:
    point = spot.x, spot.y
    gap = min((segment_distance(point, segment) for segment in world.segments()), default=NEVER)
    return gap >= radius and not any(box.contains(point) for box in world.boxes)
