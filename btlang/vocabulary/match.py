"""What is found in a text where a phrase begins: its meaning, where it ends, and the values in its slots."""

from __future__ import annotations

from btlang.support.record import Record
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.references import choice_of


class SlotValue(Record):
    """The value that was read in a slot: its port text and the words `first` to `last` (exclusive).

    Of a list (`the lab, the hall and the dock`) `more` holds the further values; `joiner` is "and", "or", "nor", or ""
    where there are only commas. `every place` is a list, too; its text is "" where there are no such names. `group` is
    the choice of all that such words describe.
    """

    name: str
    type: str
    text: str
    first: int
    last: int
    more: tuple[str, ...] = ()
    joiner: str = ""
    group: str = ""

    @property
    def texts(self) -> tuple[str, ...]:
        """The port texts of the value, or of all values of a list."""
        return self.text, *self.more


class Match(Record):
    """A phrase found in a text, up to word `last` (exclusive)."""

    meaning: Meaning
    last: int
    values: tuple[SlotValue, ...] = ()

    @property
    def nouns(self) -> frozenset[int]:
        """The words of what is described, in which no word defines: `the person who is waving`."""
        described = (value for value in self.values if choice_of(value.text) is not None)
        return frozenset(word for value in described for word in range(value.first, value.last))
