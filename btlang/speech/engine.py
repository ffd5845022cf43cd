"""What an engine of speech is: a text becomes sound, with the times of its words and phonemes."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    class SpeechEngine(Protocol):
        """Speaks texts. Made with Settings. The same text always gives the same utterance."""

        def speak(self, text: str) -> Utterance:
            """The text as sound and times; for any thread. Raises SpeechError."""


WORD = re.compile(r"\S+")


class SpeechError(Exception):
    """An engine can't be used, or can't speak a text."""


class Settings(Record):
    """How to speak: a `language` such as "en", a `variant` of its voice, words a minute, and a pitch from 0 to 100.

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
        """When the first word begins that is at an index of the text or behind it; after the last one the end."""
        return next((word.time for word in self.words if word.start >= index), self.seconds)

    def word_at(self, time: float) -> Word | None:
        """The word that is spoken at a time, or was last; the first one before that, None where there is no word."""
        at = bisect_right(self.words, time, key=lambda word: word.time)
        return self.words[max(0, at - 1)] if self.words else None


def words_at(text: str, starts: Sequence[tuple[int, float]], seconds: float) -> tuple[Word, ...]:
    """The words of a text. `starts` are indices and times at which something is spoken, in order.

    A word without a start begins with the next one.
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
