"""What `one` stands for: the noun of the thing before it, as in `the red cup, then the blue one`."""

from __future__ import annotations

from btlang.text.words import END_OF_TEXT, Words
from btlang.vocabulary.likenesses import Likenesses
from btlang.vocabulary.nouns import Description
from btlang.vocabulary.value_type import OBJECT, PLACE
from btlang.vocabulary.word_tree import WordTree, find

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Set

_LONGEST_NAME = 4  # words
_NOT_IN_NAMES = frozenset((",", ";", ":", "(", ")", END_OF_TEXT))


class Antecedents:
    """The nouns before a word. `ones` are the words in their place, `definite` is the article of what was spoken of,
    `names` gives the words of the names of a type.
    """

    def __init__(self, ones: Set[str], definite: str, names: Callable[[str], WordTree], likenesses: Likenesses) -> None:
        self._ones, self._definite, self._names, self._likenesses = ones, definite, names, likenesses

    def resolved(self, found: tuple[Description, int], text: Words, at: int) -> tuple[Description, int] | None:
        """What is described, with the kind of the thing before where `one` is its head; None where nothing is meant.

        A color alone describes any thing that has it.
        """
        meant, end = found
        if text.words[end - 1] not in self._ones:
            return found
        kind, noun = self._before(meant.type, text, at)
        if not kind or not meant.parts:
            is_any = meant.type == OBJECT and (noun or not self._before(PLACE, text, at)[1])
            return found if is_any and "color" in dict(meant.parts) else None
        return meant.replace(parts=tuple(sorted((*meant.parts, ("kind", kind))))), end

    def named(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """A name whose last word is that of a name before, and not said again: `the second one`."""
        for end in range(at + 1, at + _LONGEST_NAME):
            if text.words[end] in _NOT_IN_NAMES:
                return None
            if text.words[end] in self._ones:
                words = [*text.words[at:end], self._before(kind, text, at)[1], END_OF_TEXT]
                found = find(self._names(kind), words, 0)
                return (found[0], end + 1) if found is not None and found[1] == len(words) - 1 else None
        return None

    def is_same(self, text: Words, at: int, latest: str) -> bool:
        """Whether a noun with a definite article may be that of the place spoken of before: `the room` for the lab.

        Of what is chosen in rounds it isn't known which it is: the noun may be that of any.
        """
        article = text.articles.get(at)
        is_definite = article is not None and text.source.text[slice(*article)].lower() == self._definite
        return is_definite and (latest[:1] == "{" or text.words[at] == self._likenesses.kind_of(PLACE, latest))

    def kind_of_one(self, kind: str, text: Words, at: int, latest: str) -> str:
        """The kind that `one` at a word has: that of the latest value of a type, where that is a name.

        Of an object that the robot chose, or that was only spoken of, it is that of the noun before.
        """
        if latest[:1] != "{" or kind != OBJECT:
            return "" if latest[:1] == "{" else self._likenesses.kind_of(kind, latest)
        here, first, _ = text.earlier(at)
        found = self._before(kind, text, at)[0]
        return found or (self._before(kind, here, first - 1)[0] if first else "")

    def _before(self, kind: str, text: Words, at: int) -> tuple[str, str]:
        """The kind, and the last word, of the latest name or noun of a type before a word in its statement."""
        text, start, at = text.earlier(at)
        end, kind_of, noun = 0, "", ""
        for first in range(at - 1, start - 1, -1):
            named = find(self._names(kind), text.words, first)
            if named is not None and end <= named[1] <= at:
                end, noun = named[1], text.words[named[1] - 1]
                kind_of = self._likenesses.kind_of(kind, named[0])
            for tree in ("kind", "kinds"):
                of = find(self._names(tree), text.words, first)
                if of is not None and end < of[1] <= at and kind in self._likenesses.types_of(of[0]):
                    end, kind_of, noun = of[1], of[0], text.words[of[1] - 1]
        return kind_of, noun
