"""Lifting of live trees of py_trees to trees of btlang, by the tables of plan.py in the other direction."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from py_trees import common, composites, decorators, trees
from py_trees.behaviour import Behaviour

from btlang.backends.py_trees import decorators as own_decorators
from btlang.backends.py_trees import node
from btlang.backends.py_trees.build import CLASSES
from btlang.backends.py_trees.plan import NUMBERS, ON_COMPLETION, OURS, THEIRS, Variable
from btlang.backends.py_trees.values import EngineLeaf
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.engine.leaves.leaf import REFUSED, ActionFailed, Failed
from btlang.text.source import NOWHERE, Span
from btlang.tree.catalogue import CATALOGUE, SUBTREE, Port
from btlang.tree.node import Node
from btlang.tree.visit import fold
from btlang.vocabulary.entry import Entry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_BASES = (Behaviour, composites.Composite, decorators.Decorator)
_MAKES = {made: name for name, made in CLASSES.items() if made not in _BASES}
_CONSTANTS = {ON_COMPLETION: common.OneShotPolicy.ON_COMPLETION}
_PRIVATE = re.compile(r"\b_\w")  # a key that no scope shares
_STEPS = ("tick", "stop", "initialise", "update", "terminate")
"""The methods that make a node of py_trees what it is."""


class _NoCounterpart(Exception):
    """An error that says why btlang has no counterpart of a node."""


def read_py_trees(
    root: object, span: Span | None = None, names: bool = True
) -> tuple[Node, Mapping[str, Callable[..., Any]]]:
    """Make a node of a py_trees tree, and by their ids the leaf classes that tick its plain behaviours.

    Ports that have their defaults are left out, and without `names` the names of behaviours. Raises TypeError for
    anything else, MissionError (BT134, at `span`) for all nodes that have no counterpart.
    """
    if isinstance(root, trees.BehaviourTree):
        root = root.root
    if not isinstance(root, Behaviour):
        raise TypeError(f"a tree of py_trees is a Behaviour or a BehaviourTree, not a {type(root).__name__}")
    leaves: dict[str, Callable[..., Any]] = {}
    problems: list[Diagnostic] = []
    scopes: set[int] = set()

    def made(behaviour: Behaviour, children: list[Node]) -> Node:
        try:
            if isinstance(behaviour, EngineLeaf):
                return _engine_leaf(behaviour, scopes)
            found = _find_counterpart(behaviour)
            if found is None:
                leaf_id = _find_unused_id(behaviour.name, leaves)
                leaves[leaf_id] = behaviour_leaf(behaviour, leaf_id)
                return Node(leaf_id, name=behaviour.name if names else "")
            node_id, ports = found
        except _NoCounterpart as problem:
            kind = f"{type(behaviour).__module__}.{type(behaviour).__qualname__}"
            reason = f"it is a {kind}, {problem}"
            problems.append(diagnostic("BT134", span or NOWHERE, id=behaviour.name, target="btlang", reason=reason))
            return Node("AlwaysFailure")
        if node_id == SUBTREE:  # it only passes a status on
            return children[0]
        known = CATALOGUE[node_id].ports
        given = tuple((port, text) for port, text in ports.items() if port not in known or text != known[port].default)
        named = names and children and behaviour.name not in (node_id, type(behaviour).__name__)
        return Node(node_id, tuple(children), given, behaviour.name if named else "")

    tree = fold(root, lambda behaviour: behaviour.children, made)
    if problems:
        raise MissionError(problems)
    return tree, leaves


def behaviour_leaf(behaviour: Behaviour, leaf_id: str) -> Callable[..., Any]:
    """Make a leaf class that ticks a behaviour: `initialise`, `update` and `terminate` are called as py_trees does."""

    class BehaviourLeaf:
        interrupts = False  # it may only be asked something: py_trees doesn't say

        def start(self) -> bool | Failed | None:
            if behaviour.status == common.Status.RUNNING:  # from a tree that was ticked before
                self.halt()
            return self.tick()

        def tick(self) -> bool | Failed | None:
            behaviour.tick_once()
            if behaviour.status == common.Status.INVALID:
                raise ActionFailed("it is INVALID after a tick")
            if behaviour.status == common.Status.FAILURE:
                return Failed(behaviour.feedback_message or REFUSED)
            return None if behaviour.status == common.Status.RUNNING else True

        def halt(self) -> None:
            behaviour.stop(common.Status.INVALID)

    leaf: Any = BehaviourLeaf
    leaf.btlang_entry = Entry("action", leaf_id, (), leaf, help=f"The behaviour '{behaviour.name}' of py_trees.")
    return leaf  # type: ignore[no-any-return]


def _find_unused_id(name: str, leaves: Mapping[str, object]) -> str:
    """Return an id for a behaviour that no word and no other leaf has."""
    words = "".join(letter if letter.isascii() and letter.isalnum() else " " for letter in name).split()
    made = "".join(["Behaviour", *(word[0].upper() + word[1:] for word in words)])
    return next(found for found in (made, *(f"{made}_{at}" for at in range(2, len(leaves) + 3))) if found not in leaves)


def _engine_leaf(leaf: EngineLeaf, scopes: set[int]) -> Node:
    found, values = leaf.engine.node(0), leaf.engine.blackboard
    texts = [text for _, text in found.ports]
    if found.id in CATALOGUE or any("{" in text for text in texts):
        scopes.add(id(values if any(map(_PRIVATE.search, texts)) else values.shared))
        if len(scopes) > 1:
            raise _NoCounterpart("and its values are those of a subtree")
    return found


def _find_counterpart(behaviour: Behaviour) -> tuple[str, dict[str, str]] | None:
    """Return the id and the ports of a node that has a counterpart; None for a plain behaviour."""
    kinds = type(behaviour).__mro__
    at = next((at for at, kind in enumerate(kinds) if kind in _MAKES), len(kinds))
    is_leaf = not behaviour.children and not isinstance(behaviour, _BASES[1:])
    if at == len(kinds) or (is_leaf and (at or _MAKES[kinds[at]] not in _LEAVES)):
        if not is_leaf:
            raise _NoCounterpart("which isn't a node of py_trees itself")
        return None
    if any(step in vars(kind) for kind in kinds[:at] for step in _STEPS):
        raise _NoCounterpart(f"which changes what a {kinds[at].__name__} does")
    return _counterpart(_MAKES[kinds[at]], behaviour)


def _counterpart(make: str, behaviour: Any) -> tuple[str, dict[str, str]]:
    if make in _LEAVES:
        return _LEAVES[make](behaviour)
    if make in _NEAR:
        return _NEAR[make](behaviour)
    for node_id, (theirs, arguments) in THEIRS.items():
        if theirs == make and all(_holds(behaviour, *argument) for argument in arguments):
            return node_id, {"then_skip": "false"} if node_id == "RunOnce" else {}
    if "." in make or make == "Skipped":
        raise _NoCounterpart("which has no counterpart")
    node_id = next((ours for ours, name in OURS.items() if name == make), "")
    node_id = node_id or next((ours for ours, (name, _) in NUMBERS.items() if name == make), make)
    names = NUMBERS[node_id][1] if node_id in NUMBERS else ()
    ports = CATALOGUE[node_id].ports
    read = dict(zip(ports, names, strict=False)) or {port: _ATTRIBUTES.get(port, port) for port in ports}
    return node_id, {
        port: _text(ports[port], getattr(behaviour, attribute))
        for port, attribute in read.items()
        if hasattr(behaviour, attribute)
    }


def _holds(behaviour: object, attribute: str, value: object) -> bool:
    wanted = _CONSTANTS[value.text] if isinstance(value, Variable) else value
    return bool(getattr(behaviour, attribute) == wanted)


_ATTRIBUTES = {"zones": "names"}
"""Attributes of our classes that are called otherwise than the port."""


def _text(port: Port, value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return "; ".join(value)
    if port.unit == "ms":
        return str(round(value * 1000))
    return f"{1 / value:.12g}" if port.unit == "Hz" else str(value)


def _parallel(behaviour: composites.Parallel) -> tuple[str, dict[str, str]]:
    policy: Any = behaviour.policy
    if isinstance(policy, common.ParallelPolicy.SuccessOnOne):
        return "Parallel", {"success_count": "1", "failure_count": "1"}
    selected = getattr(policy, "children", behaviour.children)
    if len(selected) < len(behaviour.children):
        raise _NoCounterpart("and btlang can't select the children that must succeed")
    if not policy.synchronise and len(selected) > 1:
        raise _NoCounterpart("and btlang doesn't tick children again that have succeeded: set synchronise=True")
    return "Parallel", {"success_count": "-1", "failure_count": "1"}


def _retry(behaviour: decorators.Retry) -> tuple[str, dict[str, str]]:
    return "RetryUntilSuccessful", {"num_attempts": str(max(behaviour.num_failures, 1))}


def _repeat(behaviour: decorators.Repeat) -> tuple[str, dict[str, str]]:
    count = behaviour.num_success  # one below 1 is never reached
    return "Repeat", {"num_cycles": str(count if count > 0 else -1)}


def _timeout(behaviour: decorators.Timeout) -> tuple[str, dict[str, str]]:
    return "Timeout", {"msec": str(max(round(behaviour.duration * 1000), 1))}


_LEAVES: dict[str, Callable[[Any], tuple[str, dict[str, str]]]] = {
    "behaviours.Success": lambda behaviour: ("AlwaysSuccess", {}),
    "behaviours.Failure": lambda behaviour: ("AlwaysFailure", {}),
    node.Skipped.__name__: lambda behaviour: ("AlwaysSuccess", {"_skipIf": "true"}),
    own_decorators.Sleep.__name__: lambda behaviour: ("Sleep", {"msec": str(round(behaviour.seconds * 1000))}),
}
_NEAR: dict[str, Callable[[Any], tuple[str, dict[str, str]]]] = {
    "composites.Parallel": _parallel,
    "decorators.Inverter": lambda behaviour: ("Inverter", {}),
    "decorators.Repeat": _repeat,
    "decorators.Retry": _retry,
    "decorators.Timeout": _timeout,
}
"""Nodes of py_trees for which the target uses ours: docs/engine.md says how they differ."""
