"""What the robot recognises, and who follows it: /sightings, /follow."""

from __future__ import annotations

from functools import partial

from btlang_interfaces.msg import Sighting, Sightings
from btlang_interfaces.srv import Follow
from geometry_msgs.msg import Point
from rclpy.node import Node

from btlang.robots.simulated import SimulatedRobot
from btlang.ros.perception import KINDS, SIGHTINGS
from btlang.ros.poses import MAP
from btlang.ros.robot import FOLLOW
from btlang.ros.simulator.call_queue import CallQueue
from btlang.ros.simulator.publishing import COMMANDS, Every, Moment


class Seeing:
    """Publishes what is in view, where the body recognises anything."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._sightings = node.create_publisher(Sightings, SIGHTINGS, COMMANDS)
        self._due = Every(10)

        def follow(request: Follow.Request, response: Follow.Response) -> Follow.Response:
            response.success, response.message = calls.ask(partial(robot.guide, request.person, request.follow))
            return response

        node.create_service(Follow, FOLLOW, follow)

    def publish(self, now: Moment) -> None:
        """Tells what is in view."""
        robot = self._robot
        if not robot.body.has("perception") or not self._due.is_due(now.seconds):
            return
        message = Sightings()
        message.header.stamp, message.header.frame_id = now.stamp, MAP
        for kind in KINDS:
            for name, (x, y) in robot.surroundings.sight.in_view(kind, robot.pose).items():
                message.sightings.append(Sighting(name=name, kind=kind, position=Point(x=x, y=y)))
        self._sightings.publish(message)
