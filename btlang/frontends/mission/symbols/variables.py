"""The values that a text names itself, found before its lines are read.

There are three sorts: what is set or remembered holds in the whole mission; what `for each` goes through and the
parameters of a definition hold in their body.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.definitions import Definitions
from btlang.frontends.mission.symbols.prefixes import Prefix
from btlang.frontends.mission.symbols.value_types import ValueTypes
from btlang.text.words import Words
from btlang.vocabulary.entry import COMPARISONS, Entry, Meaning
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.trie import add
from btlang.vocabulary.value_type import TEXT, number_type


class Variables:
    """`problems` with names, which values are known `at` a word, and those that are known `everywhere`, by key.

    `shared` are values that are named elsewhere and hold here too, `inside` those that are known between two words;
    `bounds` are the words at which others begin to be
    known. Conditions on values come into the trie of `definitions`.
    """

    def __init__(
        self,
        text: Words,
        vocabulary: Lexicon,
        prefixes: Mapping[int, Prefix],
        definitions: Definitions,
        shared: Mapping[str, Known],
        inside: Sequence[tuple[int, int, Known]] = (),
    ) -> None:
        self.problems: list[Diagnostic] = []
        self._text, self._vocabulary, self._definitions = text, vocabulary, definitions
        self._prefixes, self._shared = prefixes, shared
        found = ValueTypes(text, vocabulary, prefixes, definitions, shared, inside)
        self._types, self._scopes = found.types, found.scopes()
        self.everywhere, self.bounds = self._scopes.everywhere, self._scopes.bounds()
        self._check_names()
        self._compare()

    def at(self, word: int) -> dict[str, Known]:
        """What is known there, by key."""
        return self._scopes.at(word)

    def _check_names(self) -> None:
        for at, prefix in self._prefixes.items():
            if prefix.role not in ("each", "remember") and self.everywhere.get(prefix.key) is None:
                self._unknown(at, prefix)
        held: dict[str, tuple[str, ...]] = {key: known.kinds for key, known in self._shared.items()}
        for at, prefix in self._prefixes.items():
            kinds = self._types.get((at, prefix.key), ())
            before = held.get(prefix.key, kinds)
            if kinds and prefix.role != "each":
                held[prefix.key] = tuple(kind for kind in before if kind in kinds) or kinds
                if not set(before) & set(kinds):
                    span, name = self._text.span(at, prefix.last), " ".join(prefix.words)
                    self.problems.append(diagnostic("BT048", span, name=name, kind=kinds[0], other=before[0]))
        each = [
            (self._text.span(at, prefix.last), prefix) for at, prefix in self._prefixes.items() if prefix.role == "each"
        ]
        headers = [(header.span, header) for header in self._definitions.headers.values()]
        local = [(span, prefix.key, prefix.words) for span, prefix in each]
        local += [(span, key, words) for span, header in headers for key, words in header.parameters]
        for span, key, words in local:
            if key in self.everywhere:
                self.problems.append(diagnostic("BT045", span, name=" ".join(words)))

    def _unknown(self, at: int, prefix: Prefix) -> None:
        vocabulary = self._vocabulary
        example = f"{vocabulary.word('set')} {' '.join(prefix.words)} {vocabulary.word('set_to')} 0"
        span = self._text.span(at, prefix.last)
        self.problems.append(
            diagnostic("BT043", span, name=" ".join(prefix.words), help=f"Give it a value first: {example}")
        )

    def _compare(self) -> None:
        """`counter is 3` becomes a condition, as for a quantity."""
        named = {known.key: known for _, _, known in self._scopes.local} | self.everywhere
        untyped = (number_type(self._vocabulary.types), TEXT)
        for known in named.values():
            for kind in known.kinds[:1] or untyped:
                entry = Entry("value", known.key, (), quantity=(" ".join(known.words),), measures=kind)
                for form in self._vocabulary.comparing_forms(kind):
                    for name in _said(known):
                        whole, types = (*name, *form), dict.fromkeys(COMPARISONS, kind)
                        add(self._definitions.trie, whole, types, Meaning("condition", entry))
                        for negated in self._vocabulary.negated(whole):
                            add(self._definitions.trie, negated, types, Meaning("negated", entry))


def _said(known: Known) -> Iterator[tuple[str, ...]]:
    """The ways to say the name of a value where it is compared."""
    names = dict.fromkeys((known.words or tuple(filter(None, known.key.split("_"))), (known.key,)))
    yield from (("{", *name, "}") for name in names)
    if known.words:
        yield known.words
