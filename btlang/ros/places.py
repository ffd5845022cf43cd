"""What a ROS 2 robot knows of its surroundings: the names of the world file and the mission, and where they are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from math import radians

from btlang.robots.body import Body
from btlang.robots.choices import PICKY, Choices
from btlang.robots.geometry import Point, Pose
from btlang.robots.navigation import stand_off
from btlang.robots.obstacles import Obstacles
from btlang.robots.planning import Planner
from btlang.robots.robot import Hand, OnEvent, RobotError
from btlang.robots.world import Place, World


class Places:
    """Metres on the map, which is that of the world file. Objects move when the robot carries them."""

    def __init__(self, world: World, body: Body) -> None:
        self._body = body
        self.world = self._given_world = world
        self._obstacles = Obstacles(world)
        self._planner: Planner | None = None

    def name_places(self, places: Iterable[Place]) -> None:
        """The places of a mission beside those of the world, in place of those of the mission before."""
        self.world = self._given_world.with_places(places)

    def known(self, name: str) -> str:
        """The name as the world spells it. Raises RobotError for an unknown one."""
        names = self.world.names
        for known in (*names.places, *names.objects, *names.people):
            if known.lower() == name.lower():
                return known
        raise RobotError(f"I don't know where '{name}' is")

    def free(self, kind: str) -> list[str]:
        """The names of a type, without objects that the robot carries."""
        return [name for name in self.world.names.of(kind) if not self._obstacles.is_carried(name)]

    def described(self, kind: str, parts: Mapping[str, str], robot: Pose) -> list[str]:
        """The names of objects or people with these parts, nearest first."""
        things = self._obstacles.things
        names = (name for name in self.world.names.of(kind) if name in things and things[name].fits(parts))
        return sorted(names, key=lambda name: robot.distance_to(self.locate(name, robot)))

    def choose(
        self,
        kind: str,
        how: str,
        parts: Mapping[str, str],
        where: Callable[[], Pose],
        choices: Choices,
        tell: OnEvent | None,
    ) -> str:
        """One of the names of a type. Raises RobotError where there is none with these parts."""
        robot = where() if how in ("nearest", "seen") else Pose(0.0, 0.0, 0.0)
        names = self.described(kind, parts, robot) if parts or how in PICKY else self.free(kind)
        things = self._obstacles.things
        return choices.choose(
            kind, how, names, parts, tell,
            lambda name: robot.distance_to(self.locate(name, robot)), lambda name: getattr(things[name], "size", 0.0),
        )  # fmt: skip

    def locate(self, name: str, robot: Pose) -> Point:
        """Where it is; what the robot carries is where the robot is. Raises RobotError for an unknown name."""
        known = self.known(name)
        for place in self.world.places:
            if place.name == known:
                return place.x, place.y
        if self._obstacles.is_carried(known):
            return robot.x, robot.y
        thing = self._obstacles.things[known]
        return thing.x, thing.y

    def located(self, name: str) -> tuple[float, float, float | None]:
        """Metres, and the direction to face in radians, None for any. Raises KeyError for an unknown name."""
        try:
            point = self.locate(self.known(name), Pose(0.0, 0.0, 0.0))
        except RobotError:
            raise KeyError(name) from None
        facing = next((place.facing for place in self.world.places if place.name == name), None)
        return *point, None if facing is None else radians(facing)

    @property
    def dock(self) -> Pose | None:
        """That of the world, which faces as the robot does in it."""
        dock = self.world.dock
        return Pose(dock.x, dock.y, dock.facing or 0.0) if dock is not None else None

    def staging(self, robot: Pose) -> Pose:
        """Where the robot has to stand to be connected: the place "dock"; where it is, if there is none."""
        return self.goal("dock", robot) if "dock" in map(str.lower, self.world.names.places) else robot

    def goal(self, name: str, robot: Pose) -> Pose:
        """Where the robot has to stand for it, and which way to face. Raises RobotError for an unknown name.

        Before an object or a person that is where the free way there ends, by the walls and boxes of the world file.
        """
        known = self.known(name)
        point = self.locate(known, robot)
        for place in self.world.places:
            if place.name == known:
                facing = robot.heading + robot.bearing_to(point) if place.facing is None else place.facing
                return Pose(place.x, place.y, facing)
        reach = stand_off(self._body, self._obstacles.things[known], known in self.world.names.people)
        stand = self._stand(robot, point, reach)
        return Pose(*stand, stand_heading(stand, point))

    def picked_up(self, name: str) -> None:
        """The robot carries it from now on."""
        self._obstacles.pick_up(name)

    def put_down(self, name: str, robot: Pose, hand: Hand) -> None:
        """It lies just in front of the robot."""
        part = self._body.hand(hand)
        ahead = (part.puts_at if part is not None else self._body.radius) + self._obstacles.things[name].radius
        self._obstacles.put_down(name, *robot.ahead(ahead))

    def nearby_people(self, within: float, robot: Pose) -> list[str]:
        """Names, nearest first."""
        distances = [(robot.distance_to(self.locate(name, robot)), name) for name in self.world.names.people]
        return [name for distance, name in sorted(distances) if distance <= within]

    def _stand(self, robot: Pose, point: Point, reach: float) -> Point:
        with suppress(RobotError):  # a world too large to plan in
            if self._planner is None:
                self._planner = Planner(self._given_world, self._obstacles, self._body.radius)
            path = self._planner.path((robot.x, robot.y), point, reach)
            if path is not None:
                return path[-1]
        left = robot.distance_to(point)  # no free way on this map: the server of the robot may know better
        share = max(0.0, left - reach) / left if left else 0.0
        return robot.x + share * (point[0] - robot.x), robot.y + share * (point[1] - robot.y)


def stand_heading(stand: Point, point: Point) -> float:
    """Degrees that face a point."""
    return Pose(*stand).bearing_to(point)
