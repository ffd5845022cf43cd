"""AST to tree: names are ordered, each form is lowered, and the tree is checked by one pass after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.passes.lower import lower
from btlang.passes.names import order_of_use
from btlang.passes.resources import check_resources
from btlang.passes.scope import Scope
from btlang.passes.size import check_size
from btlang.passes.types import check_types
from btlang.tree.ast import Mission, exact_nodes
from btlang.tree.model import NodeModel
from btlang.tree.node import Node, Tree
from btlang.vocabulary.vocabulary import Vocabulary

PASSES: tuple[Callable[[Tree, Vocabulary], Iterable[Diagnostic]], ...] = (check_types, check_size, check_resources)
"""Checks of the lowered tree; each gives what is wrong."""


def compile_mission(mission: Mission, vocabulary: Vocabulary, *, needs_command: bool = True) -> Tree:
    """The tree of a mission. Its subtrees come in an order in which used ones precede their users.

    A text that only defines names is refused; where it needs no command, its tree does nothing.
    Raises MissionError with everything that the passes find (BT005, BT014, BT040 to BT042).
    """
    return checked(lower_mission(mission, vocabulary, needs_command=needs_command), vocabulary)


def lower_mission(mission: Mission, vocabulary: Vocabulary, *, needs_command: bool = True) -> Tree:
    """As `compile_mission`, without the checks of the tree."""
    ordered, problems = order_of_use(mission)
    if problems:
        raise MissionError(problems)
    scope = Scope((definition.name for definition in ordered), vocabulary.types)
    subtrees = scope.bodies
    for definition in ordered:
        lowered = lower(definition.body, scope)
        subtrees.append((definition.name, lowered.node))
        scope.define(definition, lowered.can_skip)
    if mission.body is None and needs_command:
        last = mission.definitions[-1] if mission.definitions else None
        example = "move forward 1 m" if last is None else f'do subtree "{last.name}"' if last.is_quoted else last.name
        raise MissionError([diagnostic("BT005", mission.span, example=example)])
    root = Node("AlwaysSuccess") if mission.body is None else lower(mission.body, scope).node
    conditions = dict.fromkeys(node.id for node in exact_nodes(mission) if node.is_condition)
    return Tree(root, tuple(subtrees), mission.name, tuple(NodeModel("Condition", id) for id in conditions))


def checked(tree: Tree, vocabulary: Vocabulary) -> Tree:
    """The tree itself. Raises MissionError with everything that the passes find."""
    problems = [problem for check in PASSES for problem in check(tree, vocabulary)]
    if problems:
        raise MissionError(problems)
    return tree
