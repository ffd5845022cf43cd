"""Nodes that decide whether their one child runs, or runs again; decorators/*.h of BehaviorTree.CPP 4.10.

One difference: a Precondition whose child was SKIPPED or halted asks its condition again. There it remembers that the
condition once held until the child completes.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.build import Site
from btlang.engine.gated import gated
from btlang.engine.leaf import ActionFailed
from btlang.engine.ports import STATUSES, TRUTHS, choice_port
from btlang.engine.script import truth
from btlang.engine.script_nodes import not_true, script_of
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


def keep_running_until_failure(site: Site, children: Sequence[Compiled]) -> Compiled:
    """RUNNING until its child fails: FAILURE (keep_running_until_failure_node.h). SKIPPED is RUNNING too."""
    [(child, halt)] = children

    def tick() -> int:
        return FAILURE if child() == FAILURE else RUNNING

    return tick, halt


def run_once(site: Site, children: Sequence[Compiled]) -> Compiled:
    """Runs its child until it completes, once for as long as the tree exists: no halt makes it run again.

    From then on SKIPPED, or with then_skip="false" the status of that one run (run_once_node.h).
    """
    [(child, halt)] = children
    then_skip = choice_port(site, "then_skip", TRUTHS)
    result = IDLE
    shared = site.shared
    fault = shared.fault  # of that run

    def tick() -> int:
        nonlocal result, fault
        skips = then_skip()
        if result == IDLE:
            status = child()
            if status in (SUCCESS, FAILURE):
                result, fault = status, shared.fault
            return status
        if skips:
            return SKIPPED
        if result == FAILURE:
            shared.fault = fault
            return site.pass_on("its one run had failed")
        return result

    return tick, halt


def precondition(site: Site, children: Sequence[Compiled]) -> Compiled:
    """Its child where the script `if` holds when it starts, else the status in `else` (script_precondition.h)."""
    condition, scope = script_of(site, "if"), site.scope
    refusal = not_true(site, "if")
    otherwise = choice_port(site, "else", STATUSES)

    def ask() -> int:
        try:
            holds = truth(condition(scope))
        except ActionFailed as failed:
            return site.fail(str(failed))
        if holds:
            return IDLE
        status = otherwise()
        return site.fail(refusal) if status == FAILURE else status

    return gated(children, ask)
