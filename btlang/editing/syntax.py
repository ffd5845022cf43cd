"""The syntax tree of a mission linked with its tree: parents, what a node of the tree was made of, and changes."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.passes import LOWERING, run_passes
from btlang.passes.compilation import Compilation
from btlang.support.record import Record
from btlang.tree import ast
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.passes.compilation import Origins


class SyntaxSlot(Record):
    """A place of a node in the syntax: the field of its parent, and its number there if that holds several."""

    parent: ast.Ast
    field: str
    at: int | None


class ChangeStep(Record):
    """A step of a change: siblings that others take the place of: `old` becomes `new`, both perhaps nothing.

    They stand in `parent`; if that holds several, from number `at` on. Several new ones make a chain of the `operator`.
    With `before`, what is put in belongs to what follows it, else to what is before it.
    """

    parent: ast.Ast
    field: str
    at: int | None
    old: tuple[ast.Ast, ...]
    new: tuple[ast.Ast, ...]
    operator: str = "sequence"
    before: bool = False


class Unplaced(Exception):
    """The error that what a form needs can't be taken out of it. The text says what."""


class Syntax:
    """The syntax of one mission that can be read. Included missions are no part of it."""

    def __init__(self, mission: ast.Program, vocabulary: Lexicon) -> None:
        self.mission = mission
        self.vocabulary = vocabulary
        self.nodes = ast.parents_first(mission)
        self.slots: dict[int, SyntaxSlot] = {}
        """Where each node stands, by its identity."""
        for node in self.nodes:
            for field in node.parts:
                part = getattr(node, field)
                if type(part) is tuple:
                    self.slots.update((id(each), SyntaxSlot(node, field, i)) for i, each in enumerate(part))
                elif part is not None:
                    self.slots[id(part)] = SyntaxSlot(node, field, None)

    def lowered(self) -> tuple[Tree, list[ast.Ast | None]]:
        """Return the tree, and of each of its nodes, in the order of `Tree.walk`, the syntax that says it, None for
        what is said elsewhere.
        """
        origins: Origins = {}
        tree = run_passes(Compilation(self.vocabulary, self.mission, origins=origins), LOWERING).tree
        return tree, self.sources(tree, origins)

    def sources(self, tree: Tree, origins: Origins) -> list[ast.Ast | None]:
        """Return what `lowered` does, of a tree that was made with `origins`."""
        return [node if id(node) in self.slots else None for node in _sources(tree, origins)]

    def is_condition(self, node: ast.Ast) -> bool:
        """Return whether it is one, and no command."""
        while isinstance(node, ast.Name):
            name = node.name
            node = next(each.body for each in ast.all_definitions(self.mission) if each.name == name)
        if isinstance(node, ast.Chain):
            return node.operator in ("all", "any")
        if isinstance(node, ast.Phrase):
            return node.entry.sort == "condition"
        if isinstance(node, ast.Exact):
            return node.is_condition
        return isinstance(node, ast.Not | ast.AtLeast | ast.Compared)

    def holder(self, node: ast.Ast) -> ast.Ast:
        """Return what a node stands in."""
        return self.slots[id(node)].parent

    def steps(
        self,
        old: Sequence[ast.Ast],
        new: Sequence[ast.Ast],
        at: int | None = None,
        operator: str = "sequence",
        before: bool = False,
    ) -> list[ChangeStep]:
        """Return what changes if some siblings become others, innermost first; the last step is one in the program.

        `new` may be empty. For an insertion into a chain `old` has the chain alone, and `at` is the place among its
        items, `before` as for a Step. Where no chain is, several new ones make one of the `operator`. Raises Unplaced.
        """
        steps = []
        if at is not None:
            [chain] = old
            step = ChangeStep(chain, "items", at, (), tuple(new), getattr(chain, "operator", operator), before)
        else:
            slot = self.slots[id(old[0])]
            operator = getattr(slot.parent, "operator", operator)
            step = ChangeStep(slot.parent, slot.field, slot.at, tuple(old), tuple(new), operator)
        while True:
            steps.append(step)
            if isinstance(step.parent, ast.Program):
                return steps
            slot = self.slots[id(step.parent)]
            operator = getattr(slot.parent, "operator", step.operator)
            step = ChangeStep(slot.parent, slot.field, slot.at, (step.parent,), _link(step), operator)

    def changed(self, last: ChangeStep) -> ast.Program:
        """Return the mission after the last of some steps. Raises Unplaced."""
        if last.field == "definitions":
            held = _replace_part(self.mission.definitions, last)
            return self.mission.replace(definitions=held)  # type: ignore[no-any-return]
        body = joined(last.new, last.operator) if last.new else None
        return self.mission.replace(body=body)  # type: ignore[no-any-return]


def are_equal(one: Tree, other: Tree) -> bool:
    """Return whether two trees are, in whatever order their subtrees were defined."""
    return (one.root, one.name) == (other.root, other.name) and dict(one.subtrees) == dict(other.subtrees)


def joined(items: Sequence[ast.Ast], operator: str, bracketed: bool = False) -> ast.Ast:
    """Join some siblings as one node."""
    return items[0] if len(items) == 1 else ast.Chain(operator, tuple(items), bracketed, items[0].span)


def _sources(tree: Tree, origins: Origins) -> list[ast.Ast | None]:
    """Return the syntax of each node: one that no syntax was lowered to belongs to the one around it."""
    found: list[ast.Ast | None] = []
    for root in (tree.root, *(node for _, node in tree.subtrees)):
        stack: list[tuple[Node, ast.Ast | None]] = [(root, None)]
        while stack:
            node, around = stack.pop()
            own = origins.get(id(node), (node, around))[1]
            found.append(own)
            stack.extend((child, own) for child in reversed(node.children))
    return found


def _replace_part(items: tuple[ast.Ast, ...], step: ChangeStep) -> tuple[ast.Ast, ...]:
    assert step.at is not None
    return (*items[: step.at], *step.new, *items[step.at + len(step.old) :])


def _link(step: ChangeStep) -> tuple[ast.Ast, ...]:
    """Return what takes the place of the parent of a step."""
    parent = step.parent
    if isinstance(parent, ast.Chain):
        items: list[ast.Ast] = []
        for item in _replace_part(parent.items, step):
            melts = type(item) is ast.Chain and item.operator == parent.operator and not item.bracketed
            items += item.items if melts and isinstance(item, ast.Chain) else (item,)
        if len(items) > 1:
            return (parent.replace(items=tuple(items)),)
        return tuple(items)
    if step.at is not None:
        items = list(_replace_part(getattr(parent, step.field), step))
        if not items and isinstance(parent, ast.Exact):
            return ()
        if isinstance(parent, ast.AtLeast) and len(items) < max(parent.number, 2):
            raise Unplaced("at least so many must be left")
        return (parent.replace(items=tuple(items)),)
    if step.new:
        return (parent.replace(**{step.field: joined(step.new, step.operator)}),)
    if step.field == "otherwise":
        return (parent.replace(otherwise=None),)
    has_more = getattr(parent, "otherwise", None) is not None
    if step.field == "condition" or isinstance(parent, ast.Definition) or has_more:
        raise Unplaced("what holds it needs it")
    return ()
