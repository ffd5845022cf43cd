"""What the robot says, as sound: for pages, where the robot has no speaker."""

from __future__ import annotations

import io
import wave
from base64 import b64encode

from btlang.session import Session
from btlang.speech.engine import Utterance
from btlang.task import messages
from btlang.task.checks import refused
from btlang.task.messages import Answer

_LONGEST = 30.0  # seconds


class VoiceHandler:
    """The command `voice`, for any thread."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def sound(self, command: messages.Voice, person: str) -> Answer:
        """What it says now, or said last, from its beginning. Refused if it makes no sound, or plays it itself."""
        robot = self._session.robot
        body, said = getattr(robot, "body", None), getattr(robot, "said", None)
        if body is not None and any(device.kind == "speaker" for device in body.devices):
            raise refused("The robot", "has a speaker, which plays what it says")
        if said is None or not said.samples:
            raise refused("The robot", "has said nothing that can be heard: its voice has no engine, or was silent")
        began = min(max(0.0, robot.time - robot.said_at), said.seconds)
        data = {"wav": b64encode(as_wav(said, _LONGEST)).decode(), "text": said.text, "seconds": began}
        return Answer(True, f'It says "{said.text}".', data)


def as_wav(said: Utterance, longest: float) -> bytes:
    """A file of its first seconds."""
    file = io.BytesIO()
    with wave.open(file, "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(said.rate)
        sound.writeframes(said.samples[: 2 * round(longest * said.rate)])
    return file.getvalue()
