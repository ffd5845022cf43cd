"""What may follow in a phrase or value that has been begun: the trie read ahead of the text."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from functools import lru_cache

from btlang.support.record import Record
from btlang.text.words import Words
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import TrieNode
from btlang.vocabulary.value_type import with_unit
from btlang.vocabulary.values import Values
from btlang.vocabulary.word_tree import END, NO_WORDS, SLOTS, WordTree

_MOST = 200  # ways to go on from one place; nobody reads more


class Begun(Record):
    """How far words have led into a trie.

    `nodes` are where all of them are read; `slots` are half filled: type, first word of the value, node behind it.
    """

    nodes: tuple[TrieNode, ...]
    slots: tuple[tuple[str, int, TrieNode], ...]


def begun(root: TrieNode, text: Words, first: int, last: int, context: ReadingContext) -> Begun:
    """All ways to read the words `first` to `last` (exclusive) as the start of phrases."""
    nodes: list[TrieNode] = []
    slots: list[tuple[str, int, TrieNode]] = []
    paths: list[tuple[TrieNode, int]] = [(root, first)]
    while paths:
        node, at = paths.pop()
        if at == last:
            nodes.append(node)
            continue
        for _, kind, child in node.get(SLOTS, ()):
            behind = at
            while True:  # each value of a list
                slots.append((kind, behind, child))
                value = context.read(kind, text, behind)
                if value is None or value[1] > last:
                    break
                paths.append((child, value[1]))
                behind = next(i for i in range(value[1], last + 1) if i == last or text.words[i] not in context.joiners)
                if behind == value[1]:
                    break
        child = node.get(text.words[at])
        if child is not None:
            paths.append((child, at + 1))
    return Begun(tuple(nodes), tuple(slots))


def ways_on(node: TrieNode, start: str = "") -> Iterator[tuple[tuple[str, ...], TrieNode]]:
    """Words that lead on to the end of a phrase or to its next slot, fewest first; the first begins with `start`."""
    pending: deque[tuple[tuple[str, ...], TrieNode]] = deque(
        ((word,), child) for word, child in node.items() if word not in NO_WORDS and word.startswith(start)
    )
    found = 0
    while pending and found < _MOST:
        words, node = pending.popleft()
        if END in node or SLOTS in node:
            found += 1
            yield words, node
        pending += [((*words, word), child) for word, child in node.items() if word not in NO_WORDS]


def meanings(node: TrieNode) -> Iterator[Meaning]:
    """What the phrases through a node can mean, the shortest phrase first."""
    level, seen = [node], {id(node)}
    while level:
        below: list[TrieNode] = []
        for node in level:
            if END in node:
                yield node[END]
            below += [child for word, child in node.items() if word not in NO_WORDS]
            below += [child for _, _, child in node.get(SLOTS, ())]
        level = [node for node in below if id(node) not in seen]
        seen.update(map(id, level))


def values_on(kind: str, values: Values, written: Sequence[str], start: str) -> Iterator[str]:
    """What can follow the `written` words of a value of a type; the next word begins with `start`.

    Names come before their other words. A number that is written in full is followed by units; where nothing is written
    an example is given.
    """
    value_type = values.types[kind]
    if value_type.kind == "names":
        own = values.said_names(kind)
        found = _names_on(values.names_tree(kind), written, start, own)
        yield from sorted(found, key=lambda words: (" ".join((*written, words)) not in own, words))
        known = len(written)
        for words in _choices(values, kind) if known or start else ():
            if words[:known] == list(written) and len(words) > known and words[known].startswith(start):
                yield " ".join(words[known:])
    elif value_type.kind == "text":
        if not written and not start:
            yield value_type.example
    elif not written:
        if value_type.example.startswith(start):
            yield value_type.example
        elif start.isdecimal() and value_type.kind == "quantity":
            yield from (with_unit(start, unit.words[0]) for unit in value_type.units)
        elif start.isdecimal() and value_type.kind == "time":
            yield from (with_unit(start, half) for half in values.halves_of_day)
    elif value_type.kind == "quantity" and values.is_number(written):
        yield from (unit.words[0] for unit in value_type.units if unit.words[0].startswith(start))
    elif value_type.kind == "time" and (written[0][0].isdecimal() or values.is_number(written)):
        yield from (half for half in values.halves_of_day if half.startswith(start))


@lru_cache(maxsize=32)  # the same at each key
def _choices(values: Values, kind: str) -> list[list[str]]:
    return values.choices(kind)


def _names_on(tree: WordTree, written: Sequence[str], start: str, names: Sequence[str]) -> Iterator[str]:
    spelt = {name.lower(): name for name in names}
    for word in written:
        if word not in tree:
            return
        tree = tree[word]
    stack: list[tuple[tuple[str, ...], WordTree]] = [
        ((word,), child) for word, child in tree.items() if word != END and word.startswith(start)
    ]
    while stack:
        words, node = stack.pop()
        if END in node:
            whole = " ".join((*written, *words))
            yield " ".join(spelt.get(whole, whole).split()[len(written) :])
        stack += [((*words, word), child) for word, child in node.items() if word != END]
