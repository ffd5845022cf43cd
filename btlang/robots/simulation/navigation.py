"""Navigation: plans a path to something that has a name, or to a pose, follows it, and faces what it went for."""

from __future__ import annotations

from itertools import pairwise
from math import cos, dist, inf, radians, sqrt

from btlang.robots.bodies.body import Body, SpeedLimits
from btlang.robots.geometry import Point, Pose, wrap
from btlang.robots.motion.guard.guard import Cause, Guard
from btlang.robots.parts import BasePart
from btlang.robots.robot import RobotError
from btlang.robots.simulation.faults import Faults
from btlang.robots.simulation.surroundings import Surroundings
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import Thing, World, said
from btlang.support.interrupts import interrupts_later

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.worlds.planning import PathPlanner

ROOM = 0.15
"""Metres between the robot and an object or a person that it goes to, at least."""

PATIENCE, GIVES_UP = 8.0, 30.0
"""Seconds that the robot waits for somebody in its way, and that it then looks for another way."""
_AGAIN = 4.0  # seconds between two looks for another way
_NEARBY = 3.0  # metres: who walks farther away may be elsewhere by then
_MOVED, _REPLAN = 0.3, 0.5  # metres that somebody has moved, and seconds between two plans for that
_LOOK_AHEAD = 0.25
_NEAR, _FACING = 0.03, 1.0
_NEARLY_STANDS = 0.1  # metres a second


class NavigationGoal:
    """One way to one goal, as an Operation.

    `name` is that of the target, or shows the spot; with a `pose` it ends there, facing as the pose does.
    """

    def __init__(self, name: str, base: BasePart, pose: Pose | None = None) -> None:
        self.name = name
        self.pose = pose
        self.done = False
        self.failure: str | None = None
        self.path: list[Point] = []
        self.at = 0
        self.planned = (-1, -1)
        self.planned_at = 0.0
        self.target: Point = (base.pose.x, base.pose.y)
        self.reach = 0.0
        self.held_up = ""
        self.waited, self.tries = 0.0, 0
        self.bumps = base.bumps
        self.driven = False
        self._base = base

    def cancel(self) -> None:
        """End the goal and brake. Does nothing when done."""
        self.end("navigation was cancelled")

    @property
    def left(self) -> float:
        """The metres of the path that are left."""
        rest = [(self._base.pose.x, self._base.pose.y), *self.path[self.at :]]
        return sum(dist(a, b) for a, b in pairwise(rest))

    def end(self, failure: str | None) -> None:
        """Come to rest, arrived or with the reason why not."""
        if not self.done:
            self.failure = failure
            self.done = True
            self._base.brake()


