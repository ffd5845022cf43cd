"""Nodes that ask whether a blackboard entry was set anew: updated_decorator.cpp and updated_action.cpp of 4.10.

The first time they ask, an entry that has a value counts as new; setting the value that it has counts too. No halt
makes them forget what they have seen. One difference: halting a decorator halts its child; there the child is left
alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.instance import NodeInstance, halt_nothing
from btlang.engine.nodes.ports import key_port
from btlang.engine.nodes.start_guard import start_guarded
from btlang.engine.status import IDLE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def skip_unless_updated(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Its child where the entry is new, else SKIPPED; a RUNNING child is ticked on without asking."""
    is_new = _news(instance)
    return start_guarded(children, lambda: IDLE if is_new() else SKIPPED)


def wait_value_update(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """RUNNING until the entry is new, then its child."""
    is_new = _news(instance)
    return start_guarded(children, lambda: IDLE if is_new() else RUNNING)


def was_entry_updated(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """SUCCESS where the entry is new, else FAILURE."""
    is_new = _news(instance)
    refusal = f"nothing has been written to {{{key_port(instance, 'entry')}}} since the last check"
    return (lambda: SUCCESS if is_new() else instance.fail(refusal)), halt_nothing


def _news(instance: NodeInstance) -> Callable[[], bool]:
    scope, key = instance.scope, key_port(instance, "entry")
    seen = -1

    def is_new() -> bool:
        nonlocal seen
        before = seen
        if key in scope:
            seen = scope.writes(key)
        return seen != before

    return is_new
