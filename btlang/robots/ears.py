"""What the robot hears, what it listens for at this moment, and the question that it waits for an answer to."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf

from btlang.speech.grammar import spoken
from btlang.speech.recogniser import Expected
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 100
_LISTENS = 5.0  # seconds for which it listens for what a condition has looked for


class Heard(Record):
    """A text that somebody said at a second of the run; `who` is "" where that isn't known."""

    text: str
    who: str
    time: float


class Ears:
    """The latest 100 texts. Who types an answer, and whoever speaks in the world, is heard by `hear`."""

    def __init__(self) -> None:
        self._heard: list[Heard] = []
        self._count = 0
        self._awaited: list[Expected] = []
        self._looks: dict[str, tuple[float, int, int]] = {}
        self.asking = ""
        """The open question; "" if there is none."""
        self.answer = ""
        """What answered the last question."""
        self.commands: Any = None
        """A btlang.robots.spoken.SpokenCommands: those that people may speak; None where there are none."""
        self.problem = ""
        """Why nothing is heard but what is typed; "" while the ears work."""
        self.talk: Callable[[bool], object] | None = None
        """Somebody holds, or lets go of, the button that isn't one of the robot; None where it needs none."""
        self.choices: tuple[str, ...] = ()
        """The answers that the mission asks about: "if the answer is tea"."""

    def begin(self) -> None:
        """A run begins: nobody is asked anything, and nothing is listened for."""
        self.asking = self.answer = ""
        self._awaited, self._looks = [], {}

    @property
    def count(self) -> int:
        """How many texts were heard so far."""
        return self._count

    def since(self, count: int) -> list[Heard]:
        """What was heard after so many texts, oldest first."""
        new = self._count - count
        return self._heard[-new:] if new > 0 else []

    def hear(self, text: str, who: str = "", time: float = 0.0) -> None:
        """Somebody said this, or typed it."""
        self._heard = [*self._heard[-_MOST + 1 :], Heard(text, who, time)]
        self._count += 1

    @contextmanager
    def awaiting(self, expected: Expected) -> Iterator[None]:
        """Listens for this meanwhile."""
        self._awaited = [*self._awaited, expected]
        try:
            yield
        finally:
            self._awaited = [each for each in self._awaited if each is not expected]

    def news(self, text: str, now: float) -> list[Heard]:
        """What was heard since this text was last looked for, and may contain it; nothing at the first look.

        The robot listens for the text until 5 seconds after the last look. All who look at one time see the same.
        """
        looked, before, then = self._looks.get(text, (-inf, 0, 0))
        if now - looked > _LISTENS:
            before = self._count
        elif now != looked:
            before = then
        self._looks[text] = now, before, self._count
        return self.since(before)

    def expected(self, now: float) -> Expected:
        """What the robot listens for."""
        texts = (spoken(text) for text, (looked, _, _) in self._looks.items() if now - looked <= _LISTENS)
        found = Expected(tuple(filter(None, texts)))
        for each in self._awaited:
            found |= each
        return found
