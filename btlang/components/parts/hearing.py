"""Hearing with a microphone: the robot listens for what is expected, and asks if it isn't sure."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping

from btlang.actions.conversation import MEANINGS, answers, meaning_of
from btlang.devices.kinds import Pressed, Reading, Sound
from btlang.robots.bodies.speech_tables import recogniser_of
from btlang.robots.robot import RobotError
from btlang.speech.listener import Attention, Listener
from btlang.speech.recogniser import RATE, Expected

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.devices.device_set import DeviceSet
    from btlang.robots.bodies.body import Body

TALK = "talk"
"""The word in the name of the talk button."""
_ECHO = 0.3  # seconds after its own voice in which it hears nothing
_HELD = 2.0  # seconds for which a button that isn't one of the robot counts as held: its connection may be lost
_PATIENCE = 8.0  # seconds in which "Did you say ...?" has to be answered


class Hearing:
    """The hearing of a robot, with its first microphone. `step` is for the thread of the robot.

    `report` gets an event when the microphone or the recogniser fails: see btlang.run.events.PartChanged. `clock`
    returns seconds for any thread. Raises RecogniserError if the body names a recogniser that can't be used. A body
    without a microphone hears nothing.
    """

    def __init__(
        self,
        body: Body,
        robot: Any,
        devices: DeviceSet,
        report: Callable[[str, Mapping[str, Any]], object],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        assert body.ears is not None
        self._engine, self._report_event, self._clock = body.ears.engine, report, clock
        self._robot, self._ears, self._push = robot, robot.ears, body.ears.settings.push
        self._attention = Attention(body.ears.wake, self._push)
        self._listener: Listener | None = None
        self._expected = Expected()
        self._deaf_until, self._is_deaf = -math.inf, False
        self._is_pushed, self._held_until, self._was_held = False, -math.inf, False
        self._doubtful, self._asked_until = "", -math.inf
        microphone = devices.first("microphone")
        if microphone and any(microphone in loop.devices for loop in devices.loops):
            self._listener = Listener(recogniser_of(body))
            devices.follow(microphone, self._take)
            self._ears.talk = self.talk if self._push else None
        for name, device in devices.devices.items():
            if self._push and device.kind == "button" and TALK in name:
                devices.follow(name, self._press)

    def push(self, pushed: bool) -> None:
        """Press or release the talk button; from any thread."""
        self._is_pushed = pushed
        self._look_at_button()

    def talk(self, held: bool) -> None:
        """Press or release a remote talk button: while it's pressed, this has to be called again within 2 s."""
        self._held_until = self._clock() + _HELD if held else -math.inf
        self._look_at_button()

    def step(self) -> None:
        """Take what was said, and set what is listened for now."""
        if self._listener is None:
            return
        now = self._robot.time
        self._look_at_button()
        self._report(self._listener.problem)
        self._listen_to_others(self._listener, now)
        while (understood := self._listener.understood()) is not None:
            meant = self._attention.meant(understood, now)
            if meant is not None and not self._is_deaf:
                self._hear(meant.text, meant.sure, now)
        if self._doubtful and now > self._asked_until:
            self._doubtful = ""
        asking = bool(self._doubtful or self._ears.asking)
        wanted = answers(MEANINGS, self._robot.body) if self._doubtful else self._ears.expected(now)
        expected = self._attention.expected(wanted, asking, now)
        if expected != self._expected:
            self._expected = expected
            self._listener.expect(expected)

    def close(self) -> None:
        """Stop listening. May be called twice."""
        if self._listener is not None:
            self._listener.close()

    def _look_at_button(self) -> bool:
        held = self._is_pushed or self._clock() < self._held_until
        was, self._was_held = self._was_held, held
        if was and not held and self._listener is not None:
            self._listener.end()
        return held

    def _report(self, problem: str) -> None:
        if problem != self._ears.problem:
            self._ears.problem = problem
            text = f"the ears don't work: {problem}" if problem else "the ears work"
            state = "silent" if problem else "works"
            self._report_event("part", {"kind": "ears", "name": self._engine, "state": state, "text": text})

    def _listen_to_others(self, listener: Listener, now: float) -> None:
        """Ignore sound while the robot itself speaks."""
        if self._robot.speaking:
            self._deaf_until = now + _ECHO
            if self._doubtful:
                self._asked_until = now + _PATIENCE
        was, self._is_deaf = self._is_deaf, now < self._deaf_until
        if self._is_deaf != was:
            listener.forget()

    def _hear(self, text: str, sure: bool, now: float) -> None:
        if self._doubtful:
            meaning = meaning_of(text)
            if sure and meaning in MEANINGS:
                doubtful, self._doubtful = self._doubtful, ""
                if meaning == "yes":
                    self._robot.hear(doubtful)
        elif sure:
            self._robot.hear(text)
        elif not self._robot.refuses:
            self._ask(text, now)

    def _ask(self, text: str, now: float) -> None:
        try:
            self._robot.say(f'Did you say "{text}"?')
        except RobotError:  # without a voice nobody can be asked
            return
        self._doubtful, self._asked_until = text, now + _PATIENCE

    def _take(self, reading: Reading) -> None:
        """Take sound, in the thread of the device."""
        assert isinstance(reading, Sound)
        if self._listener is None or self._is_deaf or (self._push and not self._look_at_button()):
            return
        self._listener.hear(reading.samples if reading.rate == RATE else b"")

    def _press(self, reading: Reading) -> None:
        assert isinstance(reading, Pressed)
        self.push(reading.pressed)
