"""Journeys: plans a path to something that has a name, or to a pose, follows it, and faces what it went for."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import cos, dist, radians, sqrt

from btlang.robots.base import Base
from btlang.robots.body import Body, Limits
from btlang.robots.faults import Faults
from btlang.robots.geometry import Point, Pose, wrap
from btlang.robots.obstacles import Obstacles
from btlang.robots.robot import RobotError
from btlang.robots.world import Place, Thing, World, said

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.planning import Planner

ROOM = 0.15
"""Metres between the robot and an object or a person that it goes to, at least."""

_LOOK_AHEAD = 0.25
_NEAR, _FACING = 0.03, 1.0


class Journey:
    """One way to one goal; see `btlang.robots.robot.Deed`.

    `name` is that of what it goes to, or shows the spot; with a `pose` it ends there, facing as the pose does.
    """

    def __init__(self, name: str, base: Base, pose: Pose | None = None) -> None:
        self.name = name
        self.pose = pose
        self.done = False
        self.failure: str | None = None
        self.path: list[Point] = []
        self.at = 0
        self.version = -1
        self.bumps = base.bumps
        self.driven = False
        self._base = base

    def cancel(self) -> None:
        """Gives up and brakes. Does nothing when done."""
        self.end("the way was given up")

    @property
    def left(self) -> float:
        """Metres of the path that are left."""
        rest = [(self._base.pose.x, self._base.pose.y), *self.path[self.at :]]
        return sum(dist(a, b) for a, b in pairwise(rest))

    def end(self, failure: str | None) -> None:
        """Comes to rest, arrived or with the reason why not."""
        if not self.done:
            self.failure = failure
            self.done = True
            self._base.brake()


class Navigator:
    """Drives the base along the journey under way."""

    def __init__(self, world: World, base: Base, obstacles: Obstacles, faults: Faults) -> None:
        self._places: dict[str, Place] = {place.name: place for place in world.places}
        self._people = set(world.names.people)
        self._base = base
        self._body = base.body
        self._obstacles = obstacles
        self._faults = faults
        self._world = world
        self._planner: Planner | None = None
        self.journey: Journey | None = None

    def name_places(self, places: Iterable[Place]) -> None:
        """These are the named places from now on."""
        self._places = {place.name: place for place in places}

    def start(self, name: str, pose: Pose | None = None) -> Journey:
        """Sets out at once; a journey under way is given up. Without a pose the name is one of the world's."""
        self.cancel(f"the robot set out for {said(name)} instead")
        self.journey = Journey(name, self._base, pose)
        self._check(self.journey)
        return self.journey

    def cancel(self, reason: str) -> None:
        """Ends the journey under way, if there is one."""
        if self.journey is not None:
            self.journey.end(reason)

    def control(self) -> Journey | None:
        """Commands the base for the next moment; returns the journey when it ends with this call."""
        journey = self.journey
        if journey is None:
            return None
        if not journey.done:
            self._check(journey)
        if not journey.done:
            self._follow(journey)
        if journey.done:
            self.journey = None
            return journey
        return None

    def _check(self, journey: Journey) -> None:
        """Ends a journey that cannot go on; plans anew when something has moved."""
        name = journey.name
        if self._base.bumps > journey.bumps:
            journey.end(f"bumped into {self._base.bumped_into} on the way to {said(name)}")
        elif self._base.stuck:
            journey.end(f"stuck on the way to {said(name)}: the wheels turn but the robot does not move")
        elif self._faults.blocked(name):
            journey.end(f"there is no free way to {said(name)}")
        elif journey.version != self._obstacles.version:
            self._plan(journey)

    def _plan(self, journey: Journey) -> None:
        journey.version = self._obstacles.version
        goal, reach = self._goal(journey)
        if self._planner is None:
            from btlang.robots.planning import Planner  # brings numpy, which takes longer to import than many missions

            self._planner = Planner(self._world, self._obstacles, self._body.radius)
        path = self._planner.path((self._base.pose.x, self._base.pose.y), goal, reach)
        if path is None:
            journey.end(f"there is no free way to {said(journey.name)}")
        else:
            journey.path, journey.at, journey.driven = path, 0, False

    def _goal(self, journey: Journey) -> tuple[Point, float]:
        name = journey.name
        if journey.pose is not None:
            return (journey.pose.x, journey.pose.y), 0.0
        if name in self._places:
            return (self._places[name].x, self._places[name].y), 0.0
        thing = self._obstacles.things[name]
        return (thing.x, thing.y), stand_off(self._body, thing, name in self._people)

    def _follow(self, journey: Journey) -> None:
        pose, path = self._base.pose, journey.path
        last = len(path) - 1
        while journey.at < last and pose.distance_to(path[journey.at]) < _LOOK_AHEAD:
            journey.at += 1
        left = pose.distance_to(path[-1])
        if journey.driven or (journey.at == last and left < _NEAR):
            journey.driven = True
            self._face(journey)
            return
        error = pose.bearing_to(path[journey.at])
        if journey.at == last and left < 2 * _NEAR and abs(error) > 90.0:
            journey.driven = True  # just past the goal: good enough, turning back would look silly
        driving = self._body.driving
        speed = min(driving.speed, sqrt(2 * driving.slowing * left), 3.0 * left)
        speed *= max(0.0, cos(radians(min(90.0, 2 * error))))
        speed = 0.0 if abs(error) > 45.0 else speed
        self._base.drive(speed, turn_rate(error, self._body.turning))

    def _face(self, journey: Journey) -> None:
        pose = self._base.pose
        if journey.pose is not None:
            error = wrap(journey.pose.heading - pose.heading)
        elif journey.name in self._places:
            facing = self._places[journey.name].facing
            error = 0.0 if facing is None else wrap(facing - pose.heading)
        else:
            thing = self._obstacles.things[journey.name]
            error = pose.bearing_to((thing.x, thing.y))
        if abs(error) <= _FACING:
            journey.end(None)
        else:
            self._base.drive(0.0, turn_rate(error, self._body.turning))


def turn_rate(error: float, turning: Limits) -> float:
    """Degrees a second that close an error of heading fast without overshooting."""
    rate = min(turning.speed, sqrt(2 * turning.slowing * abs(error)), 4.0 * abs(error))
    return rate if error > 0 else -rate


def stand_off(body: Body, thing: Thing, is_person: bool) -> float:
    """Metres from an object or a person at which a robot that goes there stops. Raises RobotError."""
    if body.navigation is None:
        raise RobotError("the robot finds no ways")
    near = body.navigation.people if is_person else body.navigation.objects
    return max(near, thing.radius + body.radius + ROOM)
