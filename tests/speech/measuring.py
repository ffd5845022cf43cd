"""How well ears hear: each sentence of some lists, by each of some voices, in some noise."""

from __future__ import annotations

import time
from collections.abc import Sequence

from btlang.actions.conversation import answers, meaning_of
from btlang.robots.bodies.body import Body, EarsSpec
from btlang.speech.engine import Settings
from btlang.speech.listener import Attention
from btlang.speech.pocketsphinx import PocketSphinx
from btlang.speech.recogniser import RATE, Expected, RecognisedSpeech, RecogniserSettings
from btlang.support.record import Record
from tests.speech.sounds import AFTER, guide, lines, recorded

WAKE = "hello robot"
_PIECE = RATE // 10  # bytes: 50 ms, as a microphone gives them


def yes_or_no() -> Expected:
    """All that means yes and no."""
    return answers(("yes", "no"), Body("ears", 0.2, ears=EarsSpec(3.0)))


class Count(Record):
    """How many sentences were right and sure, doubtful (whatever is asked then), wrong but sure; and of how many.

    `late` has the seconds from the end of each sentence until it was understood.
    """

    right: int = 0
    doubtful: int = 0
    wrong: int = 0
    all: int = 0
    late: tuple[float, ...] = ()

    def __add__(self, other: Count) -> Count:
        right, doubtful, wrong, all = (sum(pair) for pair in zip(self.values, other.values, strict=True))
        return Count(right, doubtful, wrong, all, self.late + other.late)

    @property
    def values(self) -> tuple[int, int, int, int]:
        return self.right, self.doubtful, self.wrong, self.all

    @property
    def part(self) -> float:
        """Percent that were right."""
        return 100.0 * self.right / self.all

    @property
    def taken(self) -> float:
        """Percent that were taken for something, rightly or not."""
        return 100.0 * (self.right + self.wrong) / self.all


def count(
    kinds: Sequence[str], expected: Expected, voices: Sequence[Settings], decibels: float, way: str, part: str = "test"
) -> Count:
    """`way` is "push", "wake" or "always"."""
    ears = PocketSphinx(RecogniserSettings(push=way == "push"))
    attention = Attention(WAKE if way == "wake" else "", way == "push")
    ears.expect(attention.expected(expected, False, 0.0))
    total = Count()
    for kind in kinds:
        for text in lines(f"{part}/{kind}.txt"):
            for voice in voices:
                begin = f"{WAKE} " if way == "wake" and kind != "foreign" else ""
                sound = recorded(begin + text, voice, decibels, seed=total.all)
                found, late = heard(ears, sound, way == "push")
                meant = attention.meant(found, 0.0) if found is not None else None
                total += _counted(kind, text, meant, late)
    return total


def heard(ears: PocketSphinx, sound: bytes, pushed: bool) -> tuple[RecognisedSpeech | None, float]:
    """The first sentence, and seconds from the end of the speech: by the sound, and what the computer took then."""
    ended = len(sound) / 2 / RATE - AFTER
    found: RecognisedSpeech | None = None
    late = 0.0
    for at in range(0, len(sound), _PIECE):
        began = time.perf_counter()
        heard = ears.hear(sound[at : at + _PIECE])
        if heard and found is None:
            found, late = heard[0], (at + _PIECE) / 2 / RATE - ended + time.perf_counter() - began
    began = time.perf_counter()
    for each in ears.end():
        if found is None:
            found, late = each, time.perf_counter() - began if pushed else AFTER
    ears.forget()
    return found, late


def _counted(kind: str, text: str, found: RecognisedSpeech | None, late: float) -> Count:
    if found is None:
        return Count(all=1)
    if not found.sure:
        return Count(doubtful=1, all=1, late=(late,))
    same = meaning_of(found.text) == kind if kind in ("yes", "no") else found.text == text
    return Count(right=int(same), wrong=int(not same), all=1, late=(late,))


def everything() -> Expected:
    """What the guide listens for, with yes and no."""
    return guide() | yes_or_no()
