"""Functions that build trees: one for each built-in node of the catalogue. builders.pyi has their types.

The keyword arguments are the ports of the node; docs/engine.md says what each node does.
"""

from __future__ import annotations

import re

from btlang.behavior import builder_of
from btlang.behavior import leaf as leaf
from btlang.tree.catalogue import CATALOGUE


def builder_name(node_id: str) -> str:
    """Return the name of the function that builds a node: `IfThenElse` is built by `if_then_else`."""
    return re.sub(r"(?<=[a-z])(?=[A-Z0-9])", "_", node_id).lower()


_BUILDERS = {builder_name(kind.id): builder_of(kind) for kind in CATALOGUE.values()}
for _name, _function in _BUILDERS.items():
    _function.__name__ = _function.__qualname__ = _name
    _function.__module__ = __name__
globals().update(_BUILDERS)
__all__ = sorted(["leaf", *_BUILDERS])
