"""Doors, switches and zones of the world: /doors/..., /switches/..., /zones/..."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

from btlang.robots.simulation.robot import SimulatedRobot
from btlang.ros.node import LATCHED
from btlang.ros.robot.places import door_services, state_topic, switch_services
from btlang.ros.robot.zones import zone_topics
from btlang.ros.simulator.shared import CallQueue, LatchedPublisher, Moment


class DoorTopics:
    """Doors and switches within reach, and zones, which are closed and opened as the mission requests."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._states: list[tuple[LatchedPublisher, Callable[[], bool]]] = []
        for name, service in door_services(robot.world).items():
            self._serve(node, calls, service, partial(robot.move_door, name), partial(robot.is_open, name))
        for name, service in switch_services(robot.world).items():
            self._serve(node, calls, service, partial(robot.switch, name), partial(robot.is_on, name))
        for name, topic in zone_topics(robot.world.zones).items():
            node.create_subscription(
                Bool, topic, lambda closed, name=name: calls.post(partial(self._set_zone, name, closed.data)), LATCHED
            )

    def publish(self, now: Moment) -> None:
        """Publish the states that have changed."""
        for topic, state in self._states:
            topic.set(state())

    def _serve(
        self, node: Node, calls: CallQueue, service: str, move: Callable[[bool], object], state: Callable[[], bool]
    ) -> None:
        def answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
            response.success, response.message = calls.ask(partial(move, request.data))
            return response

        node.create_service(SetBool, service, answer)
        self._states.append((LatchedPublisher(node, Bool, state_topic(service), state()), state))

    def _set_zone(self, name: str, closed: bool) -> None:
        zones = self._robot.zones
        if zones.is_closed(name) != closed:
            (zones.close if closed else zones.open)(name)
