"""Finds the statements about values of the mission before its lines are read: `set counter to`, `for each place in`."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.support.record import Record
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.vocabulary.language_tables import NOT_ALONE
from btlang.vocabulary.lexicon import NODE_ROLES, Lexicon
from btlang.vocabulary.nouns import Description
from btlang.vocabulary.pattern import forms
from btlang.vocabulary.references import RELATIONS, key_of
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import PLACE, WORLD

SEPARATORS = {
    "set": "set_to", "increase": "by", "decrease": "by", "add": "add_to", "subtract": "subtract_from",
    "remember": "remember_as", "each": "each_in",
}  # fmt: skip
"""The roles that begin a statement about a value, each with the role of the words between the name and the value."""
_VALUE_FIRST = {"remember": "remember", "add": "increase", "subtract": "decrease"}
"""The roles behind which the value stands before the name, each with the role of what it says."""
_MOST_WORDS = 4
BEFORE_BODY = (":", ",")
"""The marks between `for each ...` and what is done."""
_MOST_MEASURED = 40  # words of what is remembered


class Prefix(Record):
    """The prefix of a statement about a value: its name, the word at which the value stands, and the word behind it.

    `value` is -1 where none is given. Of `remember ... as name` and `add 2 to name`, which is said as `increase`, the
    value stands before the name and ends before the word `value_end`, and `last` is behind the name. `for each person:`
    goes through the names that its `noun` is for.
    """

    role: str
    key: str
    words: tuple[str, ...]
    value: int
    last: int
    value_end: int = -1
    noun: Description | None = None


def find_prefixes(text: Words, vocabulary: Lexicon) -> dict[int, Prefix]:
    """The statements of a text that name a value."""
    firsts = {str(form[0]) for role in SEPARATORS for phrase in vocabulary.roles[role] for form in forms(phrase)}
    prefixes: dict[int, Prefix] = {}
    if firsts.isdisjoint(text.distinct):
        return prefixes
    vocabulary = vocabulary.with_references()
    heads = {phrase.split()[-1] for role in NODE_ROLES for phrase in vocabulary.roles[role]}
    for at, word in enumerate(text.words):
        if word in firsts and not (at and text.words[at - 1] in heads):  # `do add pose to vector` is a node
            match = longest(vocabulary.trie, text, at, vocabulary.context)
            if match is not None and match.meaning.role in SEPARATORS:
                prefix = _prefix(text, match.meaning.role, match.last, vocabulary)
                if prefix is not None:
                    prefixes[at] = prefix
    return prefixes


def _prefix(text: Words, role: str, at: int, vocabulary: Lexicon) -> Prefix | None:
    """None where it is not put together as such a statement is."""
    separator = _separator(
        text, at, vocabulary.roles[SEPARATORS[role]], _MOST_MEASURED if role in _VALUE_FIRST else _MOST_WORDS + 2
    )
    if role in _VALUE_FIRST:
        if separator is None:
            return None
        last = _end_of_name(text, separator[1], vocabulary)
        words = _name(text, separator[1], last, vocabulary)
        return Prefix(_VALUE_FIRST[role], key_of(words), words, at, last, separator[0]) if words else None
    if role == "each":
        if separator is not None and separator[0] == at:
            return _each_of(text, separator[1], vocabulary)
        noun = vocabulary.values.noun(text, at)
        wider = [way for way in vocabulary.values.groups(text, at, is_bare=True) if text.words[way[1]] in BEFORE_BODY]
        if separator is None or (noun is not None and wider and _is_described(wider[-1], text, vocabulary)):
            if noun is None:
                return None
            words = tuple(text.words[at : noun[1]])
            meant, last = wider[-1] if wider else noun
            return Prefix(role, key_of(words), words, at, last, noun=meant)
    if separator is None:
        if role not in ("increase", "decrease"):
            return None
        last = _end_of_name(text, at, vocabulary)
        words = _name(text, at, last, vocabulary)
        return Prefix(role, key_of(words), words, -1, last) if words else None
    words = _name(text, at, separator[0], vocabulary)
    return Prefix(role, key_of(words), words, separator[1], separator[1]) if words else None


def _each_of(text: Words, at: int, vocabulary: Lexicon) -> Prefix | None:
    """`for each of the lab, the hall:`, `for each of the rooms:`: a value that is called as its type is."""
    for meant, end in vocabulary.values.groups(text, at, is_bare=True):
        if text.words[end] in BEFORE_BODY:
            return Prefix("each", meant.type, (meant.type,), at, end, noun=meant)
    for kind in WORLD:
        if kind in vocabulary.types and vocabulary.context.read(kind, text, at) is not None:
            return Prefix("each", kind, (kind,), at, at)
    return None


def _is_described(way: tuple[Description, int], text: Words, vocabulary: Lexicon) -> bool:
    """Whether `for each cup in the kitchen:` goes through what is there; `in the lab, the hall:` is a list."""
    meant, end = way
    is_list = text.words[end] == "," and any(
        vocabulary.context.read(kind, text, end + 1) is not None for kind in WORLD if kind in vocabulary.types
    )
    return meant.type != PLACE and not is_list and not RELATIONS.keys().isdisjoint(dict(meant.parts))


def _separator(text: Words, at: int, phrases: Iterable[str], within: int) -> tuple[int, int] | None:
    """Where the words of one of the phrases stand first in the statement, so many words on, and where they end."""
    separators = [phrase.split() for phrase in phrases]
    for i in range(at, min(at + within + 1, len(text.words))):
        for separator in separators:
            if text.words[i : i + len(separator)] == separator:
                return i, i + len(separator)
        if not _goes_on(text.words[i]):
            return None
    return None


def _goes_on(word: str) -> bool:
    return word[0].isalnum() or word[0] in '{}"-%°'


def _end_of_name(text: Words, at: int, vocabulary: Lexicon) -> int:
    """Behind the words of a name: it ends at a mark, and before a connective."""
    first = at
    ends = "}" if text.words[at] == "{" else "{"
    while at < first + _MOST_WORDS + 2 and (at == first or text.words[at] != ends) and _is_part(text, at, vocabulary):
        at += 1
    return at + (ends == "}" == text.words[at])


def _name(text: Words, first: int, last: int, vocabulary: Lexicon) -> tuple[str, ...]:
    """The words of a name, without braces; () where they make none."""
    if last - first > 2 and text.words[first] == "{" and text.words[last - 1] == "}":
        first, last = first + 1, last - 1
    words = tuple(text.words[first:last])
    is_name = 0 < len(words) <= _MOST_WORDS and all(_is_part(text, at, vocabulary) for at in range(first, last))
    return words if is_name and "{" not in words and "}" not in words else ()


def _is_part(text: Words, at: int, vocabulary: Lexicon) -> bool:
    word = text.words[at]
    if word in ("{", "}"):
        return True
    match = longest(vocabulary.trie, text, at, vocabulary.context)
    joins = match is not None and match.meaning.entry is None and match.meaning.role not in NOT_ALONE
    return word[0].isalpha() and not joins


def span_of(text: Words, at: int) -> Span:
    """From a word to the next mark."""
    last = at + 1
    while _goes_on(text.words[last]):
        last += 1
    return text.span(at, last)
