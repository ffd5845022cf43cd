"""The hands of a ROS 2 robot: services close and open them and hand over, topics report what they hold."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

from btlang.robots.bodies.body import Body
from btlang.robots.geometry import Pose
from btlang.robots.robot import Hand, RobotError
from btlang.robots.worlds.world import said
from btlang.ros.available import optional_interface
from btlang.ros.robot.places import RosPlaces
from btlang.ros.robot.services import ServiceCall, Services
from btlang.ros.subscriptions import SubscriptionCache

HAND_OVER = "hand_over"
_HANDS: tuple[Hand, Hand] = ("left", "right")


class RosHands:
    """The hands. `where` returns the robot's pose, None if nobody knows it; `emit` reports what happens."""

    def __init__(
        self,
        node: Node,
        subscriptions: SubscriptionCache,
        services: Services,
        places: RosPlaces,
        where: Callable[[], Pose | None],
        emit: Callable[..., object],
        body: Body,
    ) -> None:
        self._node = node
        self._hands: list[Hand] = [hand for hand in _HANDS if body.hand(hand) is not None]
        self._subscriptions, self._services, self._places = subscriptions, services, places
        self._where, self._emit = where, emit
        self._holding: dict[Hand, str] = {}
        self._opening: dict[Hand, ServiceCall] = {}
        for hand in self._hands:
            subscriptions.listen(_held(hand), String, f"message from the {hand} hand", qos="state")
            services.add(_close(hand), SetBool)
        service = optional_interface("btlang_interfaces/srv/HandOver")
        self._gives = service is not None
        if self._gives:
            services.add(HAND_OVER, service)

    def grasp(self, hand: Hand, name: str | None) -> ServiceCall:
        """Close a hand. If it closes on another object than the named one, it opens again. Raises RobotError."""
        if name is not None:
            self._places.check_movable(name)
        wanted = None if name is None else self._places.known(name)
        return self._services.call(_close(hand), partial(self._on_grasp, hand, wanted), data=True)

    def release(self, hand: Hand) -> ServiceCall:
        """Open a hand. Raises RobotError."""
        self._opening[hand] = self._services.call(_close(hand), partial(self._on_release, hand), data=False)
        return self._opening[hand]

    def hand_over(self, hand: Hand, person: str) -> ServiceCall:
        """Give what a hand holds to a person. Raises RobotError."""
        name, known = self.holding(hand), self._places.known(person)
        if name is None:
            raise RobotError(f"the {hand} hand is empty")
        if not self._gives:
            raise RobotError("btlang's interfaces aren't compiled, so it can't hand over anything")
        given = partial(self._given, hand, name, known)
        self._opening[hand] = self._services.call(HAND_OVER, given, hand=hand, person=known)
        return self._opening[hand]

    def holding(self, hand: Hand) -> str | None:
        """Return the name of what a hand holds; None if there is no such hand. Raises RobotError
        if nothing reports it.
        """
        if hand not in self._hands:
            return None
        if hand not in self._holding:
            self._subscriptions.get(_held(hand))
        return self._holding.get(hand) or None

    def step(self) -> None:
        """Read what the hands hold."""
        for hand in self._hands:
            for message in self._subscriptions.events(_held(hand)):
                before = self._holding.get(hand, "")
                self._holds(hand, message.data)
                opens = hand in self._opening and not self._opening[hand].done  # and is about to answer
                if before and not message.data and not opens:
                    self._emit("drop", hand=hand, name=before)

    def find_unreported(self) -> list[str]:
        """Return the topics that somebody publishes and that have reported nothing yet."""
        topics = map(_held, self._hands)
        return [each for each in topics if not self._subscriptions.has(each) and self._node.count_publishers(each)]

    def _on_grasp(self, hand: Hand, wanted: str | None, found: str) -> None:
        if wanted is not None and found.lower() != wanted.lower():
            self._services.fire(_close(hand), data=False)
            raise RobotError(f"the {hand} hand closed on {said(found)} instead of {said(wanted)}")
        self._holds(hand, found)
        self._emit("grasp", hand=hand, name=found)

    def _on_release(self, hand: Hand, name: str) -> None:
        self._holds(hand, "")
        self._emit("release", hand=hand, name=name or None)

    def _given(self, hand: Hand, name: str, person: str, message: str) -> None:
        self._holds(hand, "")
        if name in self._places.world.names.objects:
            self._places.give(name, person)
        self._emit("give", hand=hand, name=name, who=person)

    def _holds(self, hand: Hand, name: str) -> None:
        before = self._holding.get(hand, "")
        if name == before:
            return
        self._holding[hand] = name
        objects = self._places.world.names.objects
        here = self._where()
        if before in objects and here is not None:
            self._places.put_down(before, here, hand)
        if name in objects:
            self._places.picked_up(name)


def _held(hand: Hand) -> str:
    return f"{hand}_hand/holding"


def _close(hand: Hand) -> str:
    return f"{hand}_hand/close"
