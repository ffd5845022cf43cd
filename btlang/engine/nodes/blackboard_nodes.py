"""Leaves that write to the blackboard: set_blackboard_node.h and unset_blackboard_node.h of BehaviorTree.CPP 4.10.

One difference: a port `{name}` that names an entry means the entry `name`. There it means the entry whose name is the
text under `name`, and raises an exception if there is none.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import NodeInstance, blackboard_key, halt_nothing, value_of
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import key_port
from btlang.engine.script.values import ScriptFailed, kept, number, read
from btlang.engine.status import SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled
    from btlang.engine.script.values import Enums


def set_blackboard(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """The port `value`, a text or a `{key}` to copy, goes under the key `output_key`.

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
    if old.__class__ is str or read(old).__class__ is not float:
        return new
    try:
        return kept(number(new, enums))
    except ScriptFailed as failed:
        raise ActionFailed(f"{{{target}}} holds a number: {failed}") from None


def unset_blackboard(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """The entry `key` has no value any more."""
    scope, key = instance.scope, key_port(instance, "key")

    def tick() -> int:
        scope.unset(key)
        return SUCCESS

    return tick, halt_nothing
