"""TryCatch: a sequence, and what to do when it fails; try_catch_node.cpp of BehaviorTree.CPP 4.10.

Differences: what `catch_on_halt` starts does not run on an emergency stop, nor where the sequence was SKIPPED, and a
suspension is no halt.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import Fault, NodeInstance, apart
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import TRUTHS, choice_port
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def try_catch(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """All children but the last are a Sequence. When it fails, the last one runs to its end; then FAILURE.

    With catch_on_halt="true" the last child is also ticked once, and halted where it is RUNNING, after a halt has
    stopped the sequence. The recorded failure is that of the sequence, whatever the last child does.
    """
    ticks, halts = apart(children)
    last = len(ticks) - 1
    state = instance.state
    catch_on_halt = choice_port(instance, "catch_on_halt", TRUTHS)
    index = skipped = 0
    trying = catching = False
    cause = state.fault

    def tick() -> int:
        nonlocal index, skipped, trying, catching, cause
        trying = not catching
        while trying:
            status = ticks[index]()
            if status == RUNNING:
                return RUNNING
            if status == FAILURE:
                trying, catching, cause = False, True, state.fault
                break
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
            index += 1
            if index == last:
                result = SKIPPED if skipped == last else SUCCESS
                index = skipped = 0
                trying = False
                return result
        status = ticks[last]()
        if status == RUNNING:
            return RUNNING
        if status == SKIPPED:
            halts[last](False)
        index = skipped = 0
        catching = False
        state.fault = cause
        return FAILURE

    def halt(keep: bool) -> None:
        nonlocal index, skipped, trying, catching
        halts[last if catching else index](keep)
        if keep:
            return
        index = skipped = 0
        if trying:
            trying = False  # first of all: no other halt, also one that an exception brings, comes here again
            if not state.emergency and wanted():
                catching = True
                clean_up()
                halts[last](False)
        catching = False

    def wanted() -> bool:
        try:
            return catch_on_halt()
        except ActionFailed as failed:
            state.halt_faults.append(Fault(instance.index, str(failed), failed))
            return False

    def clean_up() -> None:
        before, state.fault = state.fault, None  # why somebody halts it stays the latest failure
        failed = ticks[last]() == FAILURE
        fault, state.fault = state.fault, before
        if failed and fault is not None and fault.reason:
            state.halt_faults.append(Fault(fault.index, f"cleaning up failed: {fault.reason}", fault.exception))

    return tick, halt
