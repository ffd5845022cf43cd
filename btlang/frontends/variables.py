"""Finds the values that a text names itself, before its lines are read, and their types.

There are three sorts: what is set or remembered holds in the whole mission; what `for each` goes through and the
parameters of a definition hold in their body.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.definitions import Definitions, Header, add_name, reach
from btlang.record import Record
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.vocabulary.entry import COMPARISONS, Entry, Meaning
from btlang.vocabulary.pattern import forms
from btlang.vocabulary.trie import add, longest
from btlang.vocabulary.values import Known, key_of
from btlang.vocabulary.vocabulary import Vocabulary

JOINTS = {"set": "set_to", "increase": "by", "decrease": "by", "remember": "remember_as", "each": "each_in"}
"""The roles that begin a statement about a value, each with the role of the words between the name and the value."""
_MOST_WORDS = 4
_MOST_MEASURED = 40  # words of what is remembered


class Head(Record):
    """The head of a statement about a value: its name, the word at which the value stands, and the word behind it.

    `value` is -1 where none is given. Of `remember ... as name` the value stands before the name, and `last` is behind
    the name.
    """

    role: str
    key: str
    words: tuple[str, ...]
    value: int
    last: int


class Variables:
    """`heads` by the word at which they start; `problems`; which values are known `at` a word."""

    def __init__(self, text: Words, vocabulary: Vocabulary, heads: dict[int, Head], definitions: Definitions) -> None:
        self.problems: list[Diagnostic] = []
        self._text, self._vocabulary, self._definitions = text, vocabulary, definitions
        self._values = vocabulary.values.for_reading()
        self._heads = heads
        self._global: dict[str, Known] = {}
        self._local: list[tuple[int, int, Known]] = []
        self.bounds: list[int] = []
        """The words at which other values begin to be known, in order."""
        headers = [header for header in definitions.headers.values() if header.parameters]
        if heads or headers:
            self._resolve(headers)
            self._check_names()
            self._compare()
            self.bounds = sorted({0, *(word for first, last, _ in self._local for word in (first, last))})

    def at(self, word: int) -> dict[str, Known]:
        """What is known there, the innermost of each name, by key."""
        inner = {known.key: known for first, last, known in self._local if first <= word < last}
        return {**self._global, **inner}

    # -- types

    def _resolve(self, headers: Sequence[Header]) -> None:
        """Types follow from each other, so each is looked for until nothing new is found; then the rest are texts."""
        types: dict[tuple[int, str], tuple[str, ...]] = {}
        known_types = self._vocabulary.types
        before = -1
        while len(types) > before:
            before = len(types)
            self._enter(headers, types)
            for header in headers:
                self._infer(header, types)
            for at, head in self._heads.items():
                if (at, head.key) not in types and head.role in ("set", "remember", "each"):
                    kinds = (head.key,) if head.role == "each" and head.key in known_types else self._kinds(at, head)
                    if kinds:
                        types[at, head.key] = kinds
            self._enter(headers, types)
            for header in headers:
                if all((header.body, key) in types for key, _ in header.parameters):
                    self._add(header, types)
        for header in headers:
            types |= {(header.body, key): ("text",) for key, _ in header.parameters if (header.body, key) not in types}
            self._add(header, types)
        unread = {(at, head.key): ("text",) for at, head in self._heads.items() if head.role in ("set", "each")}
        self._enter(headers, {**unread, **types})

    def _enter(self, headers: Iterable[Header], types: dict[tuple[int, str], tuple[str, ...]]) -> None:
        """Puts what is known of the types so far into scopes."""
        self._local = [
            (header.body, header.last, Known(key, words, types.get((header.body, key), ())))
            for header in headers
            for key, words in header.parameters
        ]
        self._global = {}
        for at, head in self._heads.items():
            kinds = types.get((at, head.key))
            if head.role == "each":
                known = Known(head.key, head.words, kinds or ())
                self._local.append((head.last, reach(self._text, at), known))
            elif kinds is not None:
                others = self._global.get(head.key)
                both = tuple(kind for kind in others.kinds if kind in kinds) if others is not None else kinds
                self._global[head.key] = Known(head.key, head.words, both or kinds)

    def _infer(self, header: Header, types: dict[tuple[int, str], tuple[str, ...]]) -> None:
        """The type of a parameter is that of the first slot in which it stands, other than one of text."""
        for key, _ in header.parameters:
            if key in self._vocabulary.types:
                types.setdefault((header.body, key), (key,))
        self._values.set_known(self.at(header.body))
        at = header.body
        while at < header.last:
            matches = (longest(trie, self._text, at, self._values) for trie in self._tries())
            match = max((m for m in matches if m is not None), key=lambda m: m.last, default=None)
            for value in match.values if match is not None else ():
                for key, _ in header.parameters:
                    if f"{{{key}}}" in (value.text, *value.more) and value.type != "text":
                        types.setdefault((header.body, key), (value.type,))
            at = max(match.last, at + 1) if match is not None else at + 1

    def _tries(self) -> Iterator[dict[str, object]]:
        yield self._vocabulary.trie
        if self._definitions.trie:
            yield self._definitions.trie

    def _add(self, header: Header, types: dict[tuple[int, str], tuple[str, ...]]) -> None:
        if header.body not in self._definitions.types:
            kinds = {key: types[header.body, key][0] for key, _ in header.parameters}
            add_name(header, self._definitions, self._vocabulary, kinds)

    def _kinds(self, at: int, head: Head) -> tuple[str, ...]:
        """The types that the value of a head can have, () where that is not known yet."""
        if head.value < 0:
            return ()
        if head.role == "remember":
            quantity = longest(self._vocabulary.quantities, self._text, head.value, self._values)
            if quantity is not None and quantity.meaning.entry is not None:
                return (quantity.meaning.entry.measures,)
        self._values.set_known(self.at(at))
        value = self._values.any(self._text, head.value)
        return value[0] if value is not None else ()

    # -- checks, and words to compare with

    def _check_names(self) -> None:
        for at, head in self._heads.items():
            if head.role != "each" and self._global.get(head.key) is None:
                self._unknown(at, head)
        for first, _, known in self._local:
            if known.key in self._global:
                span = self._text.span(max(0, first - 1), first)
                for header in self._definitions.headers.values():
                    span = header.span if header.body == first else span
                self.problems.append(diagnostic("BT045", span, name=" ".join(known.words)))

    def _unknown(self, at: int, head: Head) -> None:
        vocabulary = self._vocabulary
        example = f"{vocabulary.word('set')} {' '.join(head.words)} {vocabulary.word('set_to')} 0"
        span = self._text.span(at, head.last)
        self.problems.append(
            diagnostic("BT043", span, name=" ".join(head.words), help=f"Give it a value first: {example}")
        )

    def _compare(self) -> None:
        """`counter is 3` becomes a condition, as for a quantity."""
        everywhere = {known.key: known for _, _, known in self._local} | self._global
        for known in everywhere.values():
            for kind in known.kinds[:1]:
                entry = Entry("value", known.key, (), quantity=(" ".join(known.words),), measures=kind)
                for form in self._vocabulary.comparing_forms(kind):
                    for name in (known.words, ("{", *known.words, "}")):
                        whole, types = (*name, *form), dict.fromkeys(COMPARISONS, kind)
                        add(self._definitions.trie, whole, types, Meaning("condition", entry))
                        for negated in self._vocabulary.negated(whole):
                            add(self._definitions.trie, negated, types, Meaning("negated", entry))


def find_heads(text: Words, vocabulary: Vocabulary) -> dict[int, Head]:
    """The statements of a text that name a value."""
    firsts = {str(form[0]) for role in JOINTS for phrase in vocabulary.roles[role] for form in forms(phrase)}
    heads: dict[int, Head] = {}
    if firsts.isdisjoint(text.words):
        return heads
    for at, word in enumerate(text.words):
        if word in firsts:
            match = longest(vocabulary.trie, text, at, vocabulary.values)
            if match is not None and match.meaning.role in JOINTS:
                head = _head(text, match.meaning.role, match.last, vocabulary)
                if head is not None:
                    heads[at] = head
    return heads


def _head(text: Words, role: str, at: int, vocabulary: Vocabulary) -> Head | None:
    """None where it is not put together as such a statement is."""
    joint = _joint(text, at, vocabulary.roles[JOINTS[role]], _MOST_MEASURED if role == "remember" else _MOST_WORDS + 2)
    if role == "remember":
        if joint is None:
            return None
        last = _end_of_name(text, joint[1], vocabulary)
        words = _name(text, joint[1], last, vocabulary)
        return Head(role, key_of(words), words, at, last) if words else None
    if joint is None:
        if role not in ("increase", "decrease"):
            return None
        last = _end_of_name(text, at, vocabulary)
        words = _name(text, at, last, vocabulary)
        return Head(role, key_of(words), words, -1, last) if words else None
    words = _name(text, at, joint[0], vocabulary)
    return Head(role, key_of(words), words, joint[1], joint[1]) if words else None


def _joint(text: Words, at: int, phrases: Iterable[str], within: int) -> tuple[int, int] | None:
    """Where the words of one of the phrases stand first in the statement, so many words on, and where they end."""
    joints = [phrase.split() for phrase in phrases]
    for i in range(at, min(at + within + 1, len(text.words))):
        for joint in joints:
            if text.words[i : i + len(joint)] == joint:
                return i, i + len(joint)
        if not _goes_on(text.words[i]):
            return None
    return None


def _goes_on(word: str) -> bool:
    return word[0].isalnum() or word[0] in '{}"-%°'


def _end_of_name(text: Words, at: int, vocabulary: Vocabulary) -> int:
    """Behind the words of a name: it ends at a mark, and before a connective."""
    first = at
    while at < first + _MOST_WORDS + 2 and _is_part(text, at, vocabulary):
        at += 1
    return at


def _name(text: Words, first: int, last: int, vocabulary: Vocabulary) -> tuple[str, ...]:
    """The words of a name, without braces; () where they make none."""
    if last - first > 2 and text.words[first] == "{" and text.words[last - 1] == "}":
        first, last = first + 1, last - 1
    words = tuple(text.words[first:last])
    is_name = 0 < len(words) <= _MOST_WORDS and all(_is_part(text, at, vocabulary) for at in range(first, last))
    return words if is_name and "{" not in words and "}" not in words else ()


def _is_part(text: Words, at: int, vocabulary: Vocabulary) -> bool:
    word = text.words[at]
    if word in ("{", "}"):
        return True
    match = longest(vocabulary.trie, text, at, vocabulary.values)
    joins = match is not None and match.meaning.entry is None
    return word[0].isalpha() and not joins


def span_of(text: Words, at: int) -> Span:
    """From a word to the next mark."""
    last = at + 1
    while _goes_on(text.words[last]):
        last += 1
    return text.span(at, last)
