"""One person who walks: where to, and how to keep clear of others on the way."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import cos, hypot, radians, sin
from random import Random

from btlang.robots.geometry import Point
from btlang.robots.worlds.world import Person, Stop
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Protocol

    class Ways(Protocol):
        """The ways through a world; see btlang.robots.worlds.planning.Walkways."""

        def path(self, start: Point, goal: Point) -> list[Point]: ...
        def is_clear(self, a: Point, b: Point) -> bool: ...
        def near(self, point: Point, random: Random, within: float, good: Callable[[Point], bool]) -> Point | None: ...


PERIOD = 0.1
"""Seconds between two looks around."""

_FASTEST = 3.5  # metres a second at which anybody might come nearer
_ROOM = 0.12  # metres between two bodies that pass
_HORIZON = 1.2  # seconds that are looked ahead
_LOOK = 3.0  # metres: who is farther away doesn't matter yet
_CLOSE = 0.12  # metres from a stop that count as there
_TURNS = tuple((cos(radians(turn)), sin(radians(turn))) for turn in (0, -25, 25, -50, 50, -80, 80))
_PATIENCE = (0.8, 3.0)  # seconds, by chance
_ASIDE = (1.0, 4.0)  # seconds somebody stands aside
_STEP_ASIDE = 0.7  # metres at least
_BEHIND = (0.9, 1.4)  # metres from the robot: follows, and stands, who follows it
_LOST = 5.0  # metres from the robot at which somebody who follows gives up
_FOUND = 2.5
_DISTRACTED = 0.08  # chance a second of who doesn't follow at all well
_TRAIL = 0.4  # metres between two points of it
_LONGEST_TRAIL = 12
_LONGEST_WAY = 60  # points of the way of who is followed


class OtherBody(Record):
    """A body to keep clear of: metres, and metres a second."""

    x: float
    y: float
    vx: float
    vy: float
    radius: float


class Walker:
    """A person who walks: where they are and what they do now. `follows` is whether they follow the robot."""

    def __init__(self, person: Person, places: Sequence[Point]) -> None:
        self.person = person
        self.x, self.y, self.radius = person.x, person.y, person.radius
        self.vx = self.vy = 0.0
        self.present = self.gone = self.leaving = self.follows = False
        self._places = places
        self._route: tuple[Stop, ...] = person.walks
        self._wanders = person.wanders
        self._at = 0  # of the route
        self._goal: Point | None = None
        self._stays = 0.0
        self._path: list[Point] = []
        self._corner = 0
        self._astray = False  # evading may have led where the next corner can't be walked to
        self._until = 0.0  # stands until then
        self._aside: Point | None = None
        self._waited, self._patience = 0.0, _PATIENCE[0]
        self._free = 0.0  # metres to the nearest other body, at least
        self._trail: list[Point] = []
        self._crumbs: list[Point] = []  # the way of the robot that is followed

    @property
    def point(self) -> Point:
        """Where they are, in metres."""
        return self.x, self.y

    @property
    def velocity(self) -> float:
        """The metres a second."""
        return hypot(self.vx, self.vy)

    @property
    def body(self) -> OtherBody:
        """The body that others have to keep clear of."""
        return OtherBody(self.x, self.y, self.vx, self.vy, self.radius)

    @property
    def near_someone(self) -> bool:
        """Whether somebody may be so near that they look before each step."""
        return self._free <= (self.velocity + _FASTEST) * PERIOD

    @property
    def has_left(self) -> bool:
        """Whether they have come back to where they began, and wanted to."""
        return self.leaving and self._goal is None

    def leave(self) -> None:
        """Walk back to where they began."""
        self.go((self.person.x, self.person.y))
        self.leaving = True

    def go(self, goal: Point) -> None:
        """Walk there, and stay."""
        self._route, self._wanders, self.follows, self.leaving = (), False, False, False
        self._set_goal(goal, 0.0)

    def put(self, x: float, y: float) -> None:
        """Put them somewhere at once."""
        self.x, self.y, self.vx, self.vy = x, y, 0.0, 0.0
        self._path, self._trail, self._aside = [], [], None

    def move(self, dt: float, others: Iterable[OtherBody]) -> None:
        """Walk on for some seconds, but not into anybody."""
        if self.vx == self.vy == 0.0:
            return
        self._free -= (self.velocity + _FASTEST) * dt
        x, y = self.x + self.vx * dt, self.y + self.vy * dt
        if self._free <= 0.0 and any(self._runs_into(other, x, y) for other in others):
            self.vx = self.vy = 0.0
            return
        self.x, self.y = x, y
        if not self._trail or hypot(x - self._trail[-1][0], y - self._trail[-1][1]) > _TRAIL:
            self._trail = [*self._trail[-_LONGEST_TRAIL:], (x, y)]

    def _runs_into(self, other: OtherBody, x: float, y: float) -> bool:
        before = hypot(other.x - self.x, other.y - self.y)
        after = hypot(other.x - x, other.y - y)
        return after < before and after < self.radius + other.radius + _ROOM / 4

    def look(self, now: float, ways: Ways, robot: OtherBody, others: Sequence[OtherBody], random: Random) -> None:
        """Decide how to walk on until the next look. `others` are those nearby, without the robot."""
        target = self._target(now, ways, robot, random)
        bodies = [body for body in (*others, robot) if abs(body.x - self.x) < _LOOK and abs(body.y - self.y) < _LOOK]
        self._free = min((hypot(b.x - self.x, b.y - self.y) - b.radius for b in bodies), default=_LOOK) - self.radius
        if target is None:
            self.vx = self.vy = 0.0
            return
        dx, dy = target[0] - self.x, target[1] - self.y
        distance = hypot(dx, dy)
        if distance < 1e-6:
            return
        pace = min(self.person.speed, 2.0 * distance, distance / PERIOD) / distance
        for turned, (c, s) in enumerate(_TURNS):
            vx, vy = (dx * c - dy * s) * pace, (dx * s + dy * c) * pace
            if all(self._passes(vx, vy, body) for body in bodies):
                ahead = self.x + 0.5 * vx, self.y + 0.5 * vy
                if turned and not ways.is_clear(self.point, ahead):
                    continue
                self.vx, self.vy = vx, vy
                self._waited = max(0.0, self._waited - PERIOD / 4) if turned else 0.0
                self._astray = self._astray or turned > 0
                return
        self.vx = self.vy = 0.0
        self._waited += PERIOD
        if self._waited > self._patience:
            self._give_way(ways, bodies, random)

    def _passes(self, vx: float, vy: float, body: OtherBody) -> bool:
        """Return whether there is no contact within the horizon, if both go on like this."""
        px, py = body.x - self.x, body.y - self.y
        wx, wy = body.vx - vx, body.vy - vy
        approach = px * wx + py * wy
        if approach >= 0.0:
            return True  # they don't come nearer
        room = self.radius + body.radius + _ROOM
        if px * px + py * py < room * room:
            return False
        t = min(_HORIZON, -approach / (wx * wx + wy * wy))
        nearest2 = (px + wx * t) ** 2 + (py + wy * t) ** 2
        return nearest2 >= room * room

    def _give_way(self, ways: Ways, bodies: Sequence[OtherBody], random: Random) -> None:
        """Step aside, or back to the start, so that somebody else can go on."""
        self._waited, self._patience = 0.0, random.uniform(*_PATIENCE)

        if self._aside is not None and random.random() < 0.5:
            self._aside = None  # that way is barred, too
            return

        def good(point: Point) -> bool:
            apart = all(hypot(b.x - point[0], b.y - point[1]) > b.radius + self.radius + 0.5 for b in bodies)
            return apart and hypot(self.x - point[0], self.y - point[1]) > _STEP_ASIDE

        beside = ways.near(self.point, random, 2.0, good)
        back = [point for point in self._trail if good(point) and ways.is_clear(self.point, point)]
        aside = random.choice(back) if back and (beside is None or random.random() < 0.4) else beside
        if aside is not None:
            self._aside, self._path = aside, []

    def _target(self, now: float, ways: Ways, robot: OtherBody, random: Random) -> Point | None:
        """Return the point to walk to next."""
        if now < self._until and not (self.follows and hypot(robot.x - self.x, robot.y - self.y) < _BEHIND[0]):
            return None
        if self._aside is not None:
            if hypot(self._aside[0] - self.x, self._aside[1] - self.y) > 2 * _CLOSE:
                return self._aside
            self._aside, self._path, self._until = None, [], now + random.uniform(*_ASIDE)
            return None
        if self.follows:
            return self._behind(now, ways, robot, random)
        if self._goal is None and not self._choose(now, random):
            return None
        goal = self._goal
        assert goal is not None
        if hypot(goal[0] - self.x, goal[1] - self.y) <= _CLOSE:
            self._goal, self._path, self._until = None, [], now + self._stays
            return None
        corner = self._along(ways, goal)
        if corner is None:
            self._until = now + random.uniform(*_ASIDE)  # no way: a door may open
        return corner

    def _choose(self, now: float, random: Random) -> bool:
        """Set the next goal; return whether there is one."""
        if self._wanders and self._places:
            self._set_goal(random.choice(self._places), random.uniform(2.0, 10.0))
            return True
        if self._at >= len(self._route):
            if not (self.person.again and self._route):
                return False
            self._at = 0
        stop = self._route[self._at]
        if now < stop.at:
            return False
        self._at += 1
        self._set_goal((stop.x, stop.y), stop.stays)
        return True

    def _set_goal(self, goal: Point, stays: float) -> None:
        self._goal, self._stays, self._path, self._until = goal, stays, [], 0.0

    def _along(self, ways: Ways, goal: Point) -> Point | None:
        if self._path and self._astray:
            corner = self._path[min(self._corner, len(self._path) - 1)]
            self._path = self._path if ways.is_clear(self.point, corner) else []
        if not self._path:
            self._path, self._corner = ways.path(self.point, goal), 1
        if not self._path:
            return None
        self._astray = False
        while self._corner < len(self._path) - 1:
            x, y = self._path[self._corner]
            if hypot(x - self.x, y - self.y) > 2 * _CLOSE:
                break
            self._corner += 1
        return self._path[min(self._corner, len(self._path) - 1)]

    def _behind(self, now: float, ways: Ways, robot: OtherBody, random: Random) -> Point | None:
        """Follow the robot at some distance. Somebody who is distracted stands, and somebody who has lost it waits for
        it.
        """
        distance = hypot(robot.x - self.x, robot.y - self.y)
        if random.random() < _DISTRACTED * PERIOD * (1.0 - self.person.follows):
            self._until = now + random.uniform(4.0, 10.0)
            return None
        here = robot.x, robot.y
        if not self._crumbs or hypot(here[0] - self._crumbs[-1][0], here[1] - self._crumbs[-1][1]) > _TRAIL:
            self._crumbs = [*self._crumbs[-_LONGEST_WAY:], here]
        if distance < _BEHIND[1 if self.velocity == 0.0 else 0]:
            return None
        if distance > _LOST and self._waited == 0.0 and self.person.follows < 1.0:
            self._until = now + 1.0  # until the robot comes back
            return None
        for at in range(len(self._crumbs) - 1, -1, -1):  # in its steps, as far as they are in view
            x, y = self._crumbs[at]
            if hypot(x - self.x, y - self.y) < _TRAIL:
                break
            if ways.is_clear(self.point, (x, y)):
                self._crumbs = self._crumbs[at:]
                return x, y
        self._crumbs = [here]  # older ones would lead back
        if self._path and hypot(here[0] - self._path[-1][0], here[1] - self._path[-1][1]) > _TRAIL:
            self._path = []
        return self._along(ways, here)
