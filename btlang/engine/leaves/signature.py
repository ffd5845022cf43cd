"""What the leaves of one id share: what kind of Python object does their work, and what it is given."""

from __future__ import annotations

from btlang.engine.leaves.leaf import LeafBinding

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any, TypeAlias

    from btlang.engine.blackboard import Blackboard

    Ports: TypeAlias = tuple[tuple[str, str], ...]
    Call: TypeAlias = tuple[Callable[..., Any], Callable[[], Mapping[str, Any]] | None, list[str]]


class LeafSignature:
    """What the leaves of one engine with the same id share, found once.

    `kind` is "class", "async", "generator", "thread" or "function"; `given` keeps the names of the services that the
    call gets, by the names of the ports that a node has; for a class `made_with` keeps those of its constructor.
    `calls` are shared by equal leaves: what `binding` makes of the ports and the blackboard of a node.
    """

    __slots__ = ("binding", "calls", "given", "kind", "made_with")

    def __init__(self, binding: LeafBinding) -> None:
        from inspect import isclass, iscoroutinefunction, isgeneratorfunction

        call = binding.call
        self.binding = binding
        self.given: dict[tuple[str, ...], list[str]] = {}
        self.calls: dict[tuple[Ports, Blackboard], Call] = {}
        self.made_with: list[str] | None = None
        if isclass(call):
            self.kind = "class"
        elif iscoroutinefunction(call) or iscoroutinefunction(type(call).__call__):
            self.kind = "async"
        elif isgeneratorfunction(call) or isgeneratorfunction(type(call).__call__):
            self.kind = "generator"
        else:
            self.kind = "thread" if binding.thread else "function"
