"""Speech of a ROS 2 robot: what it says, shows and hears, and the question that it waits for an answer to."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import Bool, String

from btlang.engine.leaves.leaf import NotThere
from btlang.robots.ears import Ears
from btlang.robots.robot import RobotError
from btlang.robots.voice import Synthesizer
from btlang.ros.available import optional_interface
from btlang.ros.clocks import AWAKE
from btlang.ros.node import LATCHED
from btlang.ros.subscriptions import SubscriptionCache
from btlang.speech.recogniser import Expected

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.speech.engine import Utterance


SPEECH, SPEAKING, PRINT, LANGUAGE = "speech", "speaking", "print", "language"
_BEGINS = 0.5  # seconds of real time that it gets to begin
_YOUNG = 2.0  # seconds in which a listener may not have found this node yet: what it misses then is sent again
_LATEST = 5.0  # how many times as long as expected it may speak
HEARD, ASKING, LISTENING = "heard", "asking", "listening"
HEARD_TYPE, QUESTION_TYPE = "btlang_interfaces/msg/Heard", "btlang_interfaces/msg/Question"
ANYTHING = "*"
"""The line in the topic of expected phrases that stands for any words."""
WORDLESS = "..."
"""The text of a question without words: the robot only listens."""


class RosSpeech:
    """The voice and the screen. Times are those of the mission.

    Words have the times of the engine, from the moment at which the topic reports that it speaks. If nothing reports
    that, it takes as long as the engine estimates.
    """

    def __init__(self, node: Node, subscriptions: SubscriptionCache, synthesizer: Synthesizer) -> None:
        self._subscriptions, self._synthesizer = subscriptions, synthesizer
        self.said: Utterance | None = None
        """The current or the last utterance."""
        self._speech = node.create_publisher(String, SPEECH, 10)
        self._print = node.create_publisher(String, PRINT, 10)
        self._language = node.create_publisher(String, LANGUAGE, LATCHED)
        self._made, self._risky = time.monotonic(), False
        self._age = self._since = self._began = 0.0
        self._usual = 0.0  # seconds that it took to begin the last time, which is what is expected
        self._waiting = ""  # what it is to say when `_age` is 0
        self._asked = self._heard = self._reported = False
        self._node, self._clock = node, node.get_clock()
        self._stepped = self._set_in = self._now()  # of the node's clock: the latest step, and when speech began
        self._timer: Any = None
        subscriptions.listen(SPEAKING, Bool, "speech status", qos="state", also=self._on_message)

    def utterance(self, text: str) -> Utterance:
        """Return the sound and the times of a text. Raises RobotError if the engine can't speak it."""
        return self._synthesizer.speak(text)

    @property
    def language(self) -> str:
        """The language in which it speaks."""
        return self._synthesizer.language

    def speak_in(self, language: str = "") -> None:
        """Speak in a language from now on. A latched topic publishes it when it changes."""
        before = self.language
        self._synthesizer.speak_in(language)
        if self.language != before:
            self._language.publish(String(data=self.language))

    @property
    def position(self) -> float:
        """Seconds since the utterance began, negative before."""
        return self._age - self._began

    def say(self, text: str, after: float = 0.0) -> None:
        """Start to speak after so many seconds. Raises RobotError if nobody listens."""
        if not self._speech.get_subscription_count():
            raise RobotError(NotThere(f"nobody listens to {self._speech.topic_name}"))
        self.said = self.utterance(text)
        self._asked, self._heard, self._age, self._began, self._since = True, False, -after, self._usual, AWAKE.now()
        self._waiting = text
        self._cancel_timer()
        if after > 0.0:  # between two ticks
            wait = max(0.0, after - self._now() + self._stepped)
            self._timer = self._node.create_timer(wait, self._begin, clock=self._clock)
        else:
            self._begin()

    def _begin(self) -> None:
        self._cancel_timer()
        text, self._waiting = self._waiting, ""
        if text:
            self._since = AWAKE.now()
            self._publish(self._speech, text)
            if not self._asked:
                self._speech.publish(String(data=""))  # `silence` came in between from another thread

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()

    def _now(self) -> float:
        return float(self._clock.now().nanoseconds) * 1e-9

    def _on_message(self, message: Bool) -> None:
        if message.data:
            self._set_in = self._now()

    def silence(self) -> None:
        """End speech at once; from any thread."""
        self._waiting = ""
        if self._asked:
            self._asked = False
            self._speech.publish(String(data=""))

    def print(self, text: str) -> None:
        """Show a text. Raises RobotError if nobody listens."""
        if not self._print.get_subscription_count():
            raise RobotError(NotThere(f"nobody listens to {self._print.topic_name}"))
        self._publish(self._print, text)

    def _publish(self, publisher: Any, text: str) -> None:
        publisher.publish(String(data=text))
        self._risky = self._risky or time.monotonic() - self._made < _YOUNG

    def confirm(self, seconds: float) -> None:
        """Wait at most so many seconds until listeners have all words: a node that is gone sends nothing again.

        Only if something was said so early that a listener may have missed it: the answer takes up to three seconds,
        since DDS asks for it that often.
        """
        if not self._risky:
            return
        until = time.monotonic() + seconds
        for publisher in (self._speech, self._print):
            publisher.wait_for_all_acked(Duration(seconds=max(0.0, until - time.monotonic())))

    def step(self, dt: float) -> None:
        """Go on; `dt` seconds have passed."""
        self._age += dt
        self._stepped = self._now()
        if self._waiting and self._age > -1e-9:
            self._begin()
        for message in self._subscriptions.events(SPEAKING):
            if self._heard and self._reported and not message.data:
                self._asked = False
            self._reported = bool(message.data)
            if self._reported and self._asked and not self._heard and not self._waiting:
                since = min(max(0.0, self._stepped - self._set_in), dt)
                self._heard, self._began = True, max(0.0, self._age - since)
                self._usual = min(self._began, _BEGINS)
        if self._asked and not self._waiting and AWAKE.now() - self._since > _BEGINS:
            self._asked = self._reported if self._subscriptions.has(SPEAKING) else self._age < self._seconds

    @property
    def _seconds(self) -> float:
        return self.said.seconds if self.said is not None else 0.0

    @property
    def speaking(self) -> bool:
        """Whether it speaks. Raises RobotError if that takes far longer than the text is long."""
        if self._asked and self._age > 2.0 + _LATEST * self._seconds:
            raise RobotError(
                f"it has been speaking for {self._age:.0f} s: {self._subscriptions.shown(SPEAKING)} does not change"
            )
        return self._asked


class RosEars:
    """The ears of a ROS 2 robot: what was heard, in `ears`, from the topic or typed.

    The topic of questions publishes the open one, and to whom; the topic of expected phrases has one on each line.
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
        """Begin a run, without an open question."""
        self.ears.begin()
        self.step(0.0)

    def hear(self, text: str, who: str, now: float) -> None:
        """Take a text that somebody says or types at a second of the run."""
        self.ears.hear(text, who, now)
        self._emit("hear", text=text, who=who)

    def ask(self, question: str, person: str) -> None:
        """Publish a question to a person, or to anybody for ""."""
        self.ears.asking = question or WORDLESS
        self._emit("ask", text=question, who=person)
        self._publish(person, self.ears.asking)

    def step(self, now: float) -> None:
        """Read what was heard, and publish when a question is no longer open."""
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
