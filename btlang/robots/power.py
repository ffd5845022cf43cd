"""The battery and the dock."""

from __future__ import annotations

from collections.abc import Callable

from btlang.robots.body import Battery, Body, Dock
from btlang.robots.geometry import Pose, segment_distance
from btlang.robots.robot import RobotError
from btlang.robots.station import Station
from btlang.robots.world import NEVER, Place, World

_ENDLESS = Battery(0.0, 0.0, 0.0)  # of a robot whose file knows of no battery
_NO_DOCK = Dock(0.0, 0.0, 0.0)
_SHARES = (1.0, 0.75, 0.5, 0.25)  # of the way in front of a dock for which a wall may leave room
NO_CONTACT = "the dock doesn't connect"
_NOWHERE = "there is no dock in this world"


class Power:
    """Percent left: drains with time and with metres, and gains when docked, as the body says."""

    def __init__(self, level: float, docks: tuple[Place, ...], body: Body) -> None:
        self._battery, self._docking = body.battery or _ENDLESS, body.dock or _NO_DOCK
        self.level = level
        self.docked = False
        self._docks = docks

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

    def connect(self, pose: Pose, fails: Callable[[str], bool]) -> None:
        """Raises RobotError where there is no dock at the pose, or the one of this name `fails` to connect."""
        if not self._docks:
            raise RobotError(_NOWHERE)
        away, name = self._nearest(pose)
        if away > self._docking.within:
            raise RobotError(f"the {name} is {away:.1f} m away")
        if fails(name):
            raise RobotError(NO_CONTACT)
        self.docked = True

    def is_near_dock(self, pose: Pose) -> bool:
        """Whether it can connect there."""
        return self._nearest(pose)[0] <= self._docking.within

    def _nearest(self, pose: Pose) -> tuple[float, str]:
        """Metres to the nearest dock, and its name."""
        return min(((pose.distance_to((dock.x, dock.y)), dock.name) for dock in self._docks), default=(NEVER, ""))

    def step(self, dt: float, metres: float, pose: Pose) -> bool:
        """Moves on by `dt` seconds; returns True when the robot has just driven off its dock."""
        if self.docked and self._nearest(pose)[0] > self._docking.beyond:
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


def stations(world: World, body: Body, pose: Pose) -> list[Station]:
    """The docks of a world, the nearest first. Raises RobotError where it has none."""
    if not world.all_docks:
        raise RobotError(_NOWHERE)
    return [_station(dock, world, body) for dock in world.docks_from(pose)]


def _station(dock: Place, world: World, body: Body) -> Station:
    """It is left from so far in front of it as the body says, or nearer where walls leave less room."""
    spot = Pose(dock.x, dock.y, dock.facing or 0.0)
    wanted = (body.dock or _NO_DOCK).staging
    stagings = (Pose(*spot.ahead(-share * wanted), spot.heading) for share in _SHARES)
    return Station(dock.name, spot, next((each for each in stagings if _is_free(each, world, body.radius)), spot))


def _is_free(spot: Pose, world: World, radius: float) -> bool:
    point = spot.x, spot.y
    gap = min((segment_distance(point, segment) for segment in world.segments()), default=NEVER)
    return gap >= radius and not any(box.contains(point) for box in world.boxes)
