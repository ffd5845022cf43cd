"""What an engine of speech is: a text becomes sound with the times of its words, phonemes and shapes of a mouth."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    class SpeechEngine(Protocol):
        """An engine that speaks texts, made with Settings. The same text always gives the same utterance."""

        def speak(self, text: str) -> Utterance:
            """Return the text as sound and times; for any thread. Raises SpeechError."""


WORD = re.compile(r"\S+")
SHAPES = {"rest": 0.0, "closed": 0.0, "teeth": 0.2, "narrow": 0.3, "round": 0.5, "wide": 0.6, "open": 1.0}
"""How far the mouth is open in each shape, 0 to 1."""
_LETTERS = {
    letter: shape
    for shape, letters in {
        "closed": "pbmM", "teeth": "fv", "round": "ouwOUWyY", "wide": "eiEIj", "open": "aAVQ03@&",
    }.items()
    for letter in letters
}  # fmt: skip


class SpeechError(Exception):
    """The reason why an engine can't be used, or can't speak a text."""


class MissingEngine(SpeechError):
    """The package that an engine needs, which isn't installed."""


class Settings(Record):
    """The settings of a voice: a `language` such as "en", a `variant`, words a minute, and a pitch from 0 to 100.

    An engine without sound takes `text` seconds for each text, and `character` for each character.
    """

    language: str = "en"
    variant: str = ""
    speed: float = 160.0
    pitch: float = 50.0
    text: float = 0.35
    character: float = 0.06


class Word(Record):
    """A word of a text from index `start` to `end`, spoken at `time` for `seconds`."""

    text: str
    start: int
    end: int
    time: float
    seconds: float


class Phoneme(Record):
    """A sound that begins at `time`; "" is a pause. `name` is as in Kirshenbaum's ASCII-IPA."""

    name: str
    time: float


class Utterance(Record):
    """A spoken text. Times are seconds since it began; `samples` are 16 bits, mono, at `rate`, b"" without sound."""

    text: str
    seconds: float
    words: tuple[Word, ...] = ()
    phonemes: tuple[Phoneme, ...] = ()
    samples: bytes = b""
    rate: int = 0

    def time_of(self, index: int) -> float:
        """Return when the first word at or after an index of the text begins; after the last word, the end."""
        return next((word.time for word in self.words if word.start >= index), self.seconds)

    def word_at(self, time: float) -> Word | None:
        """Return the word that is spoken at a time, or was last; the first one before that, None without words."""
        at = bisect_right(self.words, time, key=lambda word: word.time)
        return self.words[max(0, at - 1)] if self.words else None


def words_at(text: str, starts: Sequence[tuple[int, float]], seconds: float) -> tuple[Word, ...]:
    """Return the words of a text.

    `starts` are indices and times at which something is spoken, in order. A word without a start begins with the next
    one.
    """
    found, at = [], 0
    for match in WORD.finditer(text):
        while at < len(starts) and starts[at][0] < match.start():
            at += 1
        found.append((match, starts[at][1] if at < len(starts) else seconds))
    times = [*(time for _, time in found), seconds]
    return tuple(
        Word(match[0], *match.span(), time, max(0.0, times[at + 1] - time)) for at, (match, time) in enumerate(found)
    )


def shape_of(phoneme: str) -> str:
    """Return the shape of a phoneme, a name in SHAPES: "rest" for "", a pause."""
    letter = phoneme.lstrip("',%=_|")[:1]
    return _LETTERS.get(letter, "narrow") if letter else "rest"


def shape_at(utterance: Utterance, time: float) -> str:
    """Return the shape at a time of an utterance; "rest" before and after it."""
    at = bisect_right(utterance.phonemes, time, key=lambda phoneme: phoneme.time)
    return shape_of(utterance.phonemes[at - 1].name) if at and time < utterance.seconds else "rest"


class Estimate:
    """An engine without sound, which estimates times. Letters stand for their phonemes."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings

    def speak(self, text: str) -> Utterance:
        """Return the text with times that are shared out by letters, at once."""
        begin, each = self._settings.text, self._settings.character
        seconds = begin + each * len(text)
        starts = [(match.start(), begin + each * match.start()) for match in WORD.finditer(text)]
        sounds = (
            Phoneme(letter.lower() if letter.isalpha() else "", begin + each * at) for at, letter in enumerate(text)
        )
        return Utterance(text, seconds, words_at(text, starts, seconds), (*sounds, Phoneme("", seconds)))
