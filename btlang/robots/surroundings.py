"""What is where around a robot, by name, as far as the robot knows; and who lives there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from btlang.robots.body import Body
from btlang.robots.doors import spots_beside
from btlang.robots.ears import Ears
from btlang.robots.geometry import Point, Pose, segment_distance
from btlang.robots.obstacles import Obstacles
from btlang.robots.people import People
from btlang.robots.robot import RobotError
from btlang.robots.sight import Sight
from btlang.robots.view import View
from btlang.robots.world import Door, Place, World, WorldObject, said
from btlang.robots.zones import Zones
from btlang.run.robot_state import Whereabouts

_REACH = 1.2  # metres to a door or a switch
_HAND = 1.5  # metres to somebody who takes something
_SAME_SPOT = 0.01  # metres


class Surroundings:
    """The places, objects and people of a world; names are in any case. Raises RobotError for unknown ones.

    `joint` says where a joint of the robot stands; `emit` hears the events "come", "leave", "hear" and "see".
    """

    def __init__(
        self,
        world: World,
        obstacles: Obstacles,
        body: Body,
        joint: Callable[[str], float],
        emit: Callable[..., object],
    ) -> None:
        self._given, self._world = world, world
        self._obstacles, self._emit = obstacles, emit
        self._radius = body.radius
        self._switched: dict[str, bool] = {}
        self._given_to: dict[str, str] = {}
        self._hears = body.ears.within if body.ears is not None else 0.0
        self._now, self._pose = 0.0, world.start
        self.zones = Zones(world.zones)
        self.ears = Ears()
        view = View(obstacles, body, joint)
        self.sight = Sight(world, obstacles, view.point, lambda name: emit("see", name=name))
        self.people = People(world, obstacles, body.radius, self._happen)
        self.sight.look(0.0, world.start)

    def begin(self, seed: int) -> None:
        """A run begins: zones are as the world says, and chance follows from the seed."""
        self.zones.begin()
        self.people.begin(seed)
        self.ears.asking = self.ears.answer = ""

    def step(self, now: float, dt: float, pose: Pose, velocity: float) -> None:
        """People live on for `dt` seconds until `now`, and the robot looks around."""
        self._now, self._pose = now, pose
        self.people.step(now, dt, pose, velocity)
        self.sight.look(now, pose)

    def known(self, name: str) -> str:
        """The name as the world spells it."""
        names = self._world.names
        for known in (*names.places, *names.objects, *names.people, *self.sight.names("person")):
            if known.lower() == name.lower():
                return known
        raise RobotError(f"I don't know where '{name}' is")

    def is_person(self, name: str) -> bool:
        """Whether it is the name of a person."""
        return name in self.sight.names("person")

    def locate(self, name: str) -> Point | None:
        """Where it is as far as the robot knows; None while the robot carries it."""
        known = self.known(name)
        for place in self._world.places:
            if place.name == known:
                return place.x, place.y
        if known in self._given_to:
            return self.locate(self._given_to[known])
        point = self.sight.where(known)
        if point is None and not self._obstacles.is_carried(known):
            raise RobotError(f"I haven't seen {said(known)}")
        return point

    def goal_at(self, pose: Pose) -> tuple[str, Pose | None]:
        """What a way to a pose is called, and where it ends: None on the spot of an object or a person, to which it
        then is a journey. On the spot of a place it is called by that name, and so knows that its way is blocked.
        """
        for place in self._world.places:
            if pose.distance_to((place.x, place.y)) <= _SAME_SPOT:
                return place.name, pose
        for name in self._obstacles.things:
            point = self.sight.where(name)
            if point is not None and pose.distance_to(point) <= _SAME_SPOT:
                return name, None
        return f"({pose.x:.2f}, {pose.y:.2f})", pose

    def choices(self, kind: str) -> list[str]:
        """The names of a type that the robot knows a place of, but for what it carries."""
        if kind in ("object", "person"):
            things = self._obstacles.things
            names = (name for name in self.sight.names(kind) if self.sight.where(name) is not None)
            return [name for name in names if not getattr(things[name], "fixed", False)]
        return list(self._world.names.of(kind))

    def described(self, kind: str, parts: Mapping[str, str]) -> list[str]:
        """The names of objects or people with these parts that the robot knows a place of, or carries."""
        things, where = self._obstacles.things, self.sight.where
        known = (name for name in self.sight.names(kind) if where(name) or self._obstacles.is_carried(name))
        return [name for name in known if name in things and things[name].fits(parts)]

    def nearby_people(self, within: float, pose: Pose) -> list[str]:
        """The names of the people within so many metres, nearest first: those who walk as far as they are in view."""
        found = []
        for name in self.sight.names("person"):
            point = self.sight.where(name)
            if point is not None and self.sight.is_fresh(name) and pose.distance_to(point) <= within:
                found.append((pose.distance_to(point), name))
        return [name for _, name in sorted(found)]

    def name_places(self, places: Iterable[Place]) -> World:
        """The world with these places, in place of those of the mission before."""
        self._world = self._given.with_places(places)
        return self._world

    def move(self, name: str, x: float, y: float) -> None:
        """Puts an object or a person somewhere else."""
        known = self.known(name)
        if known not in self._obstacles.things or self._obstacles.is_carried(known):
            raise RobotError(f"{said(known)} can't be moved")
        if self.people.walks(known):
            self.people.put(known, x, y)
        else:
            self._obstacles.move(known, x, y)

    def check_taker(self, object: str, person: str, pose: Pose) -> None:
        """Raises RobotError where a person is too far away to take an object, or doesn't want it."""
        known = self.known(person)
        point = self._obstacles.point(known)
        if not self.is_person(known) or point is None:
            raise RobotError(f"{said(known)} isn't here")
        if (distance := pose.distance_to(point)) > _HAND:
            raise RobotError(f"{said(known)} is {distance:.1f} m away")
        if object.lower() in map(str.lower, self.people.refused_by(known)):
            raise RobotError(f"{said(known)} doesn't want {said(object)}")

    def give(self, object: str, person: str) -> None:
        """A person has an object from now on."""
        self._given_to[object] = self.known(person)

    def check_free(self, name: str) -> None:
        """Raises RobotError for what somebody was given."""
        if name in self._given_to:
            raise RobotError(f"{said(self._given_to[name])} has {said(name)}")

    def check_movable(self, name: str) -> None:
        """Raises RobotError for an object that can't be picked up, or that the robot hasn't seen."""
        known = self.known(name)
        self.check_free(known)
        self.locate(known)
        thing = self._obstacles.things.get(known)
        if isinstance(thing, WorldObject) and thing.fixed:
            raise RobotError(f"{said(known)} is fixed")

    def beside_door(self, name: str, pose: Pose) -> list[Pose]:
        """Where a robot can stand to move a door: before and behind it, facing it; the nearer one first."""
        return spots_beside(self._door(name), pose)

    def move_door(self, name: str, is_open: bool, pose: Pose) -> None:
        """Opens or closes a door. Raises RobotError where it is out of reach, or something is in it."""
        door = self._door(name)
        if (distance := pose.distance_to(door.middle)) > _REACH:
            raise RobotError(f"{said(door.name)} is {distance:.1f} m away")
        bodies = [(pose.x, pose.y, self._radius), *self._obstacles.discs, *self._obstacles.walking.values()]
        if not is_open and any(segment_distance((x, y), (*door.start, *door.end)) < r for x, y, r in bodies):
            raise RobotError(f"something is in {said(door.name)}")
        if door.open != is_open:
            self.swing(name, is_open)

    def swing(self, name: str, is_open: bool) -> None:
        """A door is open or closed from now on. Raises RobotError for an unknown one."""
        door = self._door(name)
        self._obstacles.swing(door.name, is_open)
        self._emit("door", name=door.name, open=is_open)

    def is_open(self, name: str) -> bool:
        """Whether a door is open. Raises RobotError for an unknown one."""
        return self._door(name).open

    def _door(self, name: str) -> Door:
        for door in self._obstacles.doors.values():
            if door.name.lower() == name.lower():
                return door
        raise RobotError(f"there's no door called '{name}'")

    def switch(self, name: str, on: bool | None, pose: Pose) -> None:
        """Switches an object on or off. Raises RobotError where it can't be, or is out of reach."""
        known = self.known(name)
        point = self.locate(known)
        before = self.is_on(known)
        if point is not None and pose.distance_to(point) > _REACH:
            raise RobotError(f"{said(known)} is {pose.distance_to(point):.1f} m away")
        self._switched[known] = (not before) if on is None else on
        self._emit("switch", name=known, on=self._switched[known])

    def is_on(self, name: str) -> bool:
        """Whether an object is switched on. Raises RobotError for one that can't be switched."""
        known = self.known(name)
        thing = self._obstacles.things.get(known)
        if not isinstance(thing, WorldObject) or not thing.switch:
            raise RobotError(f"{said(known)} can't be switched on or off")
        return self._switched.get(known, thing.switch == "on")

    def whereabouts(self) -> tuple[Whereabouts, ...]:
        """Where those really are who walk and what isn't known, to the centimetre, and whether the robot sees them."""
        found: list[Whereabouts] = []
        for name in self.sight.watched:
            point = self._obstacles.point(name)
            x, y = (None, None) if point is None else (round(point[0], 2), round(point[1], 2))
            found.append((name, x, y, self.sight.is_seen(name)))
        return tuple(found)

    def hear(self, text: str, who: str = "") -> None:
        """The robot hears what somebody says, or types."""
        self.ears.hear(text, who, self._now)
        self._emit("hear", text=text, who=who)

    def ask(self, question: str, person: str = "") -> None:
        """The robot has asked a person, or anybody; people of the world may answer."""
        self.people.ask(question, person, (self._pose.x, self._pose.y), self._now)

    def _happen(self, kind: str, name: str, text: str) -> None:
        if kind == "speak":
            point = self._obstacles.point(name)
            if point is not None and self._pose.distance_to(point) <= self._hears:
                self.hear(text, name)
            return
        if kind in ("come", "walk"):
            self.sight.watch(name, "person")
        if kind != "walk":
            self._emit(kind, name=name)
