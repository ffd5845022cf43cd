"""Words before the head of a noun phrase: `any`, `my`, `Alice's`, `big`, `empty`, `non-red`.

The words for sizes and states are types with names, as colors are. What a thing is said not to be is read from the
names of a further type, `not_color` for `color`. The tree of owners has "" for the words of an owner that nobody
knows: `my` where the world doesn't say what belongs to the speaker.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.text.words import Words
from btlang.vocabulary.references import DENIED, LATEST, Parts
from btlang.vocabulary.word_tree import WordTree, find, tree_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    Names: TypeAlias = Callable[[str], WordTree]

OWNER = "owner"
SPEAKER = "me"
"""The owner of what belongs to whoever gives the robot its missions."""
UNSLOTTED = (OWNER, "size", "state")
"""The parts that no pattern of a noun phrase has a slot for: they are said before its head."""
OF = {name: part for part, name in DENIED.items()}
"""The type that has the words with which a value is denied, by the type of the value."""
_SOMEBODY = "\0"
_BEFORE = ("size", "state", *(part for part in DENIED if part != "not_kind"))


class Adjectives:
    """What may be said before a head, in the words of a language."""

    def __init__(self, language: Mapping[str, Any]) -> None:
        self._determiners = tree_of((phrase, "") for phrase in language["determiners"])
        self._different = tree_of((phrase, "") for phrase in language["others"])
        self.denials: tuple[str, ...] = tuple(language["denials"])
        """The words before an adjective that deny it; one that ends in a hyphen is a part of the word."""
        self._colored: list[str] = language["colored"]
        self._speaker: list[str] = language["possessives"]["speaker"]
        self.own = frozenset(self._speaker)
        """Words for what belongs to who speaks: `my`."""
        self._others: list[str] = language["possessives"]["others"]
        self.ending = next(iter(language["possessive_endings"]), "")
        """What stands behind the name of an owner, and for the verb behind a subject: `the battery's low`."""
        self.other_owners = frozenset(self._others)
        """Words for owners who aren't named: `his`."""
        self._endings: list[str] = language["possessive_endings"]

    def ways(self, kind: str, words: str) -> Iterator[str]:
        """The ways to say a name of a type: `red colored` for a color."""
        yield words
        for head in self._colored if kind == "color" else ():
            yield f"{words} {head}"

    def denied(self, words: str) -> Iterator[str]:
        """The ways to deny an adjective: `non-red`."""
        for before in self.denials:
            yield f"{before}{words}" if before.endswith("-") else f"{before} {words}"

    def owners(self, people: Mapping[str, str], owners: Mapping[str, str]) -> WordTree:
        """The words for owners, from people and owners by their words; nobody owns anything in a world without owners.

        Whose `his` and `her` are depends on the text.
        """
        speaker = SPEAKER if SPEAKER in owners.values() else ""
        named = {words: name if owners else "" for words, name in {**people, **owners}.items() if name != SPEAKER}
        said = {f"{words}{ending}": name for words, name in named.items() for ending in self._endings}
        known = {
            **dict.fromkeys(self._others, _SOMEBODY if owners else ""),
            **dict.fromkeys(self._speaker, speaker),
            **said,
        }
        return tree_of((words.lower(), name) for words, name in known.items())

    def said_owner(self, name: str) -> str:
        """The words that say whose a thing is, "" where the language has none before it."""
        if name == SPEAKER:
            return self._speaker[0]
        return f"{name}{self._endings[0]}" if self._endings else ""

    def read(self, text: Words, at: int, names: Names, determined: bool = True) -> Iterator[tuple[Parts, int]]:
        """Each one that begins at a word, as the parts that it says, and where it ends.

        `any` and the like only where they are `determined`: not before a plural.
        """
        for part in (*_BEFORE, OWNER):
            found = find(names(part), text.words, at)
            last = 0 if found is None else found[1] + (part == OWNER)  # `her the cup` isn't `her cup`
            if found is not None and not any(i in text.articles for i in range(at + 1, last)):
                value = _only_person(text, at, names) if found[0] == _SOMEBODY else found[0]
                yield (((part, value),) if value else ()), found[1]
        other = find(self._different, text.words, at)
        if other is not None:
            yield (("other_than", LATEST),), other[1]
        skipped = find(self._determiners, text.words, at) if determined else None
        if skipped is not None:
            yield (), skipped[1]

    def chains(self, text: Words, at: int, names: Names, determined: bool = True) -> Iterator[tuple[Parts, int]]:
        """The sequences of one or more, each part once; the shortest first."""
        pending: list[tuple[Parts, int]] = [((), at)]
        for parts, end in pending:
            for more, last in self.read(text, end, names, determined):
                if dict(parts).keys().isdisjoint(dict(more)):
                    pending.append(((*parts, *more), last))
        yield from pending[1:]

    def nobody_known(self, text: Words, first: int, last: int, names: Names) -> Iterator[tuple[int, int]]:
        """The words for owners between two words of whom it isn't known what they own."""
        for at in range(first, last):
            found = find(names(OWNER), text.words, at)
            if found is not None and found[1] < last:
                if not found[0] or (found[0] == _SOMEBODY and not _only_person(text, at, names)):
                    yield at, found[1]

    def starts(self, names: Names, is_told: Callable[[str], bool]) -> frozenset[str]:
        """The words at which one may begin that says a part which can be judged."""
        trees = [names(part) for part in (*_BEFORE, OWNER) if is_told(part)]
        return frozenset(word for tree in (*trees, self._determiners, self._different) for word in tree)


def _only_person(text: Words, at: int, names: Names) -> str:
    """The one person whose name is said before a word in its statement, else in the one before it; "" for several."""
    people = _people_before(text, at, names)
    _, first, _ = text.earlier(at)
    if not people and first > 0:
        people = _people_before(text, first - 1, names)
    return people.pop() if len(people) == 1 else ""


def _people_before(text: Words, at: int, names: Names) -> set[str]:
    """The people whose names are said before a word in its statement."""
    before, first, last = text.earlier(at)
    found = (find(names("person"), before.words, place) for place in range(first, last))
    return {each[0] for each in found if each is not None}
