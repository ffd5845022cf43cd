"""What a recogniser of speech is: sound becomes sentences of what is listened for at this moment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    class Recogniser(Protocol):
        """Hears one microphone. Made with RecogniserSettings, and used by one thread apart from the tick.

        No call may take longer than a few hundredths of a second. Raises RecogniserError where it can't be used.
        """

        def expect(self, expected: Expected) -> None:
            """What is listened for from now on, in a sentence under way too."""

        def hear(self, samples: bytes) -> Sequence[Understood]:
            """The next samples, 16 bits signed, mono, 16 kHz. Returns the sentences that have ended in them."""

        def end(self) -> Sequence[Understood]:
            """Nothing follows the samples so far: whoever speaks has let go of the button."""

        def forget(self) -> None:
            """What was heard so far belongs to nothing that follows."""


Mode = Literal["open", "wake", "addressed", "pushed"]
RATE = 16_000
"""Samples a second of what a recogniser hears."""


class RecogniserError(Exception):
    """A recogniser can't be used."""


class RecogniserSettings(Record):
    """A `language` such as "en". With `push`, a button says when somebody speaks, else the recogniser finds out."""

    language: str = "en"
    push: bool = False


class Expected(Record):
    """What is listened for: `phrases` and their `names` as in btlang.speech.grammar, and with `anything` all else too.

    Recognisers that always find the nearest phrase know `others` too, which aren't heard: what could be taken for the
    contrary of a phrase.

    In the `mode` "open" anybody may say anything, in "wake" all phrases begin with the wake word, and in "addressed"
    whoever speaks has woken the robot or was asked, and in "pushed" holds its button.
    """

    phrases: tuple[str, ...] = ()
    names: Mapping[str, tuple[str, ...]] = {}
    anything: bool = False
    mode: Mode = "open"
    others: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.phrases) or self.anything

    def __or__(self, other: Expected) -> Expected:
        """Both."""
        phrases, names = tuple(dict.fromkeys(self.phrases + other.phrases)), {**self.names, **other.names}
        others = tuple(dict.fromkeys(self.others + other.others))
        return Expected(phrases, names, self.anything or other.anything, self.mode, others)


class Understood(Record):
    """A sentence that was said. If it isn't `sure`, it may have been another one."""

    text: str
    sure: bool = True
