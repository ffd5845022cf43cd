"""The slots of a phrase that has been begun for which the text has no value: `drive to the foo`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.support.record import Record
from btlang.text.words import Words
from btlang.vocabulary.entry import MANNER, RECIPIENT, UNMARKED, VIA
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import TrieNode
from btlang.vocabulary.verbs import Frame, is_no_way
from btlang.vocabulary.word_tree import END, NO_WORDS, SLOTS, VERBS


class Misfit(Record):
    """A slot without a value of its type: the word where it is, the type, and the words that may follow the value.

    `ending` are words that complete the phrase, "" where it may end with the value.
    """

    at: int
    kind: str
    following: frozenset[str]
    ending: str = ""


def misfits_of(text: Words, at: int, roots: Iterable[TrieNode], context: ReadingContext) -> Iterator[Misfit]:
    """The slots that a phrase would have at the furthest word that its own words reach."""
    furthest = at
    found: dict[str, TrieNode] = {}
    paths: list[tuple[TrieNode, int]] = [(root, at) for root in roots]
    while paths:
        node, i = paths.pop()
        for kind, last in _empty_roles(node.get(VERBS, ()), text, i, context) if i > at else ():
            if last >= furthest and context.read(kind, text, last) is None:
                found = {**(found if last == furthest else {}), kind: {END: None}}
                furthest = last
        for name, kind, child in node.get(SLOTS, ()):
            value = context.read(kind, text, i)
            if value is not None and not (name == VIA and is_no_way(context, text, i, value)):
                paths.append((child, value[1]))
            elif context.types[kind].names and any(word not in NO_WORDS for word in node):
                continue  # one of a few names would be an addition to the words that are missing
            elif i > furthest:
                furthest, found = i, {kind: child}
            elif i == furthest and i > at:
                found[kind] = {**found.get(kind, {}), **child}
        child = node.get(text.words[i])
        if child is not None:
            paths.append((child, i + 1))
    yield from (Misfit(furthest, kind, frozenset(following), _ending(following)) for kind, following in found.items())


def _ending(node: TrieNode) -> str:
    """Return the first words that lead from there to the end of a phrase, "" if none are needed or a slot follows."""
    words: list[str] = []
    while not NO_WORDS & node.keys():
        word = next(iter(node))
        word = f"{word}s" if f"{word}s" in node else word  # `3 attempts`
        words.append(word)
        node = node[word]
    return " ".join(words) if END in node else ""


def _empty_roles(
    frames: Iterable[Frame], text: Words, at: int, context: ReadingContext, has_theme: bool = False
) -> Iterator[tuple[str, int]]:
    """The types of the values that words such as `to` behind a verb or its theme introduce, and where each begins."""
    for frame in frames:
        for role in frame.roles:
            lengths = (len(words) for words in role.words if tuple(text.words[at : at + len(words)]) == words)
            length = max(lengths, default=0)
            if length and role.name != MANNER:
                yield role.type, at + length
            theme = context.read(role.type, text, at) if role.is_direct and not has_theme else None
            if theme is None and not has_theme and role.name in UNMARKED and role.is_needed:
                behind = at + (text.words[at] == frame.particle)  # `turn on the radio`
                if behind in text.articles and (behind > at or not frame.particle):  # `grab the mug`
                    yield role.type, behind
            if theme is not None and role.name == RECIPIENT:  # `give him the medicine`
                yield from ((each.type, theme[1]) for each in frame.roles if each.name in UNMARKED)
            if theme is not None:
                yield from _empty_roles((frame,), text, theme[1], context, True)
