"""KeepOut and KeepIn: zones that the robot keeps out of, or stays in, while the child runs. BehaviorTree.CPP has none.

The zones hold from the first tick until the child ends, however it ends, and also while it is suspended; what runs at
the same time, or as the reaction of a rule, keeps to them too.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import value_port
from btlang.engine.script.values import as_text
from btlang.engine.status import RUNNING
from btlang.tree.catalogue import zone_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled


class Restraint:
    """The zones of one node while they hold."""

    __slots__ = ("_held", "_instance", "_keeps_in", "_zones")

    def __init__(self, instance: NodeInstance, keeps_in: bool) -> None:
        self._instance = instance
        self._keeps_in = keeps_in
        self._zones = value_port(instance, "zones", as_text)
        self._held: Any = None

    def begin(self) -> None:
        """Make them hold, unless they do. Raises ActionFailed for unknown zones and robots without zones."""
        if self._held is not None:
            return
        zones = getattr(self._instance.state.services.get("robot"), "zones", None)
        names = zone_names(self._zones())
        if zones is None or not names:
            raise ActionFailed("this robot has no zones" if names else "it names no zone")
        held = (zones.keep_in if self._keeps_in else zones.keep_out)(*names)
        held.begin()
        self._held = held

    def end(self) -> None:
        """They no longer hold."""
        held, self._held = self._held, None
        if held is not None:
            held.end()

    def saved(self) -> bool:
        """Whether they hold."""
        return self._held is not None

    def restore(self, held: bool) -> None:
        """A run goes on: they hold from its first tick."""


def keep_out(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """The robot keeps out of the zones while the child runs."""
    return _restrained(instance, children, Restraint(instance, False))


def keep_in(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """The robot stays in the zones while the child runs."""
    return _restrained(instance, children, Restraint(instance, True))


def _restrained(instance: NodeInstance, children: Sequence[Compiled], restraint: Restraint) -> Compiled:
    [(child, halt_child)] = children

    def tick() -> int:
        try:
            restraint.begin()
        except ActionFailed as problem:
            return instance.fail(str(problem))
        status = child()
        if status != RUNNING:
            restraint.end()
        return status

    def halt(keep: bool) -> None:
        halt_child(keep)
        if not keep:
            restraint.end()

    return tick, halt
