"""Nodes that run scripts: script_node.h and script_condition.h of BehaviorTree.CPP 4.10.

Where those raise an exception because the script cannot go on, these fail with its reason.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import NodeInstance, blackboard_key, halt_nothing, value_of
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.script.script import ScriptError, ScriptFailed, compile_script, truth
from btlang.engine.status import SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled


def script(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Runs its code: SUCCESS."""
    run, scope = script_of(instance, "code"), instance.scope

    def tick() -> int:
        try:
            run(scope)
        except ActionFailed as failed:
            return instance.fail(str(failed))
        return SUCCESS

    return tick, halt_nothing


def script_condition(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Runs its code: SUCCESS where the value is true, else FAILURE."""
    run, scope = script_of(instance, "code"), instance.scope
    refusal = not_true(instance, "code")

    def tick() -> int:
        try:
            return SUCCESS if truth(run(scope)) else instance.fail(refusal)
        except ActionFailed as failed:
            return instance.cannot_know(str(failed))

    return tick, halt_nothing


def not_true(instance: NodeInstance, port: str) -> str:
    """The reason where the script in a port is not true."""
    return f"this is not true: {instance.node.port(port)}"


def script_of(instance: NodeInstance, port: str) -> Callable[[Blackboard], Any]:
    """What the port says, or what the text under its `{key}` says at the time."""
    text = instance.node.port(port)
    key = blackboard_key(port, text)
    if key is not None:
        return _stored_code(key, instance.state.enums)
    if not text:
        raise instance.error(f"{instance.node.id} needs a port {port}")
    return read_script(instance, port, text)


def read_script(instance: NodeInstance, port: str, text: str) -> Callable[[Blackboard], Any]:
    """The compiled text; raises EngineError where it is no script."""
    try:
        return compile_script(text, instance.state.enums)
    except ScriptError as problem:
        raise instance.error(f"its {port} {text!r} cannot be read: {problem}") from problem


def _stored_code(key: str, enums: Mapping[str, float]) -> Callable[[Blackboard], Any]:
    latest: object = None
    run: Callable[[Blackboard], Any] | None = None

    def run_stored(scope: Blackboard) -> Any:
        nonlocal latest, run
        text = value_of(scope, key)
        if run is None or text != latest:
            try:
                latest, run = text, compile_script(str(text), enums)
            except ScriptError as problem:
                raise ScriptFailed(f"{{{key}}} holds no script: {problem}") from problem
        return run(scope)

    return run_stored
