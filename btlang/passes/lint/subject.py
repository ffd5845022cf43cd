"""What a lint looks at."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from btlang.record import Record
from btlang.tree.ast import Mission
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first
from btlang.vocabulary.vocabulary import Vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    Result = TypeVar("Result")


class Subject(Record):
    """A mission that compiled, and its tree."""

    mission: Mission
    tree: Tree
    vocabulary: Vocabulary


def roots(tree: Tree) -> Iterator[tuple[str, Node]]:
    """The named subtrees, used ones before their users, and then the main tree with the name ""."""
    yield from tree.subtrees
    yield "", tree.root


def fold_tree(tree: Tree, combine: Callable[[Node, Sequence[Result], dict[str, Result]], Result]) -> None:
    """Combines each node with the results of its children; the third argument are those of the names so far."""
    named: dict[str, Result] = {}
    for name, root in roots(tree):
        results: list[Result] = []
        for node in children_first(root):
            count = len(node.children)
            done: Sequence[Result] = ()
            if count:
                done = results[-count:]
                del results[-count:]
            results.append(combine(node, done, named))
        named[name] = results[0]
