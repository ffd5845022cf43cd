"""`btc run --voice`: what a robot says, as a sound file."""

from __future__ import annotations

import wave
from collections.abc import Iterator
from contextlib import contextmanager

from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import unwritable
from btlang.robots.body import Body
from btlang.robots.body_file import unusable_robot
from btlang.run.bus import INLINE
from btlang.run.events import Event, PeriodPassed
from btlang.speech.engine import SpeechError, Utterance

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Sink

_LONGEST = 24 * 3600.0  # seconds; WAV ends at 4 GB
_USUAL_RATE = 22_050
_PIECE = 1 << 16


@contextmanager
def voice_track(path: str | None, body: Body) -> Iterator[list[Sink]]:
    """The sink that writes all that is said in a run to a WAV file, at its time; none without a path.

    Raises MissionError where the robot has no sound (BT071), or the file can't be written (BT009).
    """
    if path is None:
        yield []
        return
    if body.voice is None or not body.voice.engine:
        raise unusable_robot(SpeechError('--voice needs a voice with an engine; write engine = "espeak" in [voice]'))
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
    """A sink. Reads after each period what the robot says; what is cut short ends with the period. At most a day."""

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
        """The run is over."""
        self._write(self._now)

    def _write(self, until: float) -> None:
        """What is said, up to a second of the mission, behind silence up to its beginning."""
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
