"""How a node can end, as far as its kind tells. What is not known is taken to be able to end in every way."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

SUCCESS, FAILURE, SKIPPED, NEVER = "success", "failure", "skipped", "never"
Ends: TypeAlias = frozenset[str]
"""A set of these four; NEVER: it may run for ever."""

ANY: Ends = frozenset((SUCCESS, FAILURE, SKIPPED))
EITHER: Ends = frozenset((SUCCESS, FAILURE))


def ends_of(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
    """The ways in which a node can end, given those of its children and those of the defined names."""
    if node.port("_skipIf") == "true":
        return frozenset((SKIPPED,))
    if node.id == "SubTree":
        return named.get(node.port("ID"), ANY)
    known = _KINDS.get(node.id)
    if known is not None:
        return known(node, children)
    return ANY if children else EITHER


def goes_on(node: Node, ends: Ends) -> bool:
    """Whether a Sequence or Fallback can come to the child behind one that ends so."""
    return bool(ends & {SKIPPED, FAILURE if node.id == "Fallback" else SUCCESS})


def _in_turn(on: str) -> Callable[[Node, Sequence[Ends]], Ends]:
    """Sequence and Fallback: they go on to the next child at SKIPPED and at the status `on`."""

    def ends(_node: Node, children: Sequence[Ends]) -> Ends:
        found: set[str] = set()
        for child in children:
            found |= child - {on, SKIPPED}
            if not child & {on, SKIPPED}:
                return frozenset(found)
        if any(on in child for child in children):
            found.add(on)
        if all(SKIPPED in child for child in children):
            found.add(SKIPPED)
        return frozenset(found)

    return ends


def _at_once(node: Node, children: Sequence[Ends]) -> Ends:
    """Parallel: it succeeds with `success_count` of its children, fails with `failure_count` of them."""
    wanted = node.port("success_count")
    least = int(wanted) if wanted.isdigit() else len(children)
    found: set[str] = set()
    if sum(bool(child & {SUCCESS, SKIPPED}) for child in children) >= least:
        found.add(SUCCESS)
    if any(FAILURE in child for child in children):
        found.add(FAILURE)
    if sum(NEVER not in child for child in children) < least:
        found.add(NEVER)
    return frozenset(found)


def _rounds(again: str, port: str) -> Callable[[Node, Sequence[Ends]], Ends]:
    """Repeat and RetryUntilSuccessful: another round at the status `again`."""

    def ends(node: Node, children: Sequence[Ends]) -> Ends:
        if node.port(port) != "-1":
            return children[0]
        return (children[0] - {again}) | {NEVER}

    return ends


def _turned(change: dict[str, str]) -> Callable[[Node, Sequence[Ends]], Ends]:
    return lambda _node, children: frozenset(change.get(end, end) for end in children[0])


def _branches(node: Node, children: Sequence[Ends]) -> Ends:
    """The condition of `while` ends a branch that would not end by itself."""
    found = frozenset().union(*children[1:]) if len(children) > 2 else children[1] | {FAILURE}
    return found - {NEVER} if node.id == "WhileDoElse" else found


def _same(*also: str, but: str = "") -> Callable[[Node, Sequence[Ends]], Ends]:
    return lambda _node, children: (children[0] | set(also)) - {but}


def _ruled(_node: Node, children: Sequence[Ends]) -> Ends:
    """Whenever: its block fails too where the reaction does."""
    return children[2] | (children[1] & {FAILURE})


def _always(*ends: str) -> Callable[[Node, Sequence[Ends]], Ends]:
    return lambda _node, _children: frozenset(ends)


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
    "Sleep": _always(SUCCESS),
    "AlwaysSuccess": _always(SUCCESS),
    "AlwaysFailure": _always(FAILURE),
}
