"""A standing rule over other work. BehaviorTree.CPP has no such node; it is named `Whenever` in XML too.

Suspension is that of a pause: running leaves are halted, positions, counts and timers are kept.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance, apart
from btlang.engine.nodes.ports import TRUTHS, choice_port
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def whenever(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Children: condition, reaction, work. The condition is asked at every tick.

    When it becomes true (true at the start counts too), the work is suspended, and the reaction is ticked until it
    completes. If it fails, the whole fails; else the work goes on. The condition must have been false before it counts
    again, which it never does with the port once="true"; one that is not known is neither. The whole ends with the
    status of the work. A condition that is RUNNING counts as false; one that is an action suspends what runs before it
    starts (see reactive.py).
    """
    ticks, halts = apart(children)
    state = instance.state
    interrupts = state.interrupts
    once = choice_port(instance, "once", TRUTHS)
    armed = True  # the condition has been false since it last counted
    fired = False  # it has, and may not again
    reacting = False
    running = 0  # the child that was RUNNING at the last tick, 1 the reaction, 2 the work, 0 none

    def suspend() -> None:
        nonlocal running
        child, running = running, 0
        halts[child](True)

    def holds() -> bool:
        if running:
            interrupts.append(suspend)
        status = ticks[0]()
        if running:
            interrupts.pop()
        if status == SKIPPED:
            halts[0](False)
        return status == SUCCESS

    def end() -> None:
        nonlocal armed, fired, reacting, running
        armed, fired, reacting, running = True, False, False, 0
        halts[0](False)

    def tick() -> int:
        nonlocal armed, fired, reacting, running
        fault, unknowns = state.fault, state.unknowns
        if not holds():
            armed = armed or (not fired and state.unknowns == unknowns)
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
