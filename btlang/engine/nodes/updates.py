"""Nodes that ask whether a blackboard entry was updated: updated_decorator.cpp and updated_action.cpp of 4.10.

The first time they ask, an entry that has a value counts as new; setting the value that it has counts too. No halt
makes them forget what they have seen. One difference: halting a decorator halts its child; there the child is left
alone.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance, halt_nothing
from btlang.engine.nodes.ports import key_port
from btlang.engine.nodes.start_guard import start_guarded
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def skip_unless_updated(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Its child where the entry is new, else SKIPPED; a RUNNING child is ticked on without asking."""
    return start_guarded(children, _News(instance, SKIPPED))


def wait_value_update(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """RUNNING until the entry is new, then its child."""
    return start_guarded(children, _News(instance, RUNNING))


def was_entry_updated(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """SUCCESS where the entry is new, else FAILURE."""
    news = _News(instance, FAILURE)
    refusal = f"nothing has been written to {{{key_port(instance, 'entry')}}} since the last check"
    return (lambda: SUCCESS if news() == IDLE else instance.fail(refusal)), halt_nothing


class _News:
    """IDLE where the entry is new since the last call, else the status `otherwise`."""

    __slots__ = ("key", "otherwise", "scope", "seen")

    def __init__(self, instance: NodeInstance, otherwise: int) -> None:
        self.scope, self.key = instance.scope, key_port(instance, "entry")
        self.otherwise = otherwise
        self.seen = -1

    def __call__(self) -> int:
        before = self.seen
        if self.key in self.scope:
            self.seen = self.scope.writes(self.key)
        return IDLE if self.seen != before else self.otherwise

    def saved(self) -> int:
        """How often the entry had been set."""
        return self.seen

    def restore(self, seen: int) -> None:
        """As `saved` gave it."""
        self.seen = seen
