"""Rules over other work, which BehaviorTree.CPP doesn't have: Whenever, KeepOut and KeepIn.

A Whenever suspends the work as a pause does: running leaves are halted, positions, counts and timers are kept. The
zones of KeepOut and KeepIn hold from the first tick until the child ends, however it ends, even while it is
suspended. What runs at the same time, or as the reaction of a rule, keeps to them too.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance, split_children
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import TRUTHS, choice_port, value_port
from btlang.engine.script.values import as_text
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.tree.catalogue import zone_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled


def whenever(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Ask the condition at every tick, and run the reaction or the work. The children are condition, reaction, work.

    When it becomes true (true at the start counts too), the work is suspended, and the reaction is ticked until it
    completes. If it fails, the whole fails; else the work goes on. The condition must have been false before it counts
    again, which it never does with the port once="true"; one that is not known, or RUNNING, is neither. The whole ends
    with the status of the work. A condition that is an action suspends what runs before it starts (see control.py).
    """
    ticks, halts = split_children(children)
    state = instance.state
    interrupts = state.interrupts
    once = choice_port(instance, "once", TRUTHS)
    armed = True  # the condition has been false since it last counted
    fired = False  # it has, and may not again
    reacting = False
    running = 0  # the child that was RUNNING at the last tick, 1 the reaction, 2 the work, 0 none
    known = False  # the condition has had an answer, in whichever run of this node

    def suspend() -> None:
        nonlocal running
        child, running = running, 0
        halts[child](True)

    def ask() -> int:
        if running:
            interrupts.append(suspend)
        status = ticks[0]()
        if running:
            interrupts.pop()
        if status == SKIPPED:
            halts[0](False)
        return status

    def end() -> None:
        nonlocal armed, fired, reacting, running
        armed, fired, reacting, running = True, False, False, 0
        halts[0](False)

    def tick() -> int:
        nonlocal armed, fired, reacting, running, known
        fault, unknowns = state.fault, state.unknowns
        asked = ask()
        if not known and asked != RUNNING:
            known = asked == SUCCESS or state.unknowns == unknowns
            state.note_answer(instance.index, known)
        if asked != SUCCESS:
            armed = armed or (not fired and asked != RUNNING and state.unknowns == unknowns)
        elif armed and not reacting:
            armed, reacting, fired = False, True, once()
            if running:
                suspend()
        if reacting:
            status = ticks[1]()
            if status == RUNNING:
                running = 1
                return RUNNING
            reacting = False
            if status == FAILURE:
                halts[2](False)
                end()
                return instance.pass_on("its reaction failed")
            if status == SKIPPED:
                halts[1](False)
        status = ticks[2]()
        running = 2 if status == RUNNING else 0
        if not running:
            end()
            if status == SKIPPED:
                halts[2](False)
                state.fault = fault
        return status

    def halt(keep: bool) -> None:
        nonlocal armed, fired, reacting, running
        if running:  # to halt the condition may start what cleans up after it
            interrupts.append(suspend)
        halts[0](keep)
        if running:
            interrupts.pop()
        for stop in halts[1:]:
            stop(keep)
        if not keep:
            armed, fired, reacting, running = True, False, False, 0

    return tick, halt


class ZoneConstraint:
    """The zones of one node while they hold."""

    __slots__ = ("_held", "_instance", "_keeps_in", "_zones")

    def __init__(self, instance: NodeInstance, keeps_in: bool) -> None:
        self._instance = instance
        self._keeps_in = keeps_in
        self._zones = value_port(instance, "zones", as_text)
        self._held: Any = None

    def begin(self) -> None:
        """Make the zones hold, unless they do. Raises ActionFailed for unknown zones and robots without zones."""
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
        """End the constraint: the zones no longer hold."""
        held, self._held = self._held, None
        if held is not None:
            held.end()

    def saved(self) -> bool:
        """Whether the zones hold."""
        return self._held is not None

    def restore(self, held: bool) -> None:
        """Do nothing: in a restored run the zones hold from its first tick."""


def keep_out(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Keep the robot out of the zones while the child runs."""
    return _constrain(instance, children, ZoneConstraint(instance, False))


def keep_in(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Keep the robot in the zones while the child runs."""
    return _constrain(instance, children, ZoneConstraint(instance, True))


def _constrain(instance: NodeInstance, children: Sequence[Compiled], restraint: ZoneConstraint) -> Compiled:
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
