"""What is where around a robot, by name."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.robots.geometry import Point, Pose
from btlang.robots.obstacles import Obstacles
from btlang.robots.robot import RobotError
from btlang.robots.world import Place, World, said

_SAME_SPOT = 0.01  # metres


class Surroundings:
    """The places, objects and people of a world; names are in any case. Raises RobotError for unknown ones."""

    def __init__(self, world: World, obstacles: Obstacles) -> None:
        self._given, self._world = world, world
        self._obstacles = obstacles

    def known(self, name: str) -> str:
        """The name as the world spells it."""
        names = self._world.names
        for known in (*names.places, *names.objects, *names.people):
            if known.lower() == name.lower():
                return known
        raise RobotError(f"I don't know where '{name}' is")

    def locate(self, name: str) -> Point | None:
        """Where it is; None while the robot carries it."""
        known = self.known(name)
        for place in self._world.places:
            if place.name == known:
                return place.x, place.y
        thing = self._obstacles.things[known]
        return None if self._obstacles.is_carried(known) else (thing.x, thing.y)

    def goal_at(self, pose: Pose) -> tuple[str, Pose | None]:
        """What a way to a pose is called, and where it ends: None on the spot of an object or a person, to which it
        then is a journey. On the spot of a place it is called by that name, and so knows that its way is blocked.
        """
        for place in self._world.places:
            if pose.distance_to((place.x, place.y)) <= _SAME_SPOT:
                return place.name, pose
        for thing in self._obstacles.things.values():
            if pose.distance_to((thing.x, thing.y)) <= _SAME_SPOT and not self._obstacles.is_carried(thing.name):
                return thing.name, None
        return f"({pose.x:.2f}, {pose.y:.2f})", pose

    def choices(self, kind: str) -> list[str]:
        """The names of a type, but for what the robot carries."""
        return [name for name in self._world.names.of(kind) if not self._obstacles.is_carried(name)]

    def name_places(self, places: Iterable[Place]) -> World:
        """The world with these places, in place of those of the mission before."""
        self._world = self._given.with_places(places)
        return self._world

    def move(self, name: str, x: float, y: float) -> None:
        """Puts an object or a person somewhere else."""
        known = self.known(name)
        if known not in self._obstacles.things or self._obstacles.is_carried(known):
            raise RobotError(f"{said(known)} can't be moved")
        self._obstacles.move(known, x, y)