class Navigator:
    """The navigation of a base to the current goal.

    `patience` is the seconds it waits for somebody in its way before it looks for another way; without one it gives up
    after GIVES_UP more. `pace` is the share of the normal speed.
    """

    def __init__(
        self,
        world: World,
        base: BasePart,
        obstacles: Obstacles,
        faults: Faults,
        surroundings: Surroundings,
        guard: Guard,
    ) -> None:
        self._base = base
        self._body = base.body
        self._obstacles = obstacles
        self._faults = faults
        self._world = world
        self._surroundings = surroundings
        self._zones = surroundings.zones
        self._guard = guard
        self._planner: PathPlanner | None = None
        self._now = 0.0
        self.patience, self.pace = PATIENCE, 1.0
        self.goal: NavigationGoal | None = None

    @property
    def way(self) -> list[Point]:
        """The points of the way to the current goal; none without a goal."""
        return [] if self.goal is None or self.goal.done else self.goal.path

    def prepare(self) -> PathPlanner:
        """Load the planner, which takes longer than a tick has."""
        with interrupts_later():  # numpy, which takes longer to import than many missions
            from btlang.robots.worlds.planning import PathPlanner

        self._planner = self._planner or PathPlanner(self._world, self._obstacles, self._body.radius, self._zones)
        return self._planner

    def start(self, name: str, pose: Pose | None = None) -> NavigationGoal:
        """Start a goal at once, and cancel the current one. Without a pose the name is one of the world's."""
        self.cancel(f"the robot set out for {said(name)} instead")
        self.goal = NavigationGoal(name, self._base, pose)
        self._check(self.goal)
        return self.goal

    def cancel(self, reason: str) -> None:
        """Cancel the current goal, if there is one."""
        if self.goal is not None:
            self.goal.end(reason)

    def protect(self) -> None:
        """Limit the base to safe speeds, whoever drives it."""
        wanted = self._base.commanded
        verdict = self._guard.judge(*wanted, may_touch=self.goal is None)
        most = abs(verdict.linear) if verdict.linear != wanted[0] else inf
        self._base.limits = most, abs(verdict.angular) if verdict.angular != wanted[1] else inf

    def control(self, now: float) -> NavigationGoal | None:
        """Command the base for the next moment; return the goal when it ends with this call."""
        waited, self._now = now - self._now, now
        goal = self.goal
        if goal is None:
            return None
        if not goal.done:
            self._check(goal)
        if not goal.done:
            self._follow(goal)
            self._wait(goal, waited)
        if goal.done:
            self.goal = None
            return goal
        return None

    @property
    def held_up(self) -> str:
        """The person in the way, "" if nobody makes the robot wait."""
        return self.goal.held_up if self.goal is not None and not self.goal.done else ""

    def _wait(self, goal: NavigationGoal, seconds: float) -> None:
        """Count how long somebody makes the robot wait, and react to it."""
        verdict = self._guard.verdict
        nearly_stands = self._base.commanded[0] and not goal.driven and abs(verdict.linear) < _NEARLY_STANDS
        goal.held_up = verdict.who if nearly_stands and verdict.cause is Cause.PERSON else ""
        if nearly_stands and verdict.cause is Cause.ZONE and abs(self._base.commanded[0]) > 0.05:
            goal.waited += seconds
            if goal.waited > GIVES_UP:
                goal.end(f"the {verdict.who} is in the way to {said(goal.name)}")
            return
        goal.waited = goal.waited + seconds if goal.held_up else max(0.0, goal.waited - seconds)
        if goal.waited > self.patience + goal.tries * _AGAIN and goal.held_up:
            goal.tries += 1
            if not self._plan(goal, around=True) and goal.waited > self.patience + GIVES_UP:
                goal.end(f"{said(goal.held_up)} is in the way to {said(goal.name)}")

    def _check(self, goal: NavigationGoal) -> None:
        """End a goal that can't go on; plan again if something has moved."""
        name = goal.name
        if (silent := self._base.silent) is not None:
            goal.end(silent)
        elif self._base.bumps > goal.bumps:
            goal.end(f"bumped into {self._base.bumped_into} on the way to {said(name)}")
        elif self._base.stuck or self._guard.stuck:
            goal.end(f"stuck on the way to {said(name)}: the wheels turn but the robot doesn't move")
        elif self._guard.held and self._guard.verdict.cause not in (Cause.PERSON, Cause.ZONE):
            goal.end(f"stopped on the way to {said(name)}: {self._guard.held}")
        elif self._faults.is_blocked(name):
            goal.end(f"there is no free way to {said(name)}")
        elif (target := self._target(goal)) is None:
            goal.end(f"I haven't seen {said(name)}")
        elif not goal.reach and (refusal := self._zones.refusal(name, target)) is not None:
            goal.end(refusal)
        elif goal.planned != (self._obstacles.layout, self._zones.version) or self._has_moved(goal, target):
            self._plan(goal)

    def _has_moved(self, goal: NavigationGoal, target: Point) -> bool:
        """Return whether the target is elsewhere by now; checked twice a second."""
        return dist(goal.target, target) > _MOVED and self._now - goal.planned_at >= _REPLAN

    def _plan(self, goal: NavigationGoal, around: bool = False) -> bool:
        """Return whether there is a way, `around` also those who walk nearby; without one the
        goal ends, except then.
        """
        target = self._target(goal)
        assert target is not None
        planner = self._planner or self.prepare()
        start = self._base.pose.x, self._base.pose.y
        others = [disc for name, disc in self._obstacles.walking.items() if name != goal.name] if around else []
        near = [disc for disc in others if dist(start, disc[:2]) < _NEARBY]
        path = planner.path(start, target, goal.reach, near)
        goal.planned, goal.planned_at, goal.target = (self._obstacles.layout, self._zones.version), self._now, target
        if path is not None:
            goal.path, goal.at, goal.driven = path, 0, False
        elif not around:
            goal.end(f"there is no free way to {said(goal.name)}")
        return path is not None

    def _target(self, goal: NavigationGoal) -> Point | None:
        """Return where it goes, as far as the robot knows; set how near it has to come."""
        name = goal.name
        if goal.pose is not None:
            return goal.pose.x, goal.pose.y
        place = self._surroundings.place(name)
        if place is not None:
            return place.x, place.y
        if not goal.reach:
            goal.reach = stand_off(self._body, self._obstacles.things[name], self._surroundings.is_person(name))
        return self._surroundings.sight.where(name)

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
        speed = min(driving.speed * self.pace, driving.top_speed, sqrt(2 * driving.slowing * left), 3.0 * left)
        speed *= max(0.0, cos(radians(min(90.0, 2 * error))))
        speed = 0.0 if abs(error) > 45.0 else speed
        self._base.drive(speed, turn_rate(error, self._body.turning))

    def _face(self, goal: NavigationGoal) -> None:
        pose, place = self._base.pose, self._surroundings.place(goal.name)
        if goal.pose is not None:
            error = wrap(goal.pose.heading - pose.heading)
        elif place is not None:
            error = 0.0 if place.facing is None else wrap(place.facing - pose.heading)
        else:
            error = pose.bearing_to(goal.target)
        if abs(error) <= _FACING:
            goal.end(self._surroundings.sight.lost(goal.name) if goal.reach else None)
        else:
            self._base.drive(0.0, turn_rate(error, self._body.turning))


def turn_rate(error: float, turning: SpeedLimits) -> float:
    """Return the degrees a second that close an error of heading fast without overshooting."""
    rate = min(turning.speed, sqrt(2 * turning.slowing * abs(error)), 4.0 * abs(error))
    return rate if error > 0 else -rate


def stand_off(body: Body, thing: Thing, is_person: bool) -> float:
    """Return the metres from an object or a person at which a robot stops. Raises RobotError."""
    if body.navigation is None:
        raise RobotError("the robot can't navigate")
    near = body.navigation.people if is_person else body.navigation.objects
    return max(near, thing.radius + body.radius + ROOM)
