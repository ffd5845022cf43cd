"""Nodes that change what their one child returns, or tick it several times; decorators/ of BehaviorTree.CPP 4.10."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.instance import NodeInstance
from btlang.engine.nodes.timed import Stopwatch
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


_FIRST_PAUSE, _LONGEST_PAUSE = 500.0, 8000.0  # milliseconds
WAS_TRUE = "it is true"
"""The reason of an Inverter: what it denies succeeded."""


def inverter(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """SUCCESS for FAILURE and the other way round (inverter_node.cpp); what is not known stays a FAILURE."""
    [(child, halt)] = children
    state = instance.state

    def tick() -> int:
        unknowns = state.unknowns
        status = child()
        if status == SUCCESS:
            return instance.fail(WAS_TRUE)
        return SUCCESS if status == FAILURE and not instance.not_known(unknowns) else status

    return tick, halt


def force_success(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """SUCCESS for FAILURE (force_success_node.h)."""
    [(child, halt)] = children

    def tick() -> int:
        status = child()
        return SUCCESS if status == FAILURE else status

    return tick, halt


def force_failure(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """FAILURE for SUCCESS (force_failure_node.h)."""
    [(child, halt)] = children

    def tick() -> int:
        status = child()
        return instance.fail("it turns success into failure") if status == SUCCESS else status

    return tick, halt


def repeat(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Runs its child num_cycles times (-1: for ever) or until it fails (repeat_node.cpp)."""
    return _rounds(instance, children, instance.number("num_cycles"), SUCCESS)


def retry_until_successful(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Runs its child until it succeeds, at most num_attempts times (-1: for ever) (retry_node.cpp)."""
    return _rounds(instance, children, instance.number("num_attempts"), FAILURE)


def _rounds(instance: NodeInstance, children: Sequence[Compiled], limit: Callable[[], int], again: int) -> Compiled:
    """Another round at the status `again`, which is the result after the last round.

    After a round within one tick it returns RUNNING, so that an endless loop cannot block a tick. After a longer one
    the child starts again in the same tick. A SKIPPED child makes it SKIPPED without a change of the count.

    If what the child needs isn't there now (NotThere), some attempts would be over in a moment: each of them waits for
    longer than the one before.
    """
    [(child, halt_child)] = children
    count = 0
    waiting = False  # whether the child was RUNNING at the last tick
    pause = Stopwatch(instance.state.clock)
    msec = 0.0  # the length of the pause that goes on

    def tick() -> int:
        nonlocal count, waiting, msec
        if msec:
            if not pause.reached(msec):
                return pause.wait(msec)
            pause.halt(False)
            msec = 0.0
        most = limit()
        resumed, waiting = waiting, False
        while count < most or most == -1:
            status = child()
            if status == RUNNING:
                waiting = True
                return RUNNING
            if status == SKIPPED:
                halt_child(False)
                return SKIPPED
            if status != again:
                if count and status == FAILURE:
                    instance.pass_on(f"in round {count + 1}" if most == -1 else f"in round {count + 1} of {most}")
                count = 0
                return status
            count += 1
            if again is FAILURE and count < most and instance.is_not_there():
                msec = min(_FIRST_PAUSE * 2.0 ** (count - 1), _LONGEST_PAUSE)
                pause.reached(msec)
                return pause.wait(msec)
            if not resumed and (count < most or most == -1):
                return RUNNING
            resumed = False
        if again == FAILURE:
            if count == 0:
                instance.fail("it allows no attempt")
            elif count > 1:
                instance.pass_on(f"{'both' if count == 2 else f'all {count}'} attempts failed")
        count = 0
        return again

    def halt(keep: bool) -> None:
        nonlocal count, waiting, msec
        halt_child(keep)
        pause.halt(keep)
        if not keep:
            count = 0
            waiting = False
            msec = 0.0

    return tick, halt
