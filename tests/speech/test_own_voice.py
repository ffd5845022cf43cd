"""A robot doesn't hear its own voice in its microphone, and hears who speaks half a second later."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from btlang.components.parts import hearing
from btlang.components.parts.hearing import Hearing
from btlang.devices.kinds import Sound
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body import EarsSpec as EarsOfBody
from btlang.robots.ears import Ears
from btlang.speech.engine import Settings
from btlang.speech.marks import without_marks
from btlang.speech.pocketsphinx import PocketSphinx
from btlang.speech.recogniser import RATE, RecognisedSpeech, RecogniserSettings
from tests.profiles import amount
from tests.speech.measuring import everything
from tests.speech.sounds import LIGHT, VOICES, Samples, lines, room, speech

pytest.importorskip("pocketsphinx")

VOICE = Settings(variant="f3")
"""Of the guide."""
EXAMPLES = Path(__file__).parents[2] / "examples" / "guide"
ECHO, AFTERWARDS = 0.2, 0.5
"""Seconds until the hall answers, and from the end of its voice until a person begins."""
_PIECE = RATE // 20
_SAYS = re.compile(r'\b(?:say|ask)\b[^"\n]*"([^"]+)"')


class Direct:
    """A listener without a thread: what it hears is decoded at once."""

    problem = ""

    def __init__(self, recogniser: PocketSphinx) -> None:
        self._recogniser, self._found = recogniser, list[RecognisedSpeech]()
        self.expect, self.forget = recogniser.expect, recogniser.forget

    def hear(self, samples: bytes) -> None:
        self._found += self._recogniser.hear(samples)

    def understood(self) -> RecognisedSpeech | None:
        return self._found.pop(0) if self._found else None


class Room:
    """A robot that listens all the time to all of the guide, in a quiet room; its clock goes with the sound."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        settings = RecogniserSettings()
        body = Body("listener", 0.2, ears=EarsOfBody(3.0, "pocketsphinx", settings))
        recogniser = PocketSphinx(settings)
        monkeypatch.setattr(hearing, "Listener", Direct)
        monkeypatch.setattr(hearing, "recogniser_of", lambda body: recogniser)
        self.heard: list[str] = []
        self._take: Any = None
        self._robot = SimpleNamespace(
            ears=Ears(), time=0.0, speaking=False, refuses=False, body=body, say=self.ask, hear=self.heard.append
        )
        devices: Any = SimpleNamespace(
            first=lambda kind: "microphone",
            loops=[SimpleNamespace(devices={"microphone": None})],
            devices={},
            follow=self.follow,
        )
        self._hearing = Hearing(body, self._robot, devices, lambda kind, data: None)
        self._listens = self._robot.ears.expect(everything())
        self._listens.__enter__()

    def follow(self, name: str, take: Any) -> None:
        self._take = take

    def ask(self, question: str) -> None:
        """Not quite sure of something that was said."""
        self.heard.append(question)

    def listen(self, own: Samples, other: Samples, seed: int) -> list[str]:
        """What it heard while it spoke, with an echo, and from somebody after that."""
        begin, count = RATE // 2, len(own)
        end = begin + count
        sound = room((end + AFTERWARDS * RATE + len(other)) / RATE + 1.2, LIGHT, seed)
        sound[begin:end] += own
        sound[begin + int(ECHO * RATE) : end + int(ECHO * RATE)] += 0.5 * own
        person = end + int(AFTERWARDS * RATE)
        sound[person : person + len(other)] += other
        samples = np.clip(sound, -32768, 32767).astype("<i2")
        self.heard.clear()
        for at in range(0, len(samples), _PIECE):
            self._robot.speaking = begin <= at < end
            self._take(Sound(samples[at : at + _PIECE].tobytes(), RATE))
            self._robot.time += 0.05
            self._hearing.step()
        self._hearing._doubtful = ""
        return list(self.heard)


def own_sentences() -> list[str]:
    """All that the guide says, and all that it listens for."""
    files = [*sorted((EXAMPLES / "missions").glob("*.txt")), EXAMPLES / "house_rules.txt"]
    missions = "\n".join(path.read_text(encoding="utf-8") for path in files)
    said = [without_marks(text) for text in _SAYS.findall(missions)]
    return [
        *said,
        *(
            text
            for part in ("test", "train", "confirm")
            for kind in ("good", "yes", "no")
            for text in lines(f"{part}/{kind}.txt")
        ),
    ]


@pytest.mark.long
def test_its_own_voice_is_never_heard(monkeypatch: pytest.MonkeyPatch) -> None:
    robot, sentences = Room(monkeypatch), own_sentences()
    some = sentences[:: max(1, len(sentences) // amount(8, len(sentences)))]
    heard = {text: robot.listen(speech(text, VOICE), np.zeros(0), seed) for seed, text in enumerate(some)}
    print(f"{len(some)} of its own sentences, {sum(map(bool, heard.values()))} heard")
    assert {text: found for text, found in heard.items() if found} == {}


@pytest.mark.long
def test_who_speaks_after_it_is_heard_as_well_as_without(monkeypatch: pytest.MonkeyPatch) -> None:
    robot, right, alone = Room(monkeypatch), 0, 0
    own, quiet = speech("Which way would you like to go?", VOICE), np.zeros(0)
    texts = lines("test/good.txt")[: amount(3, 100)]
    for seed, text in enumerate(texts):
        person = speech(text, VOICES["test"][0])
        alone += text in robot.listen(quiet, person, seed)
        right += text in robot.listen(own, person, seed)
    print(f"after its voice {right}, without {alone}, of {len(texts)}")
    assert right >= alone - amount(0, 2)
    assert right >= 0.7 * len(texts)
