"""Robot missions in plain English, compiled to behavior trees and run.

tree = btlang.parse_tree("move forward, then twist right and print hello")
print(tree)
tree.run()
"""

from __future__ import annotations

__version__ = "0.1.0"

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.api import RunnableTree, parse_tree
    from btlang.diagnostics.diagnostic import Diagnostic, MissionError
    from btlang.engine.leaf import ActionFailed, Unknown
    from btlang.own_words import action, condition

__all__ = ["ActionFailed", "Diagnostic", "MissionError", "RunnableTree", "Unknown", "action", "condition", "parse_tree"]

_HOMES = {
    "ActionFailed": "btlang.engine.leaf",
    "Diagnostic": "btlang.diagnostics.diagnostic",
    "MissionError": "btlang.diagnostics.diagnostic",
    "Unknown": "btlang.engine.leaf",
    "action": "btlang.own_words",
    "condition": "btlang.own_words",
}


def __getattr__(name: str) -> object:
    """Public names are loaded when they are used, so that `btc` starts fast."""
    if name not in __all__:
        raise AttributeError(f"module 'btlang' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOMES.get(name, "btlang.api")), name)
