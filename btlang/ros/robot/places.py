"""The places, doors and switches of a ROS 2 robot's world: where they are, and the services that move them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
from math import dist, radians

from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

from btlang.robots.bodies.body import Body
from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import Hand, RobotError, Station
from btlang.robots.simulation.navigation import stand_off
from btlang.robots.worlds.knowledge import Knowledge
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.planning import PathPlanner
from btlang.robots.worlds.sight import Sight
from btlang.robots.worlds.world import OBJECT_RADIUS, PERSON_RADIUS, Person, Thing, World, WorldObject, said
from btlang.ros.graph import graph_names
from btlang.ros.robot.services import ServiceCall, Services
from btlang.ros.subscriptions import SubscriptionCache
from btlang.run.robot_state import Whereabouts

_MOVED = 0.05  # metres that something has to be elsewhere
_MOST_THINGS = 10_000
_DOCK = "dock"


class RosPlaces(Knowledge):
    """The knowledge of a ROS 2 robot about its world, in metres on the map of the world file. Objects move with a robot
    that carries them.

    `notice` takes what is in view: people who walk and unknown things are where they were last seen. `report` gets each
    name when it is first seen.
    """

    def __init__(self, world: World, body: Body, report: Callable[[str], object] = lambda name: None) -> None:
        obstacles = Obstacles(world)
        super().__init__(world, obstacles, Sight(world, obstacles, lambda name, pose: self._in_view.get(name), report))
        self._body = body
        self._in_view: dict[str, Point] = {}
        self._planner: PathPlanner | None = None

    def notice(self, seen: Mapping[str, tuple[str, Point]], now: float, pose: Pose) -> None:
        """Take all that is in view: the kind of each, "person" or "object", and where it is."""
        names = {name.lower(): name for name in self.obstacles.things} if seen else {}
        self._in_view = {}
        for said_name, (kind, point) in seen.items():
            name = names.get(said_name.lower(), said_name)
            if name not in self.obstacles.things:
                if len(self.obstacles.things) >= _MOST_THINGS:
                    continue
                self.obstacles.add(_stranger(name, kind, point))
                self.sight.watch(name, kind)
            self._in_view[name] = point
            stood = self.obstacles.point(name)
            if stood is not None and dist(stood, point) > _MOVED:
                self.obstacles.move(name, *point)
        self.sight.look(now, pose)

    def is_watched(self, name: str) -> bool:
        """Return whether its position is only known from sightings."""
        return name in self.sight.watched

    def whereabouts(self) -> tuple[Whereabouts, ...]:
        """Return where walking people and unknown things were last seen, to the centimetre, and whether they are in
        view.
        """
        return self._watched(self.sight.where, self._in_view.__contains__)

    def located(self, name: str) -> tuple[float, float, float | None]:
        """Return the position in metres and the direction to face in radians, None for any. Raises KeyError for an
        unknown name.
        """
        try:
            known = self.known(name)
            point = self.locate(known, Pose(0.0, 0.0, 0.0))
        except RobotError:
            raise KeyError(name) from None
        place = self.place(known)
        facing = None if place is None else place.facing
        return *point, None if facing is None else radians(facing)

    def dock(self, robot: Pose) -> Pose | None:
        """Return the nearest dock of the world, which faces as the robot does in it."""
        return next((Pose(dock.x, dock.y, dock.facing or 0.0) for dock in self.world.docks_from(robot)), None)

    def stations(self, robot: Pose) -> list[Station]:
        """Return the docks, nearest first: where the robot stands to be connected; its own pose if there are none."""
        names = [dock.name for dock in self.world.docks_from(robot)] or [_DOCK]
        known = {name.lower() for name in self.world.names.places}
        spots = {name: self.goal(name, robot) for name in names if name.lower() in known}
        return [Station(name, spots.get(name, robot), spots.get(name, robot)) for name in names]

    def goal(self, name: str, robot: Pose) -> Pose:
        """Return where the robot has to stand for a name, and which way to face.

        Before an object or a person that is the end of the free way there, by the walls and boxes of the world file.
        Raises RobotError for an unknown name, and for what somebody was given.
        """
        known = self.known(name)
        self.check_free(known)
        point = self.locate(known, robot)
        place = self.place(known)
        if place is not None:
            facing = robot.heading + robot.bearing_to(point) if place.facing is None else place.facing
            return Pose(place.x, place.y, facing)
        reach = stand_off(self._body, self.obstacles.things[known], self.is_person(known))
        stand = self._stand(robot, point, reach)
        return Pose(*stand, stand_heading(stand, point))

    def picked_up(self, name: str) -> None:
        """Note that the robot carries an object from now on."""
        self.obstacles.pick_up(name)

    def put_down(self, name: str, robot: Pose, hand: Hand) -> None:
        """Put an object just in front of the robot."""
        part = self._body.hand(hand)
        ahead = (part.puts_at if part is not None else self._body.radius) + self.obstacles.things[name].radius
        self.obstacles.put_down(name, *robot.ahead(ahead))

    def give(self, name: str, person: str) -> None:
        """Note that a person has an object from now on."""
        self.obstacles.pick_up(name)
        super().give(name, person)

    def swing(self, name: str, is_open: bool) -> None:
        """Open or close a door in the world."""
        if self.obstacles.doors[name].open != is_open:
            self.obstacles.swing(name, is_open)

    def _stand(self, robot: Pose, point: Point, reach: float) -> Point:
        with suppress(RobotError):  # a world too large to plan in
            if self._planner is None:
                self._planner = PathPlanner(self._given_world, self.obstacles, self._body.radius, self.zones)
            path = self._planner.path((robot.x, robot.y), point, reach)
            if path is not None:
                return path[-1]
        left = robot.distance_to(point)  # no free way on this map: the server of the robot may know better
        share = max(0.0, left - reach) / left if left else 0.0
        return robot.x + share * (point[0] - robot.x), robot.y + share * (point[1] - robot.y)


def stand_heading(stand: Point, point: Point) -> float:
    """Return the degrees that face a point."""
    return Pose(*stand).bearing_to(point)


def _stranger(name: str, kind: str, point: Point) -> Thing:
    if kind == "person":
        return Person(name, *point, PERSON_RADIUS)
    return WorldObject(name, *point, OBJECT_RADIUS)


class RosDoors:
    """Doors and switches. `emit` reports what happens.

    All methods raise RobotError for unknown names, and if nothing reports the state.
    """

    def __init__(
        self,
        node: Node,
        subscriptions: SubscriptionCache,
        services: Services,
        places: RosPlaces,
        world: World,
        emit: Callable[..., object],
    ) -> None:
        self._node, self._subscriptions, self._services = node, subscriptions, services
        self._places, self._emit = places, emit
        self._doors, self._switches = door_services(world), switch_services(world)
        self._states: dict[str, bool] = {}
        for name, service in (*self._doors.items(), *self._switches.items()):
            services.add(service, SetBool)
            subscriptions.listen(state_topic(service), Bool, f"message from {said(name)}", qos="state")

    def move_door(self, name: str, is_open: bool) -> ServiceCall:
        """Open or close a door."""
        door = self._places.door(name).name
        return self._services.call(self._doors[door], partial(self._on_move, door, is_open), data=is_open)

    def is_open(self, name: str) -> bool:
        """Return whether a door is open."""
        return self._state(self._doors[self._places.door(name).name])

    def switch(self, name: str, on: bool | None) -> ServiceCall:
        """Switch an object on or off; None toggles it."""
        known = self._switchable(name)
        wanted = not self._state(self._switches[known]) if on is None else on
        return self._services.call(self._switches[known], partial(self._on_switch, known, wanted), data=wanted)

    def is_on(self, name: str) -> bool:
        """Return whether an object is switched on."""
        return self._state(self._switches[self._switchable(name)])

    def step(self) -> None:
        """Read the states of doors and switches."""
        for name, service in (*self._doors.items(), *self._switches.items()):
            for message in self._subscriptions.events(state_topic(service)):
                self._note(name, service, bool(message.data))

    def find_unreported(self) -> list[str]:
        """Return the topics that somebody publishes and that have reported nothing yet."""
        topics = map(state_topic, (*self._doors.values(), *self._switches.values()))
        return [each for each in topics if not self._subscriptions.has(each) and self._node.count_publishers(each)]

    def _switchable(self, name: str) -> str:
        known = self._places.known(name)
        if known not in self._switches:
            raise RobotError(f"{said(known)} can't be switched on or off")
        return known

    def _state(self, service: str) -> bool:
        if service not in self._states:
            return bool(self._subscriptions.get(state_topic(service)).data)
        return self._states[service]

    def _note(self, name: str, service: str, state: bool) -> None:
        self._states[service] = state
        if name in self._doors:
            self._places.swing(name, state)

    def _on_move(self, door: str, is_open: bool, message: str) -> None:
        self._note(door, self._doors[door], is_open)  # before the topic reports it
        self._emit("door", name=door, open=is_open)

    def _on_switch(self, name: str, on: bool, message: str) -> None:
        self._note(name, self._switches[name], on)
        self._emit("switch", name=name, on=on)


def door_services(world: World) -> dict[str, str]:
    """Return the service of each door of a world."""
    return _services("doors", "door", (door.name for door in world.doors))


def switch_services(world: World) -> dict[str, str]:
    """Return the service of each object of a world that can be switched."""
    return _services("switches", "switch", (thing.name for thing in world.objects if thing.switch))


def state_topic(service: str) -> str:
    """Return the topic that reports whether a door is open, or an object is on."""
    return f"{service}/state"


def _services(folder: str, kind: str, names: Iterable[str]) -> dict[str, str]:
    return {name: f"{folder}/{token}" for name, token in graph_names(names, kind).items()}
