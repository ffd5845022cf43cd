"""Nodes with a condition and branches: if_then_else_node.cpp and while_do_else_node.cpp of BehaviorTree.CPP 4.10.

Where those raise an exception because the condition was SKIPPED, these fail. So they do where it is not known.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance, apart
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled

_NO_ANSWER = "its condition was skipped"
_NO_BRANCH = "its condition was false, and it has no other branch"


def if_then_else(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Asks the condition once, then ticks the second child, or the third (without one: FAILURE), until it completes."""
    ticks, halts = apart(children)
    state = instance.state
    position = 0  # 0 the condition, then the branch that was chosen

    def tick() -> int:
        nonlocal position
        fault, unknowns = state.fault, state.unknowns
        if position == 0:
            status = ticks[0]()
            if status == SUCCESS:
                position = 1
            elif status == FAILURE and instance.not_known(unknowns):
                return FAILURE
            elif status == FAILURE and len(ticks) == 3:
                position = 2
            elif status == SKIPPED:
                halts[0](False)
                return instance.fail(_NO_ANSWER)
            else:
                return instance.pass_on(_NO_BRANCH) if status == FAILURE else status
        status = ticks[position]()
        if status != RUNNING:
            if status == SKIPPED:
                halts[position](False)
                state.fault = fault
            position = 0
        return status

    def halt(keep: bool) -> None:
        nonlocal position
        halts[position](keep)
        if not keep:
            position = 0

    return tick, halt


def while_do_else(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Asks the condition at every tick and ticks the second child, or the third (without one: FAILURE).

    When the answer changes, the other branch is halted first. A condition that is itself RUNNING leaves the branch as
    it is; one that is an action interrupts it (see reactive.py).
    """
    ticks, halts = apart(children)
    state = instance.state
    interrupts = state.interrupts
    branch = 0  # the branch that was RUNNING at the last tick, 0 none

    def interrupt() -> None:
        nonlocal branch
        child, branch = branch, 0
        halts[child](False)

    def tick() -> int:
        nonlocal branch
        fault, unknowns = state.fault, state.unknowns
        if branch:
            interrupts.append(interrupt)
        status = ticks[0]()
        if branch:
            interrupts.pop()
        if status == RUNNING:
            return RUNNING
        not_known = status == FAILURE and instance.not_known(unknowns)
        chosen = 1 if status == SUCCESS else 2
        if branch and (branch != chosen or status == SKIPPED or not_known):
            interrupt()
        if not_known:
            return FAILURE
        if status == SKIPPED:
            halts[0](False)
            return instance.fail(_NO_ANSWER)
        if chosen == len(ticks):
            return instance.pass_on(_NO_BRANCH)
        status = ticks[chosen]()
        if status == SKIPPED:
            halts[chosen](False)
            state.fault = fault
        branch = chosen if status == RUNNING else 0
        return status

    def halt(keep: bool) -> None:
        nonlocal branch
        if branch:  # to halt the condition may start what cleans up after it
            interrupts.append(interrupt)
        halts[0](keep)
        if branch:
            interrupts.pop()
        for stop in halts[1:]:
            stop(keep)
        if not keep:
            branch = 0

    return tick, halt
