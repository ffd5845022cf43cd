"""TryCatch: a sequence, and what to do when it fails; try_catch_node.cpp of BehaviorTree.CPP 4.10.

One difference: there, `catch_on_halt` makes a halt tick the last child. Here a halt stops and starts nothing, so the
port may only be false.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.build import Site, apart
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


def try_catch(site: Site, children: Sequence[Compiled]) -> Compiled:
    """All children but the last are a Sequence. When it fails, the last one runs to its end; then FAILURE.

    The recorded failure is that of the sequence, whatever the last child does.
    """
    if site.node.port("catch_on_halt", "false") not in ("false", "0"):
        raise site.error("catch_on_halt can only be false: a halt starts nothing")
    ticks, halts = apart(children)
    last = len(ticks) - 1
    shared = site.shared
    index = skipped = 0
    catching = False
    cause = shared.fault

    def tick() -> int:
        nonlocal index, skipped, catching, cause
        while not catching:
            status = ticks[index]()
            if status == RUNNING:
                return RUNNING
            if status == FAILURE:
                catching, cause = True, shared.fault
                break
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
            index += 1
            if index == last:
                result = SKIPPED if skipped == last else SUCCESS
                index = skipped = 0
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
        nonlocal index, skipped, catching
        halts[last if catching else index](keep)
        if not keep:
            index = skipped = 0
            catching = False

    return tick, halt
