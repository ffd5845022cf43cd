"""Building trees of py_trees in this process."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import cache

from py_trees import behaviours, common, composites, decorators
from py_trees.behaviour import Behaviour

from btlang.backends.engine import bind_leaf
from btlang.backends.py_trees import control_nodes, node, sequences
from btlang.backends.py_trees import decorators as own_decorators
from btlang.backends.py_trees.plan import ON_COMPLETION, Part, Variable, plan_of
from btlang.backends.py_trees.values import engine_leaf, values_of
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import EngineError
from btlang.text.source import NOWHERE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def to_py_trees(
    tree: Tree,
    vocabulary: Lexicon,
    *,
    bind: Callable[[Node], Behaviour] | None = None,
    is_action: Callable[[Node], bool] | None = None,
    now: Callable[[], float] = time.monotonic,
    services: Mapping[str, Any] = {},
    values: Blackboard | None = None,
) -> Behaviour:
    """Return the root of a tree of py_trees 2.6 that has the statuses of btlang's engine; SKIPPED is INVALID there.

    `bind` makes the leaves, by default such that do what the `call` of their keyword entry names; those may ask for
    `services`, such as {"robot": robot}. KeepOut and KeepIn use the `zones` of that robot. A leaf of `bind` may not be
    INVALID after a tick. `is_action` says which leaves take more than one tick, by default those that are no
    conditions. `now` is the time in seconds, `values` are those of the mission.

    Raises MissionError with all that is wrong with the tree (BT126, BT131, BT132), a leaf that has no keyword entry or
    cannot be bound (BT132), or all that py_trees can't express (BT134).
    """
    plan = plan_of(tree, vocabulary, is_action)
    known: dict[str, Any] = {
        "now": now,
        "interrupts": [],
        "values": Blackboard() if values is None else values,
        "zones": getattr(services.get("robot"), "zones", None),
        ON_COMPLETION: common.OneShotPolicy.ON_COMPLETION,
    }
    for scope in plan.scopes:
        known[scope.name] = values_of(dict(scope.ports), known[scope.around])
    bound = cache(lambda id: bind_leaf(id, vocabulary))

    def made(part: Part, children: list[Behaviour]) -> Behaviour:
        arguments = {key: known[value.text] if isinstance(value, Variable) else value for key, value in part.arguments}
        if part.make == "engine_leaf" or (part.make == "leaf" and bind is None):
            arguments = {"now": now, **arguments}
            leaf: Behaviour = engine_leaf(part.name, bind=bound, services=services, **arguments)
        elif part.make == "leaf":
            assert bind is not None
            leaf = bind(Node(arguments["id"], ports=tuple(arguments["ports"].items())))
        elif part.make.startswith("decorators."):
            [child] = children
            return CLASSES[part.make](part.name, child, **arguments)
        else:
            return CLASSES[part.make](part.name, **({"children": children} if children else {}), **arguments)
        return node.interrupting(leaf, known["interrupts"]) if part.starts else leaf

    try:
        return fold(plan.root, lambda part: part.children, made)
    except EngineError as error:
        span = error.node.span or NOWHERE
        raise MissionError([diagnostic("BT132", span, id=error.node.id, reason=error.message)]) from None


CLASSES: dict[str, Callable[..., Behaviour]] = {
    **{
        name: made
        for module in (node, sequences, control_nodes, own_decorators)
        for name, made in vars(module).items()
        if isinstance(made, type) and issubclass(made, Behaviour)
    },
    **{
        f"{module.__name__.removeprefix('py_trees.')}.{name}": made
        for module in (behaviours, composites, decorators)
        for name, made in vars(module).items()
        if isinstance(made, type) and issubclass(made, Behaviour)
    },
}
