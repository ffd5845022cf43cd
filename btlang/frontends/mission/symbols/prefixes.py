"""Finds the statements about values of the mission before its lines are read: `set counter to`, `for each place in`."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.record import Record
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.vocabulary.pattern import forms
from btlang.vocabulary.trie import longest
from btlang.vocabulary.values import key_of
from btlang.vocabulary.vocabulary import Vocabulary

JOINTS = {"set": "set_to", "increase": "by", "decrease": "by", "remember": "remember_as", "each": "each_in"}
"""The roles that begin a statement about a value, each with the role of the words between the name and the value."""
_MOST_WORDS = 4
_MOST_MEASURED = 40  # words of what is remembered


class Head(Record):
    """The head of a statement about a value: its name, the word at which the value stands, and the word behind it.

    `value` is -1 where none is given. Of `remember ... as name` the value stands before the name and ends before the
    word `value_end`, and `last` is behind the name.
    """

    role: str
    key: str
    words: tuple[str, ...]
    value: int
    last: int
    value_end: int = -1


def find_heads(text: Words, vocabulary: Vocabulary) -> dict[int, Head]:
    """The statements of a text that name a value."""
    firsts = {str(form[0]) for role in JOINTS for phrase in vocabulary.roles[role] for form in forms(phrase)}
    heads: dict[int, Head] = {}
    if firsts.isdisjoint(text.words):
        return heads
    vocabulary = vocabulary.with_references()
    for at, word in enumerate(text.words):
        if word in firsts:
            match = longest(vocabulary.trie, text, at, vocabulary.context)
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
        return Head(role, key_of(words), words, at, last, joint[0]) if words else None
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
    ends = "}" if text.words[at] == "{" else "{"
    while at < first + _MOST_WORDS + 2 and (at == first or text.words[at] != ends) and _is_part(text, at, vocabulary):
        at += 1
    return at + (ends == "}" == text.words[at])


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
    match = longest(vocabulary.trie, text, at, vocabulary.context)
    joins = match is not None and match.meaning.entry is None
    return word[0].isalpha() and not joins


def span_of(text: Words, at: int) -> Span:
    """From a word to the next mark."""
    last = at + 1
    while _goes_on(text.words[last]):
        last += 1
    return text.span(at, last)
