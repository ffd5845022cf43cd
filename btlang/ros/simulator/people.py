"""People around the simulated robot as topics: /heard, /asking, /sightings, /follow and /hand_over."""

from __future__ import annotations

from functools import partial

from btlang_interfaces.msg import Heard, Question, Sighting, Sightings
from btlang_interfaces.srv import Follow, HandOver
from geometry_msgs.msg import Point
from rclpy.node import Node

from btlang.robots.simulation.robot import SimulatedRobot
from btlang.ros.messages import MAP
from btlang.ros.node import LATCHED
from btlang.ros.robot.hands import HAND_OVER
from btlang.ros.robot.robot import FOLLOW
from btlang.ros.robot.sensors import KINDS, SIGHTINGS
from btlang.ros.robot.speech import ASKING, HEARD, WORDLESS
from btlang.ros.simulator.shared import COMMANDS, CallQueue, Moment, PeriodicPublisher


class HearingTopics:
    """The topics of hearing: questions go to the people of the world, and what they say is published."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._heard = node.create_publisher(Heard, HEARD, COMMANDS)
        node.create_subscription(Question, ASKING, lambda question: calls.post(lambda: self._ask(question)), LATCHED)

    def publish(self, now: Moment) -> None:
        """Do nothing: what is heard is published at once."""

    def heard(self, text: str, who: str) -> None:
        """Publish what somebody has just said."""
        self._heard.publish(Heard(who=who, text=text))

    def _ask(self, question: Question) -> None:
        if self._robot.body.ears is None or question.text == WORDLESS:
            return
        if question.text:
            self._robot.ask(question.text, question.who)
        else:
            self._robot.ears.asking = ""


class SightTopics:
    """The topics of sight: what is in view, if the body has perception; people follow and take what they are given."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._sightings = None
        if robot.body.has("perception"):
            self._sightings = node.create_publisher(Sightings, SIGHTINGS, COMMANDS)
        self._due = PeriodicPublisher(10)

        def follow(request: Follow.Request, response: Follow.Response) -> Follow.Response:
            response.success, response.message = calls.ask(partial(robot.guide, request.person, request.follow))
            return response

        def hand_over(request: HandOver.Request, response: HandOver.Response) -> HandOver.Response:
            response.success, response.message = calls.ask(partial(robot.hand_over, request.hand, request.person))
            return response

        node.create_service(Follow, FOLLOW, follow)
        node.create_service(HandOver, HAND_OVER, hand_over)

    def publish(self, now: Moment) -> None:
        """Publish what is in view."""
        robot = self._robot
        if self._sightings is None or not self._due.is_due(now.seconds):
            return
        message = Sightings()
        message.header.stamp, message.header.frame_id = now.stamp, MAP
        for kind in KINDS:
            for name, (x, y) in robot.surroundings.sight.in_view(kind, robot.pose).items():
                message.sightings.append(Sighting(name=name, kind=kind, position=Point(x=x, y=y)))
        self._sightings.publish(message)
