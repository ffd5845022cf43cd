"""Endings of nodes, as far as their kind shows. An unknown kind is taken to end in every way."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from btlang.passes.compilation import fold_nodes, nodes_by_use
from btlang.tree.catalogue import CATALOGUE, PRE_CONDITIONS, SUBTREE, NodeKind
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

SUCCESS, FAILURE, SKIPPED, NEVER = 1, 2, 4, 8
Ends: TypeAlias = int
"""A sum of these four; NEVER: it may run for ever."""

_NUMBER = re.compile(r"[0-9]{1,9}")
ANY: Ends = SUCCESS | FAILURE | SKIPPED
EITHER: Ends = SUCCESS | FAILURE


def find_ends(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
    """Find the ways in which a node can end, given those of its children and those of the defined names."""
    decided, may_start = _before(node) if any(port in PRE_CONDITIONS for port, _ in node.ports) else (0, True)
    return decided | _ends(node, children, named) if may_start else decided


def find_mission_ends(tree: Tree) -> Ends:
    """Find the ways in which a whole tree can end."""
    return fold_nodes(nodes_by_use(tree), find_ends)[""]


def _before(node: Node) -> tuple[Ends, bool]:
    """Return the endings that pre-conditions decide, and whether the node may start. `_while` also ends a running
    node.
    """
    found = 0
    for port, (answer, ending) in PRE_CONDITIONS.items():
        text = node.port(port).strip()
        always = {"true": True, "1": True, "false": False, "0": False}.get(text)
        if not text or always is (not answer):
            continue
        found |= _NAMED[ending]
        if always is answer:
            return found, False
    return found, True


def _ends(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
    if node.id == SUBTREE:
        return named.get(node.port("ID"), ANY)
    kind = CATALOGUE.get(node.id)
    if kind is None or len(children) < kind.least:
        return ANY if children else EITHER  # with too few children no mission runs, which is reported elsewhere
    if not children:
        return _sum(kind.ends) if kind.ends else EITHER
    if kind.goes_on and not kind.rotates:
        return _in_order(_NAMED[kind.goes_on] | SKIPPED, children)
    if kind.enough:
        return _at_once(node.port(kind.enough), children)
    if kind.roles:
        return _branches(kind, children)
    if kind.most == 1:
        return _decorator(kind, node, children[0])
    return ANY


def continuing_ends(kind: NodeKind) -> Ends:
    """Return the endings of a child at which a node whose children follow in order comes to the next one."""
    return SKIPPED | _NAMED[kind.goes_on]


def _in_order(continuing_ends: Ends, children: Sequence[Ends]) -> Ends:
    some, each = 0, SKIPPED
    for child in children:
        if not child & continuing_ends:
            return (some & ~continuing_ends) | child
        some |= child
        each &= child
    return (some & ~SKIPPED) | each


def _at_once(enough: str, children: Sequence[Ends]) -> Ends:
    """Return the endings of a Parallel that succeeds with `enough` of its children."""
    least = int(enough) if _NUMBER.fullmatch(enough) else len(children)
    found = 0
    if sum(bool(child & (SUCCESS | SKIPPED)) for child in children) >= least:
        found |= SUCCESS
    if any(child & FAILURE for child in children):
        found |= FAILURE
    if sum(not child & NEVER for child in children) < least:
        found |= NEVER
    return found


def _branches(kind: NodeKind, children: Sequence[Ends]) -> Ends:
    """Return the endings of branches. A branch that never ends may be interrupted. A rule fails if its reaction
    does.
    """
    if "reaction" in kind.roles:
        return children[2] | (children[1] & FAILURE)
    found = children[1] | (children[2] if len(children) > 2 else FAILURE)
    return found & ~NEVER if kind.interrupts else found


def _decorator(kind: NodeKind, node: Node, child: Ends) -> Ends:
    if kind.turns:
        turns = {_NAMED[before]: _NAMED[after] for before, after in kind.turns}
        return sum({turns.get(end, end) for end in (SUCCESS, FAILURE, SKIPPED, NEVER) if child & end})
    if kind.again:
        if not kind.is_endless(node.ports):
            return child if kind.rounds else ANY
        kept = child & ~_NAMED[kind.again]
        return (kept & ~SKIPPED if kind.skipped == "never" else kept) | NEVER
    if kind.interrupts:
        return (child | FAILURE) & ~NEVER
    return child if kind.takes_time or kind.waits else ANY


def _sum(names: Iterable[str]) -> Ends:
    return sum(_NAMED[name] for name in names)


_NAMED = {"SUCCESS": SUCCESS, "FAILURE": FAILURE, "SKIPPED": SKIPPED}
