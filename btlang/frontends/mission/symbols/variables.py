"""The values that a text names itself, found before its lines are read.

There are three sorts: what is set or remembered holds in the whole mission; what `for each` goes through and the
parameters of a definition hold in their body.
"""

from __future__ import annotations

from collections.abc import Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.definitions import Definitions
from btlang.frontends.mission.symbols.prefixes import Head
from btlang.frontends.mission.symbols.value_types import ValueTypes
from btlang.text.words import Words
from btlang.vocabulary.entry import COMPARISONS, Entry, Meaning
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.trie import add
from btlang.vocabulary.vocabulary import Vocabulary


class Variables:
    """`problems` with names, which values are known `at` a word, and those that are known `everywhere`, by key.

    `shared` are values that are named elsewhere and hold here too; `bounds` are the words at which others begin to be
    known. Conditions on values come into the trie of `definitions`.
    """

    def __init__(
        self,
        text: Words,
        vocabulary: Vocabulary,
        heads: Mapping[int, Head],
        definitions: Definitions,
        shared: Mapping[str, Known],
    ) -> None:
        self.problems: list[Diagnostic] = []
        self._text, self._vocabulary, self._definitions = text, vocabulary, definitions
        self._heads, self._shared = heads, shared
        found = ValueTypes(text, vocabulary, heads, definitions, shared)
        self._types, self._scopes = found.types, found.scopes()
        self.everywhere, self.bounds = self._scopes.everywhere, self._scopes.bounds()
        self._check_names()
        self._compare()

    def at(self, word: int) -> dict[str, Known]:
        """What is known there, by key."""
        return self._scopes.at(word)

    def _check_names(self) -> None:
        for at, head in self._heads.items():
            if head.role not in ("each", "remember") and self.everywhere.get(head.key) is None:
                self._unknown(at, head)
        held: dict[str, tuple[str, ...]] = {key: known.kinds for key, known in self._shared.items()}
        for at, head in self._heads.items():
            kinds = self._types.get((at, head.key), ())
            before = held.get(head.key, kinds)
            if kinds and head.role != "each":
                held[head.key] = tuple(kind for kind in before if kind in kinds) or kinds
                if not set(before) & set(kinds):
                    span, name = self._text.span(at, head.last), " ".join(head.words)
                    self.problems.append(diagnostic("BT048", span, name=name, kind=kinds[0], other=before[0]))
        each = [(self._text.span(at, head.last), head) for at, head in self._heads.items() if head.role == "each"]
        headers = [(header.span, header) for header in self._definitions.headers.values()]
        local = [(span, head.key, head.words) for span, head in each]
        local += [(span, key, words) for span, header in headers for key, words in header.parameters]
        for span, key, words in local:
            if key in self.everywhere:
                self.problems.append(diagnostic("BT045", span, name=" ".join(words)))

    def _unknown(self, at: int, head: Head) -> None:
        vocabulary = self._vocabulary
        example = f"{vocabulary.word('set')} {' '.join(head.words)} {vocabulary.word('set_to')} 0"
        span = self._text.span(at, head.last)
        self.problems.append(
            diagnostic("BT043", span, name=" ".join(head.words), help=f"Give it a value first: {example}")
        )

    def _compare(self) -> None:
        """`counter is 3` becomes a condition, as for a quantity."""
        named = {known.key: known for _, _, known in self._scopes.local} | self.everywhere
        for known in named.values():
            for kind in known.kinds[:1]:
                entry = Entry("value", known.key, (), quantity=(" ".join(known.words),), measures=kind)
                for form in self._vocabulary.comparing_forms(kind):
                    for name in (known.words, ("{", *known.words, "}")):
                        whole, types = (*name, *form), dict.fromkeys(COMPARISONS, kind)
                        add(self._definitions.trie, whole, types, Meaning("condition", entry))
                        for negated in self._vocabulary.negated(whole):
                            add(self._definitions.trie, negated, types, Meaning("negated", entry))
