"""Doors and switches of the world: a service moves each, a topic says how it is."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

from btlang.robots.robot import RobotError
from btlang.robots.world import World, said
from btlang.ros.names import graph_names
from btlang.ros.places import Places
from btlang.ros.services import Call, Services
from btlang.ros.subscription_cache import SubscriptionCache


class RosDoors:
    """`emit` reports what happens. All raise RobotError for unknown names, and if nothing reports what is asked."""

    def __init__(
        self,
        node: Node,
        subscriptions: SubscriptionCache,
        services: Services,
        places: Places,
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

    def move_door(self, name: str, is_open: bool) -> Call:
        """Opens or closes a door."""
        door = self._places.door(name).name
        return self._services.call(self._doors[door], partial(self._moved, door, is_open), data=is_open)

    def is_open(self, name: str) -> bool:
        """Whether a door is open."""
        return self._state(self._doors[self._places.door(name).name])

    def switch(self, name: str, on: bool | None) -> Call:
        """Switches an object on or off, with None to the other of both."""
        known = self._switchable(name)
        wanted = not self._state(self._switches[known]) if on is None else on
        return self._services.call(self._switches[known], partial(self._switched, known, wanted), data=wanted)

    def is_on(self, name: str) -> bool:
        """Whether an object is switched on."""
        return self._state(self._switches[self._switchable(name)])

    def step(self) -> None:
        """Hears how doors and switches are."""
        for name, service in (*self._doors.items(), *self._switches.items()):
            for message in self._subscriptions.events(state_topic(service)):
                self._note(name, service, bool(message.data))

    def awaited(self) -> list[str]:
        """The topics that somebody publishes and that have said nothing yet."""
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

    def _moved(self, door: str, is_open: bool, message: str) -> None:
        self._note(door, self._doors[door], is_open)  # before the topic reports it
        self._emit("door", name=door, open=is_open)

    def _switched(self, name: str, on: bool, message: str) -> None:
        self._note(name, self._switches[name], on)
        self._emit("switch", name=name, on=on)


def door_services(world: World) -> dict[str, str]:
    """The service of each door of a world."""
    return _services("doors", "door", (door.name for door in world.doors))


def switch_services(world: World) -> dict[str, str]:
    """The service of each object of a world that can be switched."""
    return _services("switches", "switch", (thing.name for thing in world.objects if thing.switch))


def state_topic(service: str) -> str:
    """The topic that says whether a door is open, or an object is on."""
    return f"{service}/state"


def _services(folder: str, kind: str, names: Iterable[str]) -> dict[str, str]:
    return {name: f"{folder}/{token}" for name, token in graph_names(names, kind).items()}
