"""Robot missions in plain English, compiled to behavior trees and run.

mission = btlang.parse_tree("move forward, then twist right and print hello")
print(mission)
mission.run()
"""

from __future__ import annotations

__version__ = "0.2.0"

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.api import Mission, parse_file, parse_tree
    from btlang.components.component import Component, Parameter
    from btlang.decorators import action, condition, quantity
    from btlang.diagnostics.diagnostic import Diagnostic
    from btlang.diagnostics.errors import MissionError
    from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere, Unknown
    from btlang.run.outcome import Outcome
    from btlang.run.statuses import Status
    from btlang.session import Run, Session

__all__ = [
    "ActionFailed", "Component", "Diagnostic", "Failed", "Mission", "MissionError", "NotThere", "Outcome", "Parameter",
    "Run", "Session", "Status", "Unknown", "action", "condition", "parse_file", "parse_tree", "quantity",
]  # fmt: skip

_HOMES = {
    "ActionFailed": "btlang.engine.leaves.leaf",
    "Component": "btlang.components.component",
    "Diagnostic": "btlang.diagnostics.diagnostic",
    "Failed": "btlang.engine.leaves.leaf",
    "MissionError": "btlang.diagnostics.errors",
    "NotThere": "btlang.engine.leaves.leaf",
    "Outcome": "btlang.run.outcome",
    "Parameter": "btlang.components.component",
    "Run": "btlang.session",
    "Session": "btlang.session",
    "Status": "btlang.run.statuses",
    "Unknown": "btlang.engine.leaves.leaf",
    "action": "btlang.decorators",
    "condition": "btlang.decorators",
    "quantity": "btlang.decorators",
}


def __getattr__(name: str) -> object:
    """Public names are loaded when they are used, so that `btc` starts fast."""
    if name not in __all__:
        raise AttributeError(f"module 'btlang' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOMES.get(name, "btlang.api")), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
