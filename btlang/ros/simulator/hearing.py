"""What the robot hears, and what it asks: /heard, /asking. People of the world answer."""

from __future__ import annotations

from btlang_interfaces.msg import Heard, Question
from rclpy.node import Node

from btlang.robots.simulated import SimulatedRobot
from btlang.ros.ears import ASKING, HEARD, WORDLESS
from btlang.ros.node import LATCHED
from btlang.ros.simulator.call_queue import CallQueue
from btlang.ros.simulator.publishing import COMMANDS, Moment


class Hearing:
    """Hands questions to the people of the world, and publishes what they say."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue) -> None:
        self._robot = robot
        self._heard = node.create_publisher(Heard, HEARD, COMMANDS)
        node.create_subscription(Question, ASKING, lambda question: calls.post(lambda: self._ask(question)), LATCHED)

    def publish(self, now: Moment) -> None:
        """Nothing: what is heard is published at once."""

    def heard(self, text: str, who: str) -> None:
        """Somebody has just said this."""
        self._heard.publish(Heard(who=who, text=text))

    def _ask(self, question: Question) -> None:
        if self._robot.body.ears is None or question.text == WORDLESS:
            return
        if question.text:
            self._robot.ask(question.text, question.who)
        else:
            self._robot.ears.asking = ""
