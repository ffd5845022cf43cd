"""What `one` stands for: the noun of the thing before it, as in `the red cup, then the blue one`."""

from __future__ import annotations

from itertools import chain

from btlang.text.words import END_OF_TEXT, Words
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.likenesses import Likenesses
from btlang.vocabulary.nouns import Description
from btlang.vocabulary.references import NAMES, RELATIONS, choice_of
from btlang.vocabulary.value_type import OBJECT, PLACE
from btlang.vocabulary.word_tree import WordTree, find

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence, Set
    from typing import Protocol

    from btlang.vocabulary.adjectives import Adjectives
    from btlang.vocabulary.descriptions import Modifiers
    from btlang.vocabulary.references import Parts

    class Reading(Protocol):
        """What is known where `one` is read."""

        latest: dict[str, str]
        listed: dict[str, str]
        of_kind: dict[str, str]
        modifiers: frozenset[str]
        joiners: frozenset[str]

        def described(self, kind: str, how: str, parts: Parts) -> str:
            """The choice of a name that has these parts."""


_LONGEST_NAME = 4  # words
_MOST_ADJECTIVES = 3  # words
_NOT_IN_NAMES = frozenset((",", ";", ":", "(", ")", END_OF_TEXT))


def pronouns_for(pronouns: Mapping[str, Sequence[str]], kind: str, *, alone: bool = False) -> list[str]:
    """The pronouns that may stand for a value of a type; with `alone` those for no other type."""
    return [word for word, types in pronouns.items() if kind in types and not (alone and len(types) > 1)]


def says_there(words: str, pronouns: Mapping[str, Sequence[str]]) -> bool:
    """Whether words end with a pronoun for a place: `Bob is there`."""
    return words.lower().endswith(tuple(f" {word}" for word in pronouns_for(pronouns, PLACE)))


