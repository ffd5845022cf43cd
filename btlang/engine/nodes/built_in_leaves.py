"""Built-in leaves: fixed statuses, scripts, and writing to the blackboard, as in BehaviorTree.CPP 4.10.

They follow always_success_node.h, always_failure_node.h, script_node.h, script_condition.h, set_blackboard_node.h and
unset_blackboard_node.h, with these differences:
- where those raise an exception because the script can't go on, these fail with its reason;
- a port `{name}` that names an entry means the entry `name`. There it means the entry whose name is the text under
  `name`, and raises an exception if there is none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import NodeInstance, blackboard_key, halt_nothing, value_of
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import key_port
from btlang.engine.script.script import compile_script
from btlang.engine.script.tokens import ScriptError
from btlang.engine.script.values import ScriptFailed, from_stored, number, to_stored, truth
from btlang.engine.status import SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled
    from btlang.engine.script.values import Enums


def always_success(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return SUCCESS."""
    return (lambda: SUCCESS), halt_nothing


def always_failure(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return FAILURE."""
    return partial(instance.fail, "the mission says so"), halt_nothing


def always_skipped(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return SKIPPED without a tick below, as a node with _skipIf="true" does."""
    return (lambda: SKIPPED), halt_nothing


def script(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its code: SUCCESS."""
    run, scope = script_port(instance, "code"), instance.scope

    def tick() -> int:
        try:
            run(scope)
        except ActionFailed as failed:
            return instance.fail(str(failed))
        return SUCCESS

    return tick, halt_nothing


def script_condition(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its code: SUCCESS if the value is true, else FAILURE."""
    run, scope = script_port(instance, "code"), instance.scope
    refusal = refusal_text(instance, "code")

    def tick() -> int:
        try:
            return SUCCESS if truth(run(scope)) else instance.fail(refusal)
        except ActionFailed as failed:
            return instance.cannot_know(str(failed))

    return tick, halt_nothing


def refusal_text(instance: NodeInstance, port: str) -> str:
    """Return the reason of a failure if the script in a port isn't true."""
    return f"this is not true: {instance.node.port(port)}"


def script_port(instance: NodeInstance, port: str) -> Callable[[Blackboard], Any]:
    """Compile what the port says, or at the time what the text under its `{key}` says."""
    text = instance.node.port(port)
    key = blackboard_key(port, text)
    if key is not None:
        return _compile_stored(key, instance.state.enums)
    if not text:
        raise instance.error(f"{instance.node.id} needs a port {port}")
    return read_script(instance, port, text)


def read_script(instance: NodeInstance, port: str, text: str) -> Callable[[Blackboard], Any]:
    """Compile a text. Raises EngineError if it is no script."""
    try:
        return compile_script(text, instance.state.enums)
    except ScriptError as problem:
        raise instance.error(f"its {port} {text!r} cannot be read: {problem}") from problem


def _compile_stored(key: str, enums: Mapping[str, float]) -> Callable[[Blackboard], Any]:
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


def set_blackboard(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Write the port `value`, a text or a `{key}` to copy, under the key `output_key`.

    A text for an entry that holds a number becomes the number that it stands for; FAILURE where it stands for none.
    """
    if not any(port == "value" for port, _ in instance.node.ports):
        raise instance.error("SetBlackboard needs a port value")
    scope, enums, value, target = (
        instance.scope,
        instance.state.enums,
        instance.node.port("value"),
        key_port(instance, "output_key"),
    )
    key = blackboard_key("value", value)

    def tick() -> int:
        try:
            new: Any = value if key is None else value_of(scope, key)
            if new.__class__ is str:
                new = _of_kind(new, scope, target, enums)
            scope.set(target, new)
        except ActionFailed as failed:
            return instance.fail(str(failed))
        return SUCCESS

    return tick, halt_nothing


def _of_kind(new: str, scope: Blackboard, target: str, enums: Enums) -> Any:
    try:
        old = scope.get(target)
    except KeyError:
        return new
    if old.__class__ is str or from_stored(old).__class__ is not float:
        return new
    try:
        return to_stored(number(new, enums))
    except ScriptFailed as failed:
        raise ActionFailed(f"{{{target}}} holds a number: {failed}") from None


def unset_blackboard(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Remove the value of the entry `key`."""
    scope, key = instance.scope, key_port(instance, "key")

    def tick() -> int:
        scope.unset(key)
        return SUCCESS

    return tick, halt_nothing
