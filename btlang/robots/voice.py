"""The voice, which takes its time, and the screen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress

from btlang.robots.body import Body
from btlang.robots.body import Voice as VoiceSettings
from btlang.robots.robot import RobotError
from btlang.robots.voice_file import engine_of
from btlang.speech.engine import Settings, SpeechError, Utterance
from btlang.speech.visemes import SHAPES, shape_at


class Synthesizer:
    """The engine of a body's voice, in one language at a time. Raises MissionError (BT071) where it can't be used."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._own = (body.voice or VoiceSettings(Settings())).settings.language
        self.language = self._own
        """Such as "en"."""
        self._last: tuple[str, Utterance] | None = None  # gestures ask for the times of what is said next
        try:
            self._engine = engine_of(body)
        except SpeechError as problem:
            from btlang.robots.body_file import unusable_robot

            raise unusable_robot(problem) from None

    def speak_in(self, language: str = "") -> None:
        """Speaks in a language such as "es" from now on, by default in its own. Raises RobotError where it can't."""
        wanted = language or self._own
        if wanted == self.language:
            return
        try:
            self._engine = engine_of(self._body, wanted)
        except SpeechError as problem:
            raise RobotError(str(problem)) from None
        self.language, self._last = wanted, None

    def speak(self, text: str) -> Utterance:
        """The text as sound and times; the latest one is kept. Raises RobotError where the engine can't."""
        last = self._last
        if last is None or last[0] != text:
            try:
                self._last = last = text, self._engine.speak(text)
            except SpeechError as problem:
                raise RobotError(str(problem)) from None
        return last[1]


class Voice:
    """Speaks one text at a time, for as long as the engine of its body says. `move_joints` moves its mouth."""

    def __init__(self, body: Body, move_joints: Callable[[Mapping[str, float]], object] = lambda angles: None) -> None:
        self._synthesizer = Synthesizer(body) if body.voice is not None else None
        self._mouth = body.mouth
        joint = body.joint(body.mouth.joint) if body.mouth is not None else None
        self._joint, self._move_joints = joint, move_joints
        self._shape = "rest"
        self._ended = True
        self.said: Utterance | None = None
        """What it says, or said last."""
        self.position = 0.0
        """Seconds since that began, also after its end; negative before."""

    @property
    def speaking(self) -> bool:
        """True while it speaks, and before it begins."""
        return not self._ended

    @property
    def language(self) -> str:
        """In which it speaks, such as "en"; "" where it doesn't."""
        return "" if self._synthesizer is None else self._synthesizer.language

    def speak_in(self, language: str = "") -> None:
        """See Synthesizer."""
        if self._synthesizer is not None:
            self._synthesizer.speak_in(language)

    def utterance(self, text: str) -> Utterance:
        """The text as it would be said. Raises RobotError where the engine can't."""
        return Utterance(text, 0.0) if self._synthesizer is None else self._synthesizer.speak(text)

    def say(self, text: str, after: float = 0.0) -> None:
        """Speaks after so many seconds, in place of what it is saying. Raises RobotError."""
        self.silence()
        self.said = self.utterance(text)
        self.position, self._ended = -after, False
        self._step(0.0)

    def silence(self) -> None:
        """Ends speech at once; from any thread. The mouth closes at the next step."""
        self._ended = True

    def print(self, text: str) -> None:
        """The screen shows it at once."""

    def step(self, dt: float) -> None:
        """Moves on by `dt` seconds."""
        if not self._ended:
            self._step(dt)
            return
        self.position += dt
        if self._shape != "rest":
            self._show("rest")

    def show(self, shape: str) -> None:
        """The mouth has another shape, a name in SHAPES."""

    def _step(self, dt: float) -> None:
        assert self.said is not None
        self.position += dt
        self._ended = self.position >= self.said.seconds - 1e-9
        if self._mouth is not None:
            self._show("rest" if self._ended else shape_at(self.said, self.position))

    def _show(self, shape: str) -> None:
        if shape == self._shape:
            return
        self._shape = shape
        if self._joint is not None:
            width = self._joint.high - self._joint.low
            with suppress(RobotError):  # speech goes on where the jaw is silent
                self._move_joints({self._joint.name: self._joint.low + SHAPES[shape] * width})
        self.show(shape)
