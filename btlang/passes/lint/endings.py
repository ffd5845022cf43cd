"""How a node can end, as far as its kind tells. What is not known is taken to be able to end in every way."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

SUCCESS, FAILURE, SKIPPED, NEVER = 1, 2, 4, 8
Ends: TypeAlias = int
"""A sum of these four; NEVER: it may run for ever."""

_NUMBER = re.compile(r"[0-9]{1,9}")
ANY: Ends = SUCCESS | FAILURE | SKIPPED
EITHER: Ends = SUCCESS | FAILURE


def ends_of(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
    """The ways in which a node can end, given those of its children and those of the defined names."""
    if node.ports and node.port("_skipIf") == "true":
        return SKIPPED
    if node.id == "SubTree":
        return named.get(node.port("ID"), ANY)
    if node.id in _LEAVES:
        return _LEAVES[node.id]
    known = _KINDS.get(node.id)
    if known is None or len(children) < _LEAST.get(node.id, 1):
        return ANY if children else EITHER  # with too few children no mission runs, which is told elsewhere
    return known(node, children)


def going_on(node: Node) -> Ends:
    """The endings of a child at which a Sequence or Fallback comes to the next one."""
    return SKIPPED | (FAILURE if node.id == "Fallback" else SUCCESS)


def _in_turn(on: int) -> Callable[[Node, Sequence[Ends]], Ends]:
    """Sequence and Fallback: they go on to the next child at SKIPPED and at the status `on`."""
    going_on = on | SKIPPED

    def ends(_node: Node, children: Sequence[Ends]) -> Ends:
        some, each = 0, SKIPPED
        for child in children:
            if not child & going_on:
                return (some & ~going_on) | child
            some |= child
            each &= child
        return (some & ~SKIPPED) | each

    return ends


def _at_once(node: Node, children: Sequence[Ends]) -> Ends:
    """Parallel: it succeeds with `success_count` of its children, fails with `failure_count` of them."""
    wanted = node.port("success_count")
    least = int(wanted) if _NUMBER.fullmatch(wanted) else len(children)
    found = 0
    if sum(bool(child & (SUCCESS | SKIPPED)) for child in children) >= least:
        found |= SUCCESS
    if any(child & FAILURE for child in children):
        found |= FAILURE
    if sum(not child & NEVER for child in children) < least:
        found |= NEVER
    return found


def _rounds(again: int, port: str) -> Callable[[Node, Sequence[Ends]], Ends]:
    """Repeat and RetryUntilSuccessful: another round at the status `again`."""

    def ends(node: Node, children: Sequence[Ends]) -> Ends:
        if node.port(port) != "-1":
            return children[0]
        return (children[0] & ~again) | NEVER

    return ends


def _turned(change: dict[int, int]) -> Callable[[Node, Sequence[Ends]], Ends]:
    def ends(_node: Node, children: Sequence[Ends]) -> Ends:
        return sum({change.get(end, end) for end in (SUCCESS, FAILURE, SKIPPED, NEVER) if children[0] & end})

    return ends


def _branches(node: Node, children: Sequence[Ends]) -> Ends:
    """The condition of `while` ends a branch that would not end by itself."""
    found = children[1] | (children[2] if len(children) > 2 else FAILURE)
    return found & ~NEVER if node.id == "WhileDoElse" else found


def _same(also: int = 0, but: int = 0) -> Callable[[Node, Sequence[Ends]], Ends]:
    return lambda _node, children: (children[0] | also) & ~but


def _ruled(_node: Node, children: Sequence[Ends]) -> Ends:
    """Whenever: its block fails too where the reaction does."""
    return children[2] | (children[1] & FAILURE)


_LEAVES: dict[str, Ends] = {"Sleep": SUCCESS, "AlwaysSuccess": SUCCESS, "AlwaysFailure": FAILURE}
_KINDS: dict[str, Callable[[Node, Sequence[Ends]], Ends]] = {
    "Sequence": _in_turn(SUCCESS),
    "ReactiveSequence": _in_turn(SUCCESS),
    "Fallback": _in_turn(FAILURE),
    "Parallel": _at_once,
    "IfThenElse": _branches,
    "WhileDoElse": _branches,
    "Whenever": _ruled,
    "Inverter": _turned({SUCCESS: FAILURE, FAILURE: SUCCESS}),
    "ForceSuccess": _turned({FAILURE: SUCCESS}),
    "ForceFailure": _turned({SUCCESS: FAILURE}),
    "Repeat": _rounds(SUCCESS, "num_cycles"),
    "RetryUntilSuccessful": _rounds(FAILURE, "num_attempts"),
    "Timeout": _same(FAILURE, but=NEVER),
    "Delay": _same(),
}
_LEAST = {"IfThenElse": 2, "WhileDoElse": 2, "Whenever": 3}
"""How many children those look at that need more than one."""
