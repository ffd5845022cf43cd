"""Navigation: plans a path to something that has a name, or to a pose, follows it, and faces what it went for."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import cos, dist, radians, sqrt

from btlang.interrupts import interrupts_later
from btlang.robots.body import Body, Limits
from btlang.robots.faults import Faults
from btlang.robots.geometry import Point, Pose, wrap
from btlang.robots.obstacles import Obstacles
from btlang.robots.parts import BasePart
from btlang.robots.robot import RobotError
from btlang.robots.world import Place, Thing, World, said

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.planning import Planner

ROOM = 0.15
"""Metres between the robot and an object or a person that it goes to, at least."""

_LOOK_AHEAD = 0.25
_NEAR, _FACING = 0.03, 1.0


class NavigationGoal:
    """One way to one goal; see `btlang.robots.robot.Operation`.

    `name` is that of what it goes to, or shows the spot; with a `pose` it ends there, facing as the pose does.
    """

    def __init__(self, name: str, base: BasePart, pose: Pose | None = None) -> None:
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
        self.end("navigation was cancelled")

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
    """Drives the base along the goal under way."""

    def __init__(self, world: World, base: BasePart, obstacles: Obstacles, faults: Faults) -> None:
        self._places: dict[str, Place] = {place.name: place for place in world.places}
        self._people = set(world.names.people)
        self._base = base
        self._body = base.body
        self._obstacles = obstacles
        self._faults = faults
        self._world = world
        self._planner: Planner | None = None
        self.goal: NavigationGoal | None = None

    @property
    def way(self) -> list[Point]:
        """The points of the way of the goal under way; none where there is no goal."""
        return [] if self.goal is None or self.goal.done else self.goal.path

    def name_places(self, places: Iterable[Place]) -> None:
        """These are the named places from now on."""
        self._places = {place.name: place for place in places}

    def start(self, name: str, pose: Pose | None = None) -> NavigationGoal:
        """Sets out at once; a goal under way is given up. Without a pose the name is one of the world's."""
        self.cancel(f"the robot set out for {said(name)} instead")
        self.goal = NavigationGoal(name, self._base, pose)
        self._check(self.goal)
        return self.goal

    def cancel(self, reason: str) -> None:
        """Ends the goal under way, if there is one."""
        if self.goal is not None:
            self.goal.end(reason)

    def control(self) -> NavigationGoal | None:
        """Commands the base for the next moment; returns the goal when it ends with this call."""
        goal = self.goal
        if goal is None:
            return None
        if not goal.done:
            self._check(goal)
        if not goal.done:
            self._follow(goal)
        if goal.done:
            self.goal = None
            return goal
        return None

    def _check(self, goal: NavigationGoal) -> None:
        """Ends a goal that cannot go on; plans anew when something has moved."""
        name = goal.name
        if (silent := self._base.silent) is not None:
            goal.end(silent)
        elif self._base.bumps > goal.bumps:
            goal.end(f"bumped into {self._base.bumped_into} on the way to {said(name)}")
        elif self._base.stuck:
            goal.end(f"stuck on the way to {said(name)}: the wheels turn but the robot doesn't move")
        elif self._faults.blocked(name):
            goal.end(f"there is no free way to {said(name)}")
        elif goal.version != self._obstacles.version:
            self._plan(goal)

    def _plan(self, goal: NavigationGoal) -> None:
        goal.version = self._obstacles.version
        target, reach = self._target(goal)
        if self._planner is None:
            with interrupts_later():  # numpy, which takes longer to import than many missions
                from btlang.robots.planning import Planner

            self._planner = Planner(self._world, self._obstacles, self._body.radius)
        path = self._planner.path((self._base.pose.x, self._base.pose.y), target, reach)
        if path is None:
            goal.end(f"there is no free way to {said(goal.name)}")
        else:
            goal.path, goal.at, goal.driven = path, 0, False

    def _target(self, goal: NavigationGoal) -> tuple[Point, float]:
        name = goal.name
        if goal.pose is not None:
            return (goal.pose.x, goal.pose.y), 0.0
        if name in self._places:
            return (self._places[name].x, self._places[name].y), 0.0
        thing = self._obstacles.things[name]
        return (thing.x, thing.y), stand_off(self._body, thing, name in self._people)

    def _follow(self, goal: NavigationGoal) -> None:
        pose, path = self._base.pose, goal.path
        last = len(path) - 1
        while goal.at < last and pose.distance_to(path[goal.at]) < _LOOK_AHEAD:
            goal.at += 1
        left = pose.distance_to(path[-1])
        if goal.driven or (goal.at == last and left < _NEAR):
            goal.driven = True
            self._face(goal)
            return
        error = pose.bearing_to(path[goal.at])
        if goal.at == last and left < 2 * _NEAR and abs(error) > 90.0:
            goal.driven = True  # just past the goal: good enough, turning back would look silly
        driving = self._body.driving
        speed = min(driving.speed, sqrt(2 * driving.slowing * left), 3.0 * left)
        speed *= max(0.0, cos(radians(min(90.0, 2 * error))))
        speed = 0.0 if abs(error) > 45.0 else speed
        self._base.drive(speed, turn_rate(error, self._body.turning))

    def _face(self, goal: NavigationGoal) -> None:
        pose = self._base.pose
        if goal.pose is not None:
            error = wrap(goal.pose.heading - pose.heading)
        elif goal.name in self._places:
            facing = self._places[goal.name].facing
            error = 0.0 if facing is None else wrap(facing - pose.heading)
        else:
            thing = self._obstacles.things[goal.name]
            error = pose.bearing_to((thing.x, thing.y))
        if abs(error) <= _FACING:
            goal.end(None)
        else:
            self._base.drive(0.0, turn_rate(error, self._body.turning))


def turn_rate(error: float, turning: Limits) -> float:
    """Degrees a second that close an error of heading fast without overshooting."""
    rate = min(turning.speed, sqrt(2 * turning.slowing * abs(error)), 4.0 * abs(error))
    return rate if error > 0 else -rate


def stand_off(body: Body, thing: Thing, is_person: bool) -> float:
    """Metres from an object or a person at which a robot that goes there stops. Raises RobotError."""
    if body.navigation is None:
        raise RobotError("the robot can't navigate")
    near = body.navigation.people if is_person else body.navigation.objects
    return max(near, thing.radius + body.radius + ROOM)
