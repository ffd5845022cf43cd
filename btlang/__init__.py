"""Robot missions in plain English, compiled to behavior trees and run.

mission = btlang.parse_tree("move forward, then twist right and print hello")
print(mission)
mission.run()
"""

from __future__ import annotations

__version__ = "0.2.0"

PUBLIC: dict[str, tuple[str, ...]] = {
    "btlang.api": ("Mission", "parse_file", "parse_tree"),
    "btlang.behavior": ("Behavior", "from_py_trees"),
    "btlang.builders": (
        "always_failure", "always_success", "async_fallback", "async_sequence", "delay", "distance_controller",
        "fallback", "force_failure", "force_success", "goal_updated_controller", "goal_updater", "if_then_else",
        "inverter", "keep_in", "keep_out", "keep_running_until_failure", "leaf", "loop_bool", "loop_double", "loop_int",
        "loop_string", "nonblocking_sequence", "parallel", "parallel_all", "path_longer_on_approach",
        "pause_resume_controller", "persistent_sequence", "pipeline_sequence", "precondition", "rate_controller",
        "reactive_fallback", "reactive_sequence", "recovery_node", "repeat",
        "retry_until_successful", "round_robin", "run_once", "script", "script_condition", "sequence",
        "sequence_with_memory", "set_blackboard", "single_trigger", "skip_unless_updated", "sleep", "speed_controller",
        "sub_tree", "switch_2", "switch_3", "switch_4", "switch_5", "switch_6", "timeout", "try_catch",
        "unset_blackboard", "wait_for_time", "wait_value_update", "was_entry_updated", "whenever", "while_do_else",
    ),
    "btlang.components.component": ("Component", "Parameter"),
    "btlang.vocabulary.decorators": ("action", "condition", "quantity"),
    "btlang.diagnostics.diagnostic": ("Diagnostic", "MissionError"),
    "btlang.engine.leaves.leaf": ("ActionFailed", "Failed", "NotThere", "Unknown"),
    "btlang.run.outcome": ("Outcome",),
    "btlang.run.statuses": ("Status",),
    "btlang.session": ("Run", "Session"),
    "btlang.slots": (
        "Angle", "Color", "Door", "Duration", "Length", "Object", "Percent", "Person", "Place", "Speed", "Text", "Zone",
    ),
}  # fmt: skip
"""The public names by the modules that have them. Their types are in __init__.pyi, which is made from this."""
_HOMES = {name: module for module, names in PUBLIC.items() for name in names}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> object:
    """Load a public name when it is used, so that `btc` starts fast."""
    if name not in _HOMES:
        raise AttributeError(f"module 'btlang' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
