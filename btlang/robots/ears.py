"""What a robot hears and listens for, the question that it waits for an answer to, and files with answers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf

from btlang.robots.files import DataFileError, as_mission_error, load_data
from btlang.speech.recogniser import Expected, spoken
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.toml_table import Problem, Table

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_MOST = 100
_LISTENS = 5.0  # seconds for which it listens for what a condition has looked for


class HeardText(Record):
    """A text that somebody said at a second of the run; `who` is "" if that isn't known."""

    text: str
    who: str
    time: float


class Ears:
    """The latest 100 texts that the robot has heard, and what it listens for.

    `hear` takes typed answers as well as what people in the world say.
    """

    def __init__(self) -> None:
        self._heard: list[HeardText] = []
        self._count = 0
        self._awaited: list[Expected] = []
        self._looks: dict[str, tuple[float, int, int]] = {}
        self.asking = ""
        """The open question; "" if there is none."""
        self.answer = ""
        """The answer to the last question."""
        self.commands: Any = None
        """The commands that people may speak (SpokenCommands); None for none."""
        self.problem = ""
        """Why only typed texts are heard; "" while the ears work."""
        self.talk: Callable[[bool], object] | None = None
        """A function to press and release a remote talk button; None if it needs none."""
        self.choices: tuple[str, ...] = ()
        """The answers that the mission asks about: "if the answer is tea"."""

    def begin(self) -> None:
        """Begin a run, without a question and without anything to listen for."""
        self.asking = self.answer = ""
        self._awaited, self._looks = [], {}

    @property
    def count(self) -> int:
        """How many texts were heard so far."""
        return self._count

    def since(self, count: int) -> list[HeardText]:
        """Return what was heard after so many texts, oldest first."""
        new = self._count - count
        return self._heard[-new:] if new > 0 else []

    def hear(self, text: str, who: str = "", time: float = 0.0) -> None:
        """Take a text that somebody said or typed."""
        self._heard = [*self._heard[-_MOST + 1 :], HeardText(text, who, time)]
        self._count += 1

    @contextmanager
    def expect(self, expected: Expected) -> Iterator[None]:
        """Listen for this in the meantime."""
        self._awaited = [*self._awaited, expected]
        try:
            yield
        finally:
            self._awaited = [each for each in self._awaited if each is not expected]

    def news(self, text: str, now: float) -> list[HeardText]:
        """Return what was heard since the last search for this text, and may contain it; nothing at the first search.

        The robot listens for the text until 5 seconds after the last search. All who search at one time get the same.
        """
        looked, before, then = self._looks.get(text, (-inf, 0, 0))
        if now - looked > _LISTENS:
            before = self._count
        elif now != looked:
            before = then
        self._looks[text] = now, before, self._count
        return self.since(before)

    def expected(self, now: float) -> Expected:
        """Return what the robot listens for."""
        texts = [spoken(text) for text, (looked, _, _) in self._looks.items() if now - looked <= _LISTENS]
        found = Expected(tuple(filter(None, texts)), anything="" in texts)
        for each in self._awaited:
            found |= each
        return found


class AnswersError(DataFileError):
    """The reason why a file of answers can't be used."""

    code = "BT073"


def read_answers(file: str | Source) -> dict[str, list[str]]:
    """Read answers by words of the question, "*" for any: `"coffee" = "yes"`, or a list of them in order.

    Raises MissionError (BT073).
    """
    try:
        return load_data(file, "answers", _answers, AnswersError)
    except AnswersError as error:
        raise as_mission_error(error) from None


def _answers(top: Table) -> dict[str, list[str]]:
    return {words: _texts(top, words) for words in top.keys()}  # noqa: SIM118 - it is no dict


def _texts(top: Table, words: str) -> list[str]:
    texts = list(top.texts(words)) if top.is_list(words) else [top.text(words)]
    if not texts:
        raise Problem(f'an answer is a text or a list of texts; write "{words}" = "yes"', words)
    return texts
