"""Where the values that a mission names are known: everywhere, or in the body of a definition or `for each`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from btlang.frontends.mission.symbols.definitions import reach
from btlang.frontends.mission.symbols.prefixes import Prefix
from btlang.frontends.mission.token import Header
from btlang.text.words import Words
from btlang.vocabulary.reading_context import Known

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Types: TypeAlias = Mapping[tuple[int, str], tuple[str, ...]]
else:
    Types = Mapping


class Scopes:
    """The values that are known `everywhere`, by key, and the `local` ones with the words where each is known.

    `types` are what is known of the types of values, by the word of their prefix or body, and their key. A local value
    without one can be of any type; so can those that are known `inside` some words alone.
    """

    def __init__(
        self,
        text: Words,
        prefixes: Mapping[int, Prefix],
        headers: Iterable[Header],
        shared: Mapping[str, Known],
        types: Types,
        inside: Iterable[tuple[int, int, Known]] = (),
    ) -> None:
        self.everywhere = dict(shared)
        self.local = [
            *inside,
            *(
                (header.body, header.last, Known(key, words, types.get((header.body, key), ())))
                for header in headers
                for key, words in header.parameters
            ),
        ]
        self._parameters = {(first, known.key): at for at, (first, _, known) in enumerate(self.local)}
        for at, prefix in prefixes.items():
            kinds = types.get((at, prefix.key))
            if prefix.role == "each":
                self.local.append((prefix.last, reach(text, at), Known(prefix.key, prefix.words, kinds or ())))
            elif kinds is not None:
                self.give(prefix, kinds)

    def give(self, prefix: Prefix, kinds: tuple[str, ...]) -> None:
        """A value of the whole mission is given one of these types; those that fit all that it is given remain."""
        others = self.everywhere.get(prefix.key)
        if others is not None and others.kinds:
            kinds = tuple(kind for kind in others.kinds if kind in kinds) or others.kinds
        self.everywhere[prefix.key] = Known(prefix.key, prefix.words, kinds)

    def find(self, body: int, key: str, kinds: tuple[str, ...]) -> None:
        """The parameter of a definition with this body is of one of these types."""
        at = self._parameters[body, key]
        first, last, known = self.local[at]
        self.local[at] = first, last, known.replace(kinds=kinds)

    def at(self, word: int) -> dict[str, Known]:
        """What is known there, the innermost of each name, by key."""
        inner = {known.key: known for first, last, known in self.local if first <= word < last}
        return {**self.everywhere, **inner} if inner else self.everywhere

    def bounds(self) -> list[int]:
        """The words at which other values begin to be known, in order."""
        return sorted({0, *(word for first, last, _ in self.local for word in (first, last))})
