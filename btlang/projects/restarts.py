"""Actions that start again at each tick (BT243), and what BehaviorTree.CPP 4 refuses or ignores: scripts (BT242, BT247)
and names of version 3 (BT132).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping

from btlang.backends.wording import asks_or_checks, id_words
from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.engine.script.tokens import ScriptError, Tokens
from btlang.frontends.btcpp.spelling import AUTOREMAP, AUTOREMAP_3, SHARED, TO_4
from btlang.projects.ports import attribute_value, place_of
from btlang.tree.catalogue import CATALOGUE, ON_SUCCESS, SCRIPT, SUBTREE, port_content
from btlang.tree.node import Node

INSTANT = "Instant"
_SEVERAL = 3


def restarted_actions(
    nodes: Iterable[Node], sort_of: Callable[[Node], str], trees: Mapping[str, Node]
) -> Iterator[Diagnostic]:
    """Report BT243 for actions that succeed and start again, because a later child of a ReactiveSequence may run on.

    They may be in a Sequence or a tree, which start again as a whole. `sort_of` says of a leaf whether it is an
    "Action" that isn't meant for each tick, or INSTANT if that ends at once, a "Condition", or "" for what isn't known.
    A team that has instant ones there in several places means it.
    """
    instant: list[Diagnostic] = []
    for node in nodes:
        kind = CATALOGUE.get(node.id)
        if kind is None or not kind.reactive or kind.goes_on != ON_SUCCESS:
            continue
        for at, child in enumerate(node.children[:-1]):
            later = node.children[at + 1 :]
            if child.span is not None and any(_may_run_on(each, sort_of) for each in later):
                action = _first_action(child, sort_of, trees, ())
                if action is not None:
                    inner = () if action is child else ((place_of(action), "this starts again"),)
                    problem = diagnostic("BT243", child.span, inner, None, id=action.id, parent=node.id)
                    if sort_of(action) == INSTANT:
                        instant.append(problem)
                    else:
                        yield problem
    if len(instant) < _SEVERAL:
        yield from instant


def _may_run_on(node: Node, sort_of: Callable[[Node], str]) -> bool:
    """Return whether a node may take longer than a tick: what takes time does, or something in it."""
    kind = CATALOGUE.get(node.id)
    if not node.children or kind is None or kind.takes_time or kind.again:
        return sort_of(node) not in ("Condition", INSTANT)
    return any(_may_run_on(child, sort_of) for child in node.children)


_ONLY_SOMETIMES = ("_skipIf", "_successIf", "_while")


def _first_action(
    node: Node, sort_of: Callable[[Node], str], trees: Mapping[str, Node], above: tuple[str, ...]
) -> Node | None:
    """Return the first action that surely was done when a node succeeds; none that a condition may leave out."""
    if any(node.port(condition) for condition in _ONLY_SOMETIMES):
        return None
    tree = node.port("ID") if node.id == SUBTREE else ""
    if tree in trees and tree not in above:
        return _first_action(trees[tree], sort_of, trees, (*above, tree))
    kind = CATALOGUE.get(node.id)
    if kind is not None and kind.goes_on == ON_SUCCESS:
        inner = (_first_action(child, sort_of, trees, above) for child in node.children)
        return next((action for action in inner if action is not None), None)
    return node if not node.children and sort_of(node) in ("Action", INSTANT) else None


_SETTING = ("set", "unset", "reset", "update", "clear")
_PUBLISHING = ("pub", "publish")


def may_be_repeated(node_id: str, is_instant: bool) -> bool:
    """Return whether an action is worded as one that may be done at each tick: it asks, publishes, or sets a value at
    once.
    """
    first = id_words(node_id)[0]
    return asks_or_checks(node_id) or first in _PUBLISHING or (first in _SETTING and is_instant)


_TAG = re.compile(r"<(\w+)")
_REGISTERED_AGAIN = frozenset(("SequenceStar",))  # by BehaviorTree.CPP 4, for those who know it
_ATTRIBUTES_4 = {AUTOREMAP_3: AUTOREMAP, SHARED: AUTOREMAP}


def names_of_version_3(nodes: Iterable[Node], described: Container[str]) -> Iterator[Diagnostic]:
    """Report BT132 for nodes and attributes that format 4 has under another name, unless somebody has such nodes."""
    for node in nodes:
        match = _TAG.match(place_of(node).text)
        tag = match[1] if match is not None else ""
        if node.id == TO_4.get(tag) and tag not in _REGISTERED_AGAIN and tag not in described:
            yield diagnostic("BT132", place_of(node), id=tag, reason=f"format 4 calls it {node.id}")
        for name, _ in node.ports if node.id == SUBTREE else ():
            if name in _ATTRIBUTES_4:
                reason = f"format 4 has {_ATTRIBUTES_4[name]} in place of {name}"
                yield diagnostic("BT132", place_of(node), id=SUBTREE, reason=reason)


def double_quotes(nodes: Iterable[Node]) -> Iterator[Diagnostic]:
    """Report BT242 for scripts with a text in double quotes."""
    for node in nodes:
        for port, code in node.ports:
            text = _double_quoted(code) if '"' in code and port_content(node.id, port) == SCRIPT else ""
            if text:
                yield diagnostic("BT242", attribute_value(node, port), text=text[1:-1])


def conditions_of_others(nodes: Iterable[Node]) -> Iterator[Diagnostic]:
    """Report BT247 for pre-conditions that BehaviorTree.CPP doesn't know."""
    for node in nodes:
        code = node.port("_onlyIf").strip()
        if code:
            script = f"!{code}" if code.isidentifier() else f"!({code})"
            yield diagnostic("BT247", attribute_value(node, "_onlyIf"), script=script)


def _double_quoted(code: str) -> str:
    """Return the first text in double quotes; "" if there isn't any, or the code is no script."""
    try:
        tokens = Tokens(code)
        while tokens.kind != "end":
            if tokens.kind == "text" and tokens.text[0] == '"':
                return tokens.text
            tokens.advance()
    except ScriptError:
        pass
    return ""
