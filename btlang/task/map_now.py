"""The map of a robot's world as it is by now, for those who watch."""

from __future__ import annotations

from btlang.robots.worlds.world import KEEP_OUT, World, Zone
from btlang.run.events import DoorMoved
from btlang.run.robot_state import asked

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.zones import Zones

_OPEN = "open"


class MapNow:
    """`world` is another one whenever a door was moved, or a mission has closed or opened a zone."""

    def __init__(self, world: World) -> None:
        self.world = world
        self._zones, self._version = world.zones, -1
        self._written: tuple[World, dict[str, Any]] = world, world.as_map()

    @property
    def written(self) -> dict[str, Any]:
        """The world as JSON has it; see World.as_map."""
        world, written = self._written
        if world is not self.world:
            world, written = self._written = self.world, self.world.as_map()
        return written

    def look(self, robot: Any) -> None:
        """Takes in which zones are closed. For the thread of the run."""
        zones = asked(lambda: robot.zones)
        if zones is None or zones.version == self._version:
            return
        self._version = zones.version
        now = tuple(_now(zone, zones) for zone in self._zones)
        if now != self.world.zones:
            self.world = self.world.replace(zones=now)

    def move_door(self, event: DoorMoved) -> None:
        """Takes in that a door is open, or closed."""
        doors = (door.replace(open=event.open) if door.name == event.name else door for door in self.world.doors)
        self.world = self.world.replace(doors=tuple(doors))


def _now(zone: Zone, zones: Zones) -> Zone:
    """A zone with another kind: a slow one is closed, or one to keep out of is open."""
    closed = zones.is_closed(zone.name)
    kind = KEEP_OUT if closed else _OPEN if zone.is_closed else zone.kind
    now: Zone = zone if kind == zone.kind else zone.replace(kind=kind)
    return now
