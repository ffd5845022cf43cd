"""The voice of a robot, which takes its time, its screen, and what it says as a sound file (`btc run --voice`)."""

from __future__ import annotations

import wave
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import unwritable
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body import VoiceSpec as VoiceSettings
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.bodies.speech_tables import engine_of
from btlang.robots.robot import RobotError
from btlang.run.bus import INLINE
from btlang.run.events import Event, PeriodPassed
from btlang.speech.engine import SHAPES, Settings, SpeechError, Utterance, shape_at

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Sink

_LONGEST = 24 * 3600.0  # seconds; WAV ends at 4 GB
_USUAL_RATE = 22_050
_PIECE = 1 << 16


class Synthesizer:
    """The engine of a body's voice, in one language at a time. Raises MissionError (BT071) if it can't be used.

    With `may_estimate` an engine that isn't installed is replaced by one without sound.
    """

    def __init__(self, body: Body, may_estimate: bool = False) -> None:
        self._body, self._may_estimate = body, may_estimate
        self._own = (body.voice or VoiceSettings(Settings())).settings.language
        self.language = self._own
        """The language, such as "en"."""
        self._last: tuple[str, Utterance] | None = None  # gestures ask for the times of what is said next
        try:
            self._engine = engine_of(body, may_estimate=may_estimate)
        except SpeechError as problem:
            from btlang.robots.bodies.body_file import unusable_robot

            raise unusable_robot(problem) from None

    def speak_in(self, language: str = "") -> None:
        """Speak in a language such as "es" from now on, by default in its own. Raises RobotError if it can't."""
        wanted = language or self._own
        if wanted == self.language:
            return
        try:
            self._engine = engine_of(self._body, wanted, self._may_estimate)
        except SpeechError as problem:
            raise RobotError(str(problem)) from None
        self.language, self._last = wanted, None

    def speak(self, text: str) -> Utterance:
        """Return a text as sound and times, and keep it as the latest one. Raises RobotError if the engine can't."""
        last = self._last
        if last is None or last[0] != text:
            try:
                self._last = last = text, self._engine.speak(text)
            except SpeechError as problem:
                raise RobotError(str(problem)) from None
        return last[1]


class TimedVoice:
    """A voice that speaks one text at a time, for as long as the engine of its body says. `move_joints` moves its
    mouth. With `may_estimate` it is silent if that engine isn't installed.
    """

    def __init__(
        self,
        body: Body,
        move_joints: Callable[[Mapping[str, float]], object] = lambda angles: None,
        may_estimate: bool = False,
    ) -> None:
        self._synthesizer = Synthesizer(body, may_estimate) if body.voice is not None else None
        self._mouth = body.mouth
        joint = body.joint(body.mouth.joint) if body.mouth is not None else None
        self._joint, self._move_joints = joint, move_joints
        self._shape = "rest"
        self._ended = True
        self.said: Utterance | None = None
        """The current or the last utterance."""
        self.position = 0.0
        """Seconds since it began, also after its end; negative before."""

    @property
    def speaking(self) -> bool:
        """Whether it speaks, or waits to begin."""
        return not self._ended

    @property
    def language(self) -> str:
        """The language in which it speaks, such as "en"; "" without a voice."""
        return "" if self._synthesizer is None else self._synthesizer.language

    def speak_in(self, language: str = "") -> None:
        if self._synthesizer is not None:
            self._synthesizer.speak_in(language)

    def utterance(self, text: str) -> Utterance:
        """Return the sound and the times of a text. Raises RobotError if the engine can't speak it."""
        return Utterance(text, 0.0) if self._synthesizer is None else self._synthesizer.speak(text)

    def say(self, text: str, after: float = 0.0) -> None:
        """Speak after so many seconds, in place of what it is saying. Raises RobotError."""
        self.silence()
        self.said = self.utterance(text)
        self.position, self._ended = -after, False
        self._step(0.0)

    def silence(self) -> None:
        """End speech at once; from any thread. The mouth closes at the next step."""
        self._ended = True

    def print(self, text: str) -> None:
        """Show a text at once."""

    def step(self, dt: float) -> None:
        """Move on by `dt` seconds."""
        if not self._ended:
            self._step(dt)
            return
        self.position += dt
        if self._shape != "rest":
            self._show("rest")

    def show(self, shape: str) -> None:
        """Give the mouth another shape, a name in SHAPES."""

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


@contextmanager
def voice_track(path: str | None, body: Body) -> Iterator[list[Sink]]:
    """Return the sink that writes everything that is said in a run to a WAV file; none without a path.

    Raises MissionError if the robot has no sound (BT071), or the file can't be written (BT009).
    """
    if path is None:
        yield []
        return
    if body.voice is None or not body.voice.engine:
        raise unusable_robot(SpeechError('--voice needs a voice with an engine; write engine = "espeak" in [voice]'))
    Synthesizer(body)  # a simulated robot also runs without its engine
    try:
        with open(path, "wb") as file, wave.open(file) as sound:
            sound.setnchannels(1)
            sound.setsampwidth(2)
            sound.setframerate(_USUAL_RATE)
            track = VoiceTrack(sound)
            yield [track]
            track.end()
    except OSError as problem:
        raise MissionError([unwritable(path, problem)]) from None


class VoiceTrack:
    """A sink that reads after each period what the robot says, for at most a day. A text that is cut short ends with
    the period.
    """

    policy = INLINE

    def __init__(self, sound: wave.Wave_write) -> None:
        self._sound = sound
        self._said: Utterance | None = None
        self._began, self._over = 0.0, True
        self._now = 0.0
        self._written = 0  # samples

    def __call__(self, event: Event) -> None:
        if not isinstance(event, PeriodPassed) or event.robot is None:
            return
        robot, self._now = event.robot, event.t
        said: Utterance | None = robot.said
        if said is None:
            return
        began = event.t - (robot.time - robot.said_at)
        if said is not self._said or abs(began - self._began) > 1e-6:
            self._write(began)
            self._said, self._began, self._over = said, began, began < 0.0  # of a run before this one
        if not robot.speaking:
            self._write(event.t)

    def end(self) -> None:
        """End the run."""
        self._write(self._now)

    def _write(self, until: float) -> None:
        """Write what is said up to a second of the mission, after silence up to its beginning."""
        if self._over or self._said is None or not self._said.samples:
            return
        self._over = True
        said = self._said
        if not self._written:
            self._sound.setframerate(said.rate)
        begin, end = (round(min(second, _LONGEST) * said.rate) for second in (self._began, until))
        while self._written < begin:
            count = min(begin - self._written, _PIECE)
            self._sound.writeframesraw(bytes(2 * count))
            self._written += count
        samples = said.samples[: 2 * max(0, end - self._written)]
        self._sound.writeframesraw(samples)
        self._written += len(samples) // 2
