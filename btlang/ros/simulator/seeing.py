"""What the robot recognises, who follows it and who takes what it hands over: /sightings, /follow, /hand_over."""

from __future__ import annotations

from functools import partial

from btlang_interfaces.msg import Sighting, Sightings
from btlang_interfaces.srv import Follow, HandOver
from geometry_msgs.msg import Point
from rclpy.node import Node

from btlang.robots.simulated import SimulatedRobot
from btlang.ros.hands import HAND_OVER
from btlang.ros.perception import KINDS, SIGHTINGS
from btlang.ros.poses import MAP
from btlang.ros.robot import FOLLOW
from btlang.ros.simulator.call_queue import CallQueue
from btlang.ros.simulator.publishing import COMMANDS, Every, Moment


class Seeing:
    """Publishes what is in view, where the body recognises anything; people follow and take what they are given."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._sightings = None
        if robot.body.has("perception"):
            self._sightings = node.create_publisher(Sightings, SIGHTINGS, COMMANDS)
        self._due = Every(10)

        def follow(request: Follow.Request, response: Follow.Response) -> Follow.Response:
            response.success, response.message = calls.ask(partial(robot.guide, request.person, request.follow))
            return response

        def hand_over(request: HandOver.Request, response: HandOver.Response) -> HandOver.Response:
            response.success, response.message = calls.ask(partial(robot.hand_over, request.hand, request.person))
            return response

        node.create_service(Follow, FOLLOW, follow)
        node.create_service(HandOver, HAND_OVER, hand_over)

    def publish(self, now: Moment) -> None:
        """Publishes what is in view."""
        robot = self._robot
        if self._sightings is None or not self._due.is_due(now.seconds):
            return
        message = Sightings()
        message.header.stamp, message.header.frame_id = now.stamp, MAP
        for kind in KINDS:
            for name, (x, y) in robot.surroundings.sight.in_view(kind, robot.pose).items():
                message.sightings.append(Sighting(name=name, kind=kind, position=Point(x=x, y=y)))
        self._sightings.publish(message)
