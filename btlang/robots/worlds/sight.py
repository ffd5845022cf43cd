"""What a robot sees: what its sensors have in view, and where it last saw what moves or isn't known."""

from __future__ import annotations

from collections.abc import Callable

from btlang.robots.bodies.body import Body, Sensor
from btlang.robots.geometry import Point, Pose, wrap
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import World, said

_PERIOD = 0.1  # seconds between two looks
_FRESH = 2.0  # seconds for which somebody seen counts as still there


class Sight:
    """The things in view, and what the robot knows of the positions of people and objects.

    `find` returns the point of a name if the robot at a pose has it in view, else None; `report` gets the name of what
    is seen for the first time; `covers` returns whether a point is in view, where that is known.
    """

    def __init__(
        self,
        world: World,
        obstacles: Obstacles,
        find: Callable[[str, Pose], Point | None],
        report: Callable[[str], object],
        covers: Callable[[Point, Pose], bool] = lambda point, pose: False,
    ) -> None:
        self._obstacles, self._find, self._report, self._covers = obstacles, find, report, covers
        self._kinds = {name: kind for kind in ("object", "person") for name in world.names.of(kind)}
        self.watched = {thing.name: None for thing in (*world.objects, *world.people) if not thing.known}
        """Names that the robot knows only from where it has seen them, in the order in which that began."""
        self._last: dict[str, tuple[Point, float]] = {}
        self._met: set[str] = set()
        self._gone: set[str] = set()
        self._now = self._next = 0.0
        for person in world.people:
            if person.moves:
                self.watched[person.name] = None
                if person.known and not person.comes_later:
                    self._last[person.name] = (person.x, person.y), -_FRESH

    def watch(self, name: str, kind: str) -> None:
        """Know its position only from sightings from now on: it begins to walk, or comes unexpected."""
        if name not in self.watched:
            self.watched[name] = None
            if name in self._kinds and (point := self._obstacles.point(name)) is not None:
                self._last[name] = point, self._now
                self._gone.discard(name)
        self._kinds[name] = kind

    def forget(self) -> None:
        """Forget where walking people and unknown things were seen."""
        self._last.clear()
        self._gone.clear()

    def look(self, now: float, pose: Pose) -> None:
        """Note where everything is that can be seen at second `now`."""
        self._now = now
        if not self.watched or now + 1e-9 < self._next:
            return
        self._next = now + _PERIOD
        for name in self.watched:
            if self._look_for(name, pose) is None and name in self._last and name not in self._gone:
                if self._covers(self._last[name][0], pose):
                    self._gone.add(name)

    def is_gone(self, name: str) -> bool:
        """Return whether the robot has looked where it saw something last, and it wasn't there."""
        return name in self._gone

    def where(self, name: str) -> Point | None:
        """Return where it is as far as the robot knows; None if it hasn't been seen or is carried."""
        if name not in self.watched:
            return self._obstacles.point(name)
        if self._obstacles.is_carried(name) or name not in self._last:
            return None
        return self._last[name][0]

    def sees(self, name: str, pose: Pose) -> bool:
        """Return whether it is in view at this moment."""
        return self._look_for(name, pose) is not None

    def is_fresh(self, name: str) -> bool:
        """Return whether its position is known as of now, or nearly so."""
        return name not in self.watched or (name in self._last and self._now - self._last[name][1] <= _FRESH)

    def lost(self, name: str) -> str | None:
        """Return why somebody who arrives at the last position doesn't find it; None if the position is fresh."""
        if self.is_fresh(name):
            return None
        is_person = self._kinds.get(name) == "person"
        return f"I've lost sight of {said(name)}" if is_person else f"{said(name)} is no longer where I saw it"

    def is_seen(self, name: str) -> bool:
        """Return whether a watched thing was in view at the last look."""
        return name in self._last and self._now - self._last[name][1] < _PERIOD

    def seen(self, kind: str, pose: Pose) -> list[str]:
        """Return the names of a type that are in view, nearest first."""
        return list(self.in_view(kind, pose))

    def in_view(self, kind: str, pose: Pose) -> dict[str, Point]:
        """Return the positions of those of a type that are in view, nearest first."""
        found = []
        for name, of in self._kinds.items():
            if of == kind and (point := self._look_for(name, pose)) is not None:
                found.append((pose.distance_to(point), name, point))
        return {name: point for _, name, point in sorted(found)}

    def names(self, kind: str) -> list[str]:
        """Return all names of a type that were given, or that came unexpected."""
        return [name for name, of in self._kinds.items() if of == kind]

    def _look_for(self, name: str, pose: Pose) -> Point | None:
        """Return where it is if it is in view, and note it: what is seen between two looks is known, too."""
        point = self._find(name, pose)
        if point is not None and name in self.watched:
            self._last[name] = point, self._now
            self._gone.discard(name)
            if name not in self._met:
                self._met.add(name)
                self._report(name)
        return point


class View:
    """The sensors of a body that recognise people and objects. Walls and closed doors hide what is behind them.

    `joint` returns the angle of a joint of the robot, in degrees.
    """

    def __init__(self, obstacles: Obstacles, body: Body, joint: Callable[[str], float]) -> None:
        self._sensors = [sensor for sensor in body.sensors if sensor.recognizes]
        self._obstacles, self._joint = obstacles, joint

    def point(self, name: str, pose: Pose) -> Point | None:
        """Return the position of something in view of a robot at this pose; None if it isn't in view."""
        point = self._obstacles.point(name)
        return point if point is not None and self.covers(point, pose) else None

    def covers(self, point: Point, pose: Pose) -> bool:
        """Return whether a point is in view of a robot at a pose."""
        for sensor in self._sensors:
            eye = pose
            if sensor.ahead or sensor.left:
                eye = Pose(*pose.ahead(sensor.ahead, sensor.left), pose.heading)
            if (
                eye.distance_to(point) <= sensor.recognizes
                and self._is_in_angle(sensor, eye.bearing_to(point))
                and not self._obstacles.wall_between((eye.x, eye.y), point)
            ):
                return True
        return False

    def _is_in_angle(self, sensor: Sensor, bearing: float) -> bool:
        if sensor.view >= 360.0:
            return True
        middle = sensor.angle + (self._joint(sensor.joint) if sensor.joint else 0.0)
        return abs(wrap(bearing - middle)) <= sensor.view / 2
