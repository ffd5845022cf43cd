"""Trees of words: word -> tree, `END` -> what the words up to there stand for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

END = "\0"  # no word of a text is this one
SLOTS = "\1"
"""Where phrases have slots: a list of (slot name, type, tree)."""
VERBS = "\2"
"""Where verbs with roles end: a list of their frames."""
NO_WORDS = frozenset((END, SLOTS, VERBS))
"""The keys of a tree that are no words."""
WordTree = dict[str, "Any"]


def insert(tree: WordTree, words: Sequence[str], value: object) -> None:
    """Adds a sequence of words to a word tree."""
    for word in words:
        tree = tree.setdefault(word, {})
    tree[END] = value


def tree_of(phrases: Iterable[tuple[str, object]]) -> WordTree:
    """The tree of phrases, each with what it stands for."""
    tree: WordTree = {}
    for phrase, value in phrases:
        insert(tree, phrase.split(), value)
    return tree


def find(tree: WordTree, words: Sequence[str], at: int) -> tuple[Any, int] | None:
    """The value of the longest sequence of the tree at a place, and where it ends."""
    found = None
    node = tree
    while True:
        node = node.get(words[at])  # type: ignore[assignment]
        if node is None:
            return found
        at += 1
        if END in node:
            found = node[END], at


def first_with_slots(tree: WordTree) -> list[WordTree]:
    """The nodes with slots to which words alone lead, from the tree on."""
    found, nodes = [], [tree]
    for node in nodes:
        below = [child for word, child in node.items() if word not in NO_WORDS]
        found += [child for child in below if SLOTS in child]
        nodes += [child for child in below if SLOTS not in child]
    return found


def words_of(*trees: WordTree) -> set[str]:
    """Every word of some trees, those behind slots among them."""
    words: set[str] = set()
    pending = [*trees]
    while pending:
        for key, child in pending.pop().items():
            if key == SLOTS:
                pending += [below for _, _, below in child]
            elif key not in NO_WORDS:
                words.add(key)
                pending.append(child)
    return words
