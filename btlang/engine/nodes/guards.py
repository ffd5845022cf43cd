"""Nodes that decide whether their one child runs, or runs again; decorators/*.h of BehaviorTree.CPP 4.10.

One difference: a Precondition whose child was SKIPPED or halted asks its condition again. There it remembers that the
condition once held until the child completes.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import STATUSES, TRUTHS, choice_port
from btlang.engine.nodes.script_nodes import not_true, script_of
from btlang.engine.nodes.start_guard import start_guarded
from btlang.engine.script.script import truth
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def keep_running_until_failure(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """RUNNING until its child fails: FAILURE (keep_running_until_failure_node.h). SKIPPED is RUNNING too."""
    [(child, halt)] = children

    def tick() -> int:
        return FAILURE if child() == FAILURE else RUNNING

    return tick, halt


def run_once(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Runs its child until it completes, once for as long as the tree exists: no halt makes it run again.

    From then on SKIPPED, or with then_skip="false" the status of that one run (run_once_node.h).
    """
    [(child, halt)] = children
    then_skip = choice_port(instance, "then_skip", TRUTHS)
    result = IDLE
    state = instance.state
    fault = state.fault  # of that run

    def tick() -> int:
        nonlocal result, fault
        skips = then_skip()
        if result == IDLE:
            status = child()
            if status in (SUCCESS, FAILURE):
                result, fault = status, state.fault
            return status
        if skips:
            return SKIPPED
        if result == FAILURE:
            state.fault = fault
            return instance.pass_on("its one run had failed")
        return result

    return tick, halt


def precondition(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Its child where the script `if` holds when it starts, else the status in `else` (script_precondition.h)."""
    condition, scope = script_of(instance, "if"), instance.scope
    refusal = not_true(instance, "if")
    otherwise = choice_port(instance, "else", STATUSES)

    def ask() -> int:
        try:
            holds = truth(condition(scope))
        except ActionFailed as failed:
            return instance.cannot_know(str(failed))
        if holds:
            return IDLE
        status = otherwise()
        return instance.fail(refusal) if status == FAILURE else status

    return start_guarded(children, ask)
