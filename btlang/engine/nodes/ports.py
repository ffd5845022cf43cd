"""Ports of nodes as functions: what the text says, or what is under its `{key}` at the time of the call.

A text that makes no sense raises EngineError when the tree is compiled; what is under a key raises ActionFailed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.engine.instance import NodeInstance, blackboard_key, value_of
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.script.values import as_text
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.tree.catalogue import CATALOGUE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    T = TypeVar("T")

TRUTHS = {"true": True, "1": True, "false": False, "0": False}
STATUSES = {"SUCCESS": SUCCESS, "FAILURE": FAILURE, "SKIPPED": SKIPPED, "RUNNING": RUNNING}


def value_port(instance: NodeInstance, port: str, convert: Callable[[Any], T]) -> Callable[[], T]:
    """Make a function that returns the converted value of a port. `convert` raises ActionFailed for what it can't
    take.
    """
    text = instance.node.port(port)
    key = blackboard_key(port, text)
    if key is not None:
        return lambda: convert(value_of(instance.scope, key))
    default = CATALOGUE[instance.node.id].ports[port].default
    if not text and default is None:
        raise instance.error(f"{instance.node.id} needs a port {port}")
    try:
        value = convert(text or default)
    except ActionFailed as problem:
        raise instance.error(str(problem)) from None
    return lambda: value


def choice_port(instance: NodeInstance, port: str, table: Mapping[str, T]) -> Callable[[], T]:
    """Make a function as `value_port` does, for a port that takes one of some words."""

    def convert(value: Any) -> T:
        word = as_text(value)
        if word not in table:
            raise ActionFailed(f"{port} must be {' or '.join(table)}, not {word!r}")
        return table[word]

    return value_port(instance, port, convert)


def rate_port(instance: NodeInstance, port: str) -> Callable[[], float]:
    """Make a function as `value_port` does, for a number above 0."""

    def convert(value: Any) -> float:
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = 0.0
        if not 0 < number < float("inf"):
            raise ActionFailed(f"{port} must be a number above 0, not {str(value)!r}")
        return number

    return value_port(instance, port, convert)


def key_port(instance: NodeInstance, port: str) -> str:
    """Return the key that a port names, with or without braces."""
    text = instance.node.port(port)
    key = blackboard_key(port, text) or text
    if not key:
        raise instance.error(f"{instance.node.id} needs a port {port}")
    return key
