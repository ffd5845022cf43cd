"""Shapes of the mouth for phonemes."""

from __future__ import annotations

from bisect import bisect_right

from btlang.speech.engine import Utterance

SHAPES = {"rest": 0.0, "closed": 0.0, "teeth": 0.2, "narrow": 0.3, "round": 0.5, "wide": 0.6, "open": 1.0}
"""How far the mouth is open in each, 0 to 1."""
_LETTERS = {
    letter: shape
    for shape, letters in {
        "closed": "pbmM", "teeth": "fv", "round": "ouwOUWyY", "wide": "eiEIj", "open": "aAVQ03@&",
    }.items()
    for letter in letters
}  # fmt: skip


def shape_of(phoneme: str) -> str:
    """A name in SHAPES for a phoneme: "rest" for "", a pause."""
    letter = phoneme.lstrip("',%=_|")[:1]
    return _LETTERS.get(letter, "narrow") if letter else "rest"


def shape_at(utterance: Utterance, time: float) -> str:
    """The shape at a time of an utterance; "rest" before and after it."""
    at = bisect_right(utterance.phonemes, time, key=lambda phoneme: phoneme.time)
    return shape_of(utterance.phonemes[at - 1].name) if at and time < utterance.seconds else "rest"
