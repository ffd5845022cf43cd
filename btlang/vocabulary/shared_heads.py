"""Names whose words are said otherwise: `the first and third floor`, `tables 1 and 2`, `the door of the kitchen`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set

from btlang.text.words import END_OF_TEXT, Words
from btlang.vocabulary.nouns import plural
from btlang.vocabulary.value_type import DOOR
from btlang.vocabulary.word_tree import END, WordTree, find

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

_LONGEST_FRONT = 2  # words
_LONGEST_NAME = 4  # words
_MOST_ITEMS = 16  # of a list whose last one ends them all, and of a range


class SharedHeads:
    """Reads such names. `names` gives the words of the names of a type, `joiners` stand between the items of a list.

    `endings` are those of plurals, by the endings in the singular; `belonging` are the words behind the last one of a
    door's name and before the others.
    """

    def __init__(
        self, names: Callable[[str], WordTree], joiners: Set[str], endings: Mapping[str, str], belonging: Set[str]
    ) -> None:
        self._names, self._joiners, self._endings, self._belonging = names, joiners, endings, belonging
        self._ends: dict[str, tuple[dict[str, str], dict[str, str]]] = {}

    def read(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The name of which only some words stand at a word, and where these end: `first` before `and third floor`."""
        memo: dict[tuple[int, str], Any] = text.memo.setdefault(self, {})
        if (at, kind) not in memo:
            memo[at, kind] = self._read(kind, text, at)
        return memo[at, kind]  # type: ignore[no-any-return]

    def between(self, kind: str, words: Sequence[str], at: int, last: str) -> list[str]:
        """The numbers behind the first of `rooms 201 to 206` up to the last, if each is in a name; else none."""
        one, number = self._plurals(kind)[0].get(words[at], words[at]), words[at + 1]
        if not (one and number.isdecimal() and last.isdecimal() and 0 < int(last) - int(number) <= _MOST_ITEMS):
            return []
        numbers = [str(each).zfill(len(number)) for each in range(int(number), int(last) + 1)]
        tree = self._names(kind)
        return numbers[1:] if all(_name(tree, [one, each]) is not None for each in numbers) else []

    def behind_last(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The name of which the last word stands at a word, and the others behind it: `the door of the kitchen`."""
        words = text.words
        if kind != DOOR or at + 1 >= len(words) or words[at + 1] not in self._belonging:
            return None
        for end in range(min(at + 2 + _LONGEST_NAME, len(words)), at + 2, -1):
            made = _name(self._names(kind), [*words[at + 2 : end], words[at]])
            if made is not None:
                return made, end
        return None

    def _read(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        words = text.words
        if at and words[at - 1] in self._joiners:
            found = self._plural(kind, words, at) or self._behind(kind, text, at)
            if found is not None:
                return found
        if words[at] in self._names(kind):
            return self._front(kind, words, at, _MOST_ITEMS)
        return self._several(kind, words, at)

    def _front(self, kind: str, words: Sequence[str], at: int, most: int) -> tuple[str, int] | None:
        """The name that words before a joining word begin, and one of the next items of the list ends."""
        ends = range(at + 1, min(at + 1 + _LONGEST_FRONT, len(words)))
        end = next((end for end in ends if words[end] in self._joiners), 0)
        if not end or not most:
            return None
        item, tree = end, self._names(kind)
        while words[item] in self._joiners:
            item += 1
        found = self._plural(kind, words, item) or find(tree, words, item) or self._front(kind, words, item, most - 1)
        name = found[0].lower().split() if found is not None else []
        made = (_name(tree, [*words[at:end], *name[first:]]) for first in range(1, len(name)))
        return next(((each, end) for each in made if each is not None), None)

    def _several(self, kind: str, words: Sequence[str], at: int) -> tuple[str, int] | None:
        """The first of several names whose first word is said once, in the plural: `tables 1 and 2`."""
        one = self._plurals(kind)[0].get(words[at])
        if one is None:
            return None
        found = find(self._names(kind), [one, *words[at + 1 : at + _LONGEST_NAME], END_OF_TEXT], 0)
        ends_item = found is not None and found[1] > 1 and words[at + found[1]] in self._joiners
        return (found[0], at + found[1]) if found is not None and ends_item else None

    def _behind(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The name whose first words are those of the item before: `landmark one and two`."""
        words, tree, end = text.words, self._names(kind), at
        if plural(words[at], self._endings) not in self._plurals(kind)[1]:
            return None  # as nearly always
        while end and words[end - 1] in self._joiners:
            end -= 1
        for first in range(end - 1, max(end - _LONGEST_NAME, 0) - 1, -1):
            is_item = first > 0 and words[first - 1] in self._joiners
            before = find(tree, words, first) or (self.read(kind, text, first) if is_item else None)
            before = before or self._several(kind, words, first)
            if before is not None and before[1] == end and " " in before[0]:
                made = _name(tree, [*before[0].lower().split()[:-1], words[at]])
                return (made, at + 1) if made not in (None, before[0]) else None  # `a red cup and a cup` are two
            if is_item:
                break
        return None

    def _plural(self, kind: str, words: Sequence[str], at: int) -> tuple[str, int] | None:
        """A name in the plural: `third floors`."""
        ends = self._plurals(kind)[1]
        for last in range(at, min(at + _LONGEST_NAME, len(words))):
            made = _name(self._names(kind), [*words[at:last], ends[words[last]]]) if words[last] in ends else None
            if made is not None:
                return made, last + 1
        return None

    def plural_firsts(self, kind: str) -> Iterable[str]:
        """The words in the plural at which several names of a type may begin."""
        return self._plurals(kind)[0]

    def _plurals(self, kind: str) -> tuple[dict[str, str], dict[str, str]]:
        """The first and the last words of the names of a type that have several, by their plurals."""
        if kind not in self._ends:
            firsts: dict[str, str] = {}
            lasts: dict[str, str] = {}
            pending = [(word, "", node) for word, node in self._names(kind).items() if word != END]
            while pending:
                word, first, node = pending.pop()
                if END in node and first:
                    firsts[plural(first, self._endings)] = first
                    lasts[plural(word, self._endings)] = word
                pending += [(more, first or word, below) for more, below in node.items() if more != END]
            self._ends[kind] = firsts, lasts
        return self._ends[kind]


def _name(tree: WordTree, words: Sequence[str]) -> str | None:
    """The name that has exactly these words."""
    found = find(tree, [*words, END_OF_TEXT], 0)
    return found[0] if found is not None and found[1] == len(words) else None
