"""Functions that build trees: one for each built-in node of the catalogue. builders.pyi has their types.

The keyword arguments are the ports of the node; docs/engine.md says what each node does.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from keyword import iskeyword

from btlang.behavior import Behavior, built
from btlang.behavior import leaf as leaf
from btlang.tree.catalogue import CATALOGUE, POST_CONDITIONS, PRE_CONDITIONS, NodeKind

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def builder_name(node_id: str) -> str:
    """Return the name of the function that builds a node: `IfThenElse` is built by `if_then_else`."""
    return re.sub(r"(?<=[a-z])(?=[A-Z0-9])", "_", node_id).lower()


def builder_of(kind: NodeKind) -> Callable[..., Behavior]:
    """Return the function that builds a node: its parameters are the children, the ports, a name and scripts.

    It raises TypeError for what doesn't fit.
    """
    from inspect import Parameter, Signature  # which takes longer to import than the rest of this module

    def parameter(name: str, way: Any, optional: bool) -> Parameter:
        return Parameter(f"{name}_" if iskeyword(name) else name, way, default=None if optional else Parameter.empty)

    children = [
        parameter(role, Parameter.POSITIONAL_OR_KEYWORD, at >= kind.least)
        for at, role in enumerate(kind.roles or ("child",) * (kind.most == 1))
    ]
    ports = {
        port: parameter(port, Parameter.KEYWORD_ONLY, found.default is not None) for port, found in kind.ports.items()
    }
    several = [Parameter("children", Parameter.VAR_POSITIONAL)] if kind.most and not children else []
    known = {"name", *(each.name for each in (*children, *ports.values())), *PRE_CONDITIONS, *POST_CONDITIONS}
    name = Parameter("name", Parameter.KEYWORD_ONLY, default="")
    scripts = Parameter("scripts", Parameter.VAR_KEYWORD)
    signature = Signature([*children, *several, *ports.values(), name, scripts])

    def build(*arguments: Any, **named: Any) -> Behavior:
        for given in named:
            if given not in known and not kind.any_ports:
                raise TypeError(f"{kind.id} has no port {given!r}, but {', '.join(ports) or 'none'}")
        try:
            bound = signature.bind(*arguments, **named)
        except TypeError as problem:
            raise TypeError(f"{kind.id}: {problem}") from None
        bound.apply_defaults()
        found = bound.arguments
        own = found["children"] if several else tuple(found[each.name] for each in children)
        values = {port: found[each.name] for port, each in ports.items()}
        return built(kind, own, values, found["name"], found["scripts"])

    build.__signature__ = signature  # type: ignore[attr-defined]
    build.__doc__ = f"Make the node {kind.id} of {kind.origin}. {kind.text}".strip()
    return build


_BUILDERS = {builder_name(kind.id): builder_of(kind) for kind in CATALOGUE.values()}
for _name, _function in _BUILDERS.items():
    _function.__name__ = _function.__qualname__ = _name
    _function.__module__ = __name__
globals().update(_BUILDERS)
__all__ = sorted(["leaf", *_BUILDERS])
