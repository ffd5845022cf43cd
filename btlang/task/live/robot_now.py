"""The map of a robot's world and its body as they are now, for watchers."""

from __future__ import annotations

from functools import partial

from btlang.robots.worlds.world import KEEP_OUT, World, Zone
from btlang.run.events import DoorMoved
from btlang.run.robot_state import ask_sensor

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Joint
    from btlang.robots.zones import Zones


_PERIOD = 0.1  # seconds between two looks at the joints


class BodyNow:
    """The body of a robot as it is now.

    `joints` are those of links, in the order of the body's URDF: radians and metres, None for one that isn't known.
    `speech` is the text that is spoken, "" for none, with where the word of now begins and ends.
    """

    def __init__(self) -> None:
        self.joints: list[float | None] = []
        self.speech: tuple[str, int, int] = ("", 0, 0)
        self._next = 0.0

    def look(self, robot: Any, wall: float) -> None:
        """Take in how the robot is now, in the thread of the run."""
        self.speech = ask_sensor(lambda: _speech(robot)) or ("", 0, 0)
        if wall < self._next:
            return
        self._next = wall + _PERIOD
        joints = [joint for joint in getattr(getattr(robot, "body", None), "joints", ()) if joint.link]
        self.joints = [ask_sensor(partial(_position, robot, joint)) for joint in joints]


def _position(robot: Any, joint: Joint) -> float:
    return round(float(robot.joint(joint.name)) * joint.si, 3)


def _speech(robot: Any) -> tuple[str, int, int] | None:
    """Return what the robot says now; None if it says nothing, or not yet."""
    said, now = robot.said, robot.time - robot.said_at
    if said is None or now < 0 or not robot.speaking:
        return None
    word = said.word_at(now)
    return (said.text, 0, 0) if word is None else (said.text, word.start, word.end)


_OPEN = "open"


class MapNow:
    """The map of a robot's world as it is now.

    `world` is another one whenever a door was moved, or a mission has closed or opened a zone.
    """

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
        """Take in which zones are closed, in the thread of the run."""
        zones = ask_sensor(lambda: robot.zones)
        if zones is None or zones.version == self._version:
            return
        self._version = zones.version
        now = tuple(_now(zone, zones) for zone in self._zones)
        if now != self.world.zones:
            self.world = self.world.replace(zones=now)

    def move_door(self, event: DoorMoved) -> None:
        """Take in that a door is open, or closed."""
        doors = (door.replace(open=event.open) if door.name == event.name else door for door in self.world.doors)
        self.world = self.world.replace(doors=tuple(doors))


def _now(zone: Zone, zones: Zones) -> Zone:
    """Return a zone with another kind: a slow one that is closed, or one to keep out of that is open."""
    closed = zones.is_closed(zone.name)
    kind = KEEP_OUT if closed else _OPEN if zone.is_closed else zone.kind
    now: Zone = zone if kind == zone.kind else zone.replace(kind=kind)
    return now
