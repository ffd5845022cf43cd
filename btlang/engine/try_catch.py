"""TryCatch: a sequence, and what to do when it fails; try_catch_node.cpp of BehaviorTree.CPP 4.10.

Differences: what `catch_on_halt` starts does not run on an emergency stop, nor where the sequence was SKIPPED, and a
suspension is no halt.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.build import Fault, Site, apart
from btlang.engine.leaf import ActionFailed
from btlang.engine.ports import TRUTHS, choice_port
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


def try_catch(site: Site, children: Sequence[Compiled]) -> Compiled:
    """All children but the last are a Sequence. When it fails, the last one runs to its end; then FAILURE.

    With catch_on_halt="true" the last child is also ticked once, and halted where it is RUNNING, after a halt has
    stopped the sequence. The recorded failure is that of the sequence, whatever the last child does.
    """
    ticks, halts = apart(children)
    last = len(ticks) - 1
    shared = site.shared
    catch_on_halt = choice_port(site, "catch_on_halt", TRUTHS)
    index = skipped = 0
    trying = catching = False
    cause = shared.fault

    def tick() -> int:
        nonlocal index, skipped, trying, catching, cause
        trying = not catching
        while trying:
            status = ticks[index]()
            if status == RUNNING:
                return RUNNING
            if status == FAILURE:
                trying, catching, cause = False, True, shared.fault
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
        shared.fault = cause
        return FAILURE

    def halt(keep: bool) -> None:
        nonlocal index, skipped, trying, catching
        halts[last if catching else index](keep)
        if keep:
            return
        index = skipped = 0
        if trying:
            trying = False  # first of all: no other halt, also one that an exception brings, comes here again
            if not shared.emergency and wanted():
                catching = True
                clean_up()
                halts[last](False)
        catching = False

    def wanted() -> bool:
        try:
            return catch_on_halt()
        except ActionFailed as failed:
            shared.halt_faults.append(Fault(site.index, str(failed), failed))
            return False

    def clean_up() -> None:
        before, shared.fault = shared.fault, None  # why somebody halts it stays the latest failure
        failed = ticks[last]() == FAILURE
        fault, shared.fault = shared.fault, before
        if failed and fault is not None and fault.reason:
            shared.halt_faults.append(Fault(fault.index, f"cleaning up failed: {fault.reason}", fault.exception))

    return tick, halt
