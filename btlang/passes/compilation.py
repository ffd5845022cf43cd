"""Compilations, which the passes share: a text on its way to a checked tree."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.support.record import Record
from btlang.tree.ast import Ast, Definition, Program, parents_first
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first, in_order_of_use, subtree_names
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias, TypeVar

    Result = TypeVar("Result")
    Origins: TypeAlias = dict[int, tuple[Node, Ast]]


class Compilation:
    """A syntax tree that becomes a tree, or a tree from XML or JSON, which has no syntax tree.

    A mission that needs no command may only define names; its tree does nothing. One that `grows` isn't whole yet, so
    that nothing is said of names that nothing uses. `warnings` begins with those of reading the text or tree.
    """

    def __init__(
        self,
        vocabulary: Lexicon,
        mission: Program | None = None,
        tree: Tree | None = None,
        *,
        needs_command: bool = True,
        grows: bool = False,
        warnings: Iterable[Diagnostic] = (),
        origins: Origins | None = None,
    ) -> None:
        self.vocabulary = vocabulary
        self.needs_command = needs_command
        self.grows = grows
        self.origins = origins
        """The nodes by their identities, each with the syntax that it was made of; noted only where this is a dict."""
        self.warnings: list[Diagnostic] = [*warnings, *(tree.warnings if tree is not None else ())]
        self.ordered: list[Definition] = []
        """The definitions, used ones before their users."""
        self._mission = mission
        self._tree = tree
        self._nodes: list[tuple[str, list[Node]]] = []
        self._ids: frozenset[str] = frozenset()
        self._syntax: dict[int, list[Ast]] = {}

    @property
    def is_text(self) -> bool:
        """Whether there is a syntax tree."""
        return self._mission is not None

    @property
    def mission(self) -> Program:
        """The syntax tree, only for passes that need one."""
        assert self._mission is not None
        return self._mission

    def syntax(self, root: Ast) -> list[Ast]:
        """Return the nodes of a body in the syntax tree, parents before their parts, in the order of the text."""
        if id(root) not in self._syntax:
            self._syntax[id(root)] = parents_first(root)
        return self._syntax[id(root)]

    @property
    def tree(self) -> Tree:
        """The tree, only after lowering."""
        assert self._tree is not None
        return self._tree

    @tree.setter
    def tree(self, tree: Tree) -> None:
        self._tree = tree
        self._nodes, self._ids = [], frozenset()

    @property
    def nodes(self) -> list[tuple[str, list[Node]]]:
        """The nodes of each subtree by its name, used ones before their users, then those of the main tree under "".

        Children come before their parents, from left to right.
        """
        if not self._nodes:
            self._nodes = nodes_by_use(self.tree)
        return self._nodes

    @property
    def ids(self) -> frozenset[str]:
        """The ids of all nodes."""
        if not self._ids:
            self._ids = frozenset([node.id for _, nodes in self.nodes for node in nodes])
        return self._ids

    def fold(self, combine: Callable[[Node, Sequence[Result], dict[str, Result]], Result]) -> None:
        """Combine each node with the results of its children; the third argument are those of the names so far."""
        fold_nodes(self.nodes, combine)


class Pass(Record):
    """A step of compiling. `run` fills in the compilation and returns what it finds.

    `needs_text`: it is left out for trees from XML and JSON. `goes_on`: it runs after errors of earlier passes too, so
    that all are reported at once.
    """

    name: str
    run: Callable[[Compilation], Iterable[Diagnostic]]
    needs_text: bool = False
    goes_on: bool = False


def sort_by_use(tree: Tree) -> list[tuple[str, Node]]:
    """List the subtrees by name, then the main tree under "", so that each comes behind those that it uses.

    A mission has them in this order, an XML file in any. What uses itself, or is not there, is left to others.
    """
    roots = dict(tree.subtrees)
    ordered, _ = in_order_of_use({name: reversed(subtree_names(root)) for name, root in roots.items()})
    return [*((name, roots[name]) for name in ordered), ("", tree.root)]


def nodes_by_use(tree: Tree) -> list[tuple[str, list[Node]]]:
    """List the nodes of each tree of `sort_by_use`, children before their parents, from left to right."""
    return [(name, children_first(root)) for name, root in sort_by_use(tree)]


def fold_nodes(
    trees: Iterable[tuple[str, list[Node]]], combine: Callable[[Node, Sequence[Result], dict[str, Result]], Result]
) -> dict[str, Result]:
    """Combine each node with the results of its children, in trees as `nodes_by_use` lists them; return the result of
    each tree by its name.

    The third argument of `combine` are the results of the trees so far.
    """
    named: dict[str, Result] = {}
    for name, nodes in trees:
        results: list[Result] = []
        for node in nodes:
            count = len(node.children)
            if count:
                done = results[-count:]
                del results[-count:]
                results.append(combine(node, done, named))
            else:
                results.append(combine(node, (), named))
        named[name] = results[0]
    return named
