"""Actions that start again at each tick (BT243), and scripts that BehaviorTree.CPP 4.10 refuses or ignores (BT242,
BT247).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from btlang.backends.wording import asks_or_checks, id_words
from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.engine.script.tokens import ScriptError, Tokens
from btlang.projects.ports import attribute_value
from btlang.tree.catalogue import CATALOGUE, ON_SUCCESS, SCRIPT, port_content
from btlang.tree.node import Node


def restarted_actions(nodes: Iterable[Node], sort_of: Callable[[Node], str]) -> Iterator[Diagnostic]:
    """Report BT243 for actions that succeed and start again, because a later child of a ReactiveSequence may run on.

    `sort_of` says of a leaf whether it is an "Action" that isn't meant for each tick, a "Condition", or "" for what
    isn't known.
    """
    for node in nodes:
        kind = CATALOGUE.get(node.id)
        if kind is None or not kind.reactive or kind.goes_on != ON_SUCCESS:
            continue
        for at, child in enumerate(node.children[:-1]):
            later = node.children[at + 1 :]
            if not child.children and sort_of(child) == "Action" and child.span is not None:
                if any(each.children or sort_of(each) != "Condition" for each in later):
                    yield diagnostic("BT243", child.span, id=child.id, parent=node.id)


_SETTING = ("set", "unset", "reset", "update", "clear")
_PUBLISHING = ("pub", "publish")


def may_be_repeated(node_id: str, is_instant: Callable[[str], bool]) -> bool:
    """Return whether an action is worded as one that may be done at each tick: it asks, publishes, or sets a value at
    once.
    """
    first = id_words(node_id)[0]
    return asks_or_checks(node_id) or first in _PUBLISHING or (first in _SETTING and is_instant(node_id))


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