class Antecedents:
    """The nouns before a word. `ones` are the words in their place, `definite` is the article of what was spoken of,
    `names` gives the words of the names of a type.

    Behind one of the `prepositions` the noun behind the same one before is meant: `the cup in the blue box and the
    plate in the red one`.
    """

    def __init__(
        self,
        ones: Set[str],
        prepositions: Set[str],
        definite: str,
        names: Callable[[str], WordTree],
        likenesses: Likenesses,
        adjectives: Adjectives,
    ) -> None:
        self._ones, self._prepositions, self._definite = ones, prepositions, definite
        self._names, self._likenesses, self._adjectives = names, likenesses, adjectives

    def resolved(self, found: tuple[Description, int], text: Words, at: int) -> tuple[Description, int] | None:
        """What is described, with the kind of the thing before where `one` is its head; None where nothing is meant.

        A color alone describes any thing that has it.
        """
        meant, end = found
        if text.words[end - 1] not in self._ones:
            return found
        alike = self._behind_preposition(text, at)
        if alike.get(meant.type) is None and alike:
            return None  # `the cup in the box and the plate in the red one`: no thing that is red
        kind, noun = (alike[meant.type],) * 2 if alike else self._before(meant.type, text, at)
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

    def by_name(self, kind: str, text: Words, at: int, chosen: tuple[str, int], person: str) -> tuple[str, int]:
        """One of a kind whose name stands behind it, `nurse Alice`, or has a person's: `his room` for `Bob's room`."""
        names, choice = self._names(kind), choice_of(chosen[0])
        is_owned = text.words[at] in self._adjectives.other_owners and person[:1] not in ("", "{")
        whole = person.lower().split()
        for owner in (whole, whole[:1], whole[-1:]) if is_owned else ():
            words = [*owner[:-1], owner[-1] + self._adjectives.ending, *text.words[at + 1 : chosen[1]], END_OF_TEXT]
            found = find(names, words, 0)
            if found is not None and found[1] == len(words) - 1:
                return found[0], chosen[1]
        named = find(names, text.words, chosen[1])
        if named is None or choice is None or dict(choice.parts) != {"kind": self._likenesses.kind_of(kind, named[0])}:
            return chosen
        return named

    def is_same(self, text: Words, at: int, latest: str) -> bool:
        """Whether a noun with a definite article may be that of the place spoken of before: `the room` for the lab.

        Of what is chosen in rounds it isn't known which it is: the noun may be that of any.
        """
        return self._is_definite(text, at) and (
            latest[:1] == "{" or text.words[at] == self._likenesses.kind_of(PLACE, latest)
        )

    def of_its_kind(
        self, context: Reading, kind: str, text: Words, at: int, chosen: tuple[str, int]
    ) -> tuple[str, int]:
        """`pick up the red cup. Put the cup on the table`: the one that was spoken of, not another one of its kind."""
        noun, choice = find(self._names("kind"), text.words, at), choice_of(chosen[0])
        if noun is None or noun[1] != chosen[1] or choice is None or choice.parts != (("kind", noun[0]),):
            return chosen
        spoken = context.of_kind.get(noun[0], "")
        is_known = spoken[:1] != "{" or spoken == context.latest.get(kind, "")
        return (spoken, chosen[1]) if spoken and is_known and self._is_definite(text, at) else chosen

    def _is_definite(self, text: Words, at: int) -> bool:
        """Whether the article of what was spoken of stands before a word."""
        article = text.articles.get(at)
        return article is not None and text.source.text[slice(*article)].lower() == self._definite

    def another(
        self, context: Reading, kind: str, text: Words, end: int, descriptions: Modifiers
    ) -> tuple[str, int] | None:
        """What `one` alone is: one of those that were spoken of, one like the thing before, or that thing itself."""
        latest, behind = context.latest.get(kind, "{"), text.words[end]
        if not (behind in context.modifiers or not behind[0].isalpha() or behind in context.joiners):
            return None
        spoken = choice_of(context.listed.get(kind, ""))
        parts = spoken.parts if spoken is not None and NAMES not in dict(spoken.parts) else ()
        parts = parts or self._parts_of_one(kind, text, end - 1, latest, descriptions)
        if next(descriptions.behind(kind, text, end, self._names), None):  # `one from the lab`
            parts = tuple(part for part in parts if part[0] not in RELATIONS)
        if parts and NAME not in dict(parts):
            return context.described(kind, "nearest", parts), end
        return (latest, end) if latest[:1] != "{" else (dict(parts)[NAME], end) if parts else None

    def _parts_of_one(self, kind: str, text: Words, at: int, latest: str, modifiers: Modifiers) -> Parts:
        """What `one` at a word is like: as the noun before it says, in its statement or the one before; () for nothing.

        The latest value of the type, where it is a name, is named itself behind `a red cup`, but not behind `the cup`.
        """
        here, start, _ = text.earlier(at)
        found = self._noun(kind, text, at) or (self._noun(kind, here, start - 1) if start else None)
        if found is None or (latest[:1] == "{" and kind != OBJECT):
            return ()
        here, first, end, kind_of, name = found
        said = (here.articles[i] for i in range(first, first - _MOST_ADJECTIVES, -1) if i in here.articles)
        article = next(said, None)
        is_new = article is not None and here.source.text[slice(*article)].lower() != self._definite
        if name:
            is_named = (is_new and name.lower() != kind_of) or not kind_of
            return ((NAME, name),) if is_named else (("kind", kind_of),)
        behind = [more for more, _ in modifiers.behind(kind, here, end, self._names)]
        before = [
            parts
            for place in range(first - 1, first - _MOST_ADJECTIVES, -1)
            for parts, last in modifiers.before(here, place, self._names)
            if last == first
        ]
        return (("kind", kind_of), *chain(*before[-1:]), *chain(*behind[-1:])) if kind_of else ()

    def _behind_preposition(self, text: Words, at: int) -> dict[str, str]:
        """The kind of thing or place that stands behind the preposition of a word before it, by its type."""
        here, start, at = text.earlier(at)
        word = here.words[at - 1] if at > start else ""
        same = [i for i in range(start, at - 1) if here.words[i] == word] if word in self._prepositions else ()
        found: dict[str, str] = {}
        for first in range(same[-1] + 1, same[-1] + 1 + _MOST_ADJECTIVES) if same else ():
            if found or here.words[first] in _NOT_IN_NAMES:
                break
            for kind in (OBJECT, PLACE):
                named, of = find(self._names(kind), here.words, first), find(self._names("kind"), here.words, first)
                if named is not None:
                    found[kind] = self._likenesses.kind_of(kind, named[0]) or here.words[named[1] - 1]
                elif of is not None and kind in self._likenesses.types_of(of[0]):
                    found[kind] = of[0]
        return found

    def _before(self, kind: str, text: Words, at: int) -> tuple[str, str]:
        """The kind, and the last word, of the latest name or noun of a type before a word in its statement."""
        found = self._noun(kind, text, at)
        return ("", "") if found is None else (found[3], found[0].words[found[2] - 1])

    def _noun(self, kind: str, text: Words, at: int) -> tuple[Words, int, int, str, str] | None:
        """The latest name or noun of a type before a word in its statement: where it is, its kind, and the name."""
        text, start, at = text.earlier(at)
        latest, end = None, 0
        for first in range(at - 1, start - 1, -1):
            named = find(self._names(kind), text.words, first)
            if named is not None and end <= named[1] <= at:
                end = named[1]
                latest = text, first, end, self._likenesses.kind_of(kind, named[0]), named[0]
            for tree in ("kind", "kinds"):
                of = find(self._names(tree), text.words, first)
                is_longer = of is not None and latest is not None and not latest[4] and of[1] == end  # `coffee cup`
                if of is not None and (end < of[1] <= at or is_longer) and kind in self._likenesses.types_of(of[0]):
                    end = of[1]
                    latest = text, first, end, of[0], ""
        return latest
