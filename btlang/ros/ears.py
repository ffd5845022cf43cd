"""What a ROS 2 robot hears, and the question that it waits for an answer to."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from std_msgs.msg import String

from btlang.robots.ears import Ears
from btlang.ros.available import optional_interface
from btlang.ros.node import LATCHED
from btlang.ros.subscription_cache import SubscriptionCache
from btlang.speech.recogniser import Expected

HEARD, ASKING, LISTENING = "heard", "asking", "listening"
HEARD_TYPE, QUESTION_TYPE = "btlang_interfaces/msg/Heard", "btlang_interfaces/msg/Question"
ANYTHING = "*"
"""The line of the topic of what is listened for that stands for any words."""
WORDLESS = "..."
"""The text of a question that has no words: the robot only listens."""


class RosEars:
    """`ears` are what was heard, from the topic or typed. The topic of questions says which one is open, and to whom;
    the topic of the phrases that it listens for has one on each line.

    `emit` gets an event for what is heard and for questions. Without btlang's interfaces it hears only what is typed.
    """

    def __init__(self, node: Node, subscriptions: SubscriptionCache, emit: Callable[..., object]) -> None:
        self.ears = Ears()
        self._subscriptions, self._emit = subscriptions, emit
        self._question = optional_interface(QUESTION_TYPE)
        self._publisher = node.create_publisher(self._question, ASKING, LATCHED) if self._question else None
        self._is_open = False
        self._listening = node.create_publisher(String, LISTENING, LATCHED)
        self._expected = Expected()
        heard = optional_interface(HEARD_TYPE)
        self._listens = heard is not None
        if self._listens:
            subscriptions.listen(HEARD, heard, "message from the ears", qos="events")

    def begin(self) -> None:
        """A run begins: nobody is asked anything."""
        self.ears.begin()
        self.step(0.0)

    def hear(self, text: str, who: str, now: float) -> None:
        """Somebody says it, or types it, at a second of the run."""
        self.ears.hear(text, who, now)
        self._emit("hear", text=text, who=who)

    def ask(self, question: str, person: str) -> None:
        """The robot has asked a person, or anybody for "", and waits for an answer."""
        self.ears.asking = question or WORDLESS
        self._emit("ask", text=question, who=person)
        self._publish(person, self.ears.asking)

    def step(self, now: float) -> None:
        """Hears what has come, and says when a question is no longer open."""
        for message in self._subscriptions.events(HEARD) if self._listens else ():
            self.hear(message.text, message.who, now)
        if self._is_open and not self.ears.asking:
            self._publish("", "")
        expected = self.ears.expected(now)
        if expected != self._expected:
            self._expected = expected
            self._listening.publish(
                String(data="\n".join((*expected.phrases, *([ANYTHING] if expected.anything else ()))))
            )

    def _publish(self, who: str, text: str) -> None:
        self._is_open = bool(text)
        if self._publisher is not None:
            self._publisher.publish(self._question(who=who, text=text))
