"""Names whose common words are said once: `the first and third floor`, `the red or blue rooms`, `tables 1 and 2`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

from btlang.text.words import END_OF_TEXT, Words
from btlang.vocabulary.word_tree import WordTree, find

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

_LONGEST_FRONT = 2  # words
_LONGEST_NAME = 4  # words


class SharedHeads:
    """Reads such names. `names` gives the words of the names of a type, `joiners` stand between the items of a list.

    `endings` are those of plurals, each by what stands in its place in the singular.
    """

    def __init__(self, names: Callable[[str], WordTree], joiners: Set[str], endings: Mapping[str, str]) -> None:
        self._names, self._joiners = names, joiners
        self._endings = [(many, one) for one, many in endings.items() if many]

    def read(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The name of which only some words stand at a word, and where these end: `first` before `and third floor`."""
        words, tree = text.words, self._names(kind)
        if at and words[at - 1] in self._joiners:
            found = self._plural(tree, words, at) or self._behind(tree, words, at)
            if found is not None:
                return found
        return self._front(tree, words, at) if words[at] in tree else self._several(tree, words, at)

    def _front(self, tree: WordTree, words: Sequence[str], at: int) -> tuple[str, int] | None:
        """The name that words before a joining word begin, and a later item of the list ends."""
        for end in range(at + 1, min(at + 1 + _LONGEST_FRONT, len(words))):
            if words[end] in self._joiners:
                break
        else:
            return None
        item = end
        while words[item] in self._joiners:
            item += 1
        found = self._plural(tree, words, item) or find(tree, words, item) or self._front(tree, words, item)
        name = found[0].lower().split() if found is not None else []
        made = (_name(tree, [*words[at:end], *name[first:]]) for first in range(1, len(name)))
        return next(((each, end) for each in made if each is not None), None)

    def _several(self, tree: WordTree, words: Sequence[str], at: int) -> tuple[str, int] | None:
        """The first of several names whose first word is said once, in the plural: `tables 1 and 2`."""
        for one in self._singulars(words[at]):
            found = find(tree, [one, *words[at + 1 : at + _LONGEST_NAME], END_OF_TEXT], 0) if one in tree else None
            if found is not None and found[1] > 1 and words[at + found[1]] in self._joiners:
                return found[0], at + found[1]
        return None

    def _behind(self, tree: WordTree, words: Sequence[str], at: int) -> tuple[str, int] | None:
        """The name whose first words are those of the item before: `landmark one and two`."""
        end = at
        while end and words[end - 1] in self._joiners:
            end -= 1
        for first in range(end - 1, max(end - _LONGEST_NAME, 0) - 1, -1):
            before = find(tree, words, first) or self._several(tree, words, first)
            if before is None and first and words[first - 1] in self._joiners:
                before = self._behind(tree, words, first)
            if before is not None and before[1] == end and " " in before[0]:
                made = _name(tree, [*before[0].lower().split()[:-1], words[at]])
                return (made, at + 1) if made is not None else None
        return None

    def _plural(self, tree: WordTree, words: Sequence[str], at: int) -> tuple[str, int] | None:
        """A name in the plural: `third floors`."""
        for last in range(at, min(at + _LONGEST_NAME, len(words))):
            for one in self._singulars(words[last]):
                made = _name(tree, [*words[at:last], one])
                if made is not None:
                    return made, last + 1
        return None

    def _singulars(self, word: str) -> Iterator[str]:
        for many, one in self._endings:
            if word.endswith(many) and word != many:
                yield word.removesuffix(many) + one


def _name(tree: WordTree, words: Sequence[str]) -> str | None:
    """The name that has exactly these words."""
    found = find(tree, [*words, END_OF_TEXT], 0)
    return found[0] if found is not None and found[1] == len(words) else None
