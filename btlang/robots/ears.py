"""What the robot hears, and the question that it waits for an answer to."""

from __future__ import annotations

from btlang.record import Record

_MOST = 100


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
        self.asking = ""
        """The open question; "" where there is none."""
        self.answer = ""
        """What answered the last question."""

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
