"""Nodes that tick their children in order or side by side; controls/*.cpp of BehaviorTree.CPP 4.10."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.build import Site, apart
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


def sequence(site: Site, children: Sequence[Compiled]) -> Compiled:
    """One child after the other until one fails; a running one is resumed. SKIPPED if all (sequence_node.cpp)."""
    return _in_order(children, SUCCESS)


def fallback(site: Site, children: Sequence[Compiled]) -> Compiled:
    """One child after the other until one succeeds; a running one is resumed. SKIPPED if all (fallback_node.cpp)."""
    return _in_order(children, FAILURE)


def async_sequence(site: Site, children: Sequence[Compiled]) -> Compiled:
    """A Sequence that returns RUNNING after each child that succeeded within one tick: it can be interrupted."""
    return _in_order(children, SUCCESS, breathe=True)


def async_fallback(site: Site, children: Sequence[Compiled]) -> Compiled:
    """A Fallback that returns RUNNING after each child that failed within one tick."""
    return _in_order(children, FAILURE, breathe=True)


def sequence_with_memory(site: Site, children: Sequence[Compiled]) -> Compiled:
    """A Sequence that, after a failure or a halt, starts again at the child it had reached.

    Only its own success starts it at the first child (sequence_with_memory_node.cpp).
    """
    return _in_order(children, SUCCESS, remember=True)


def _in_order(children: Sequence[Compiled], passes: int, breathe: bool = False, remember: bool = False) -> Compiled:
    """Goes on to the next child at the status `passes`, and returns it after the last child."""
    ticks, halts = apart(children)
    count = len(ticks)
    index = skipped = 0
    waiting = -1  # the child that was RUNNING at the last tick; only AsyncSequence and AsyncFallback ask

    def tick() -> int:
        nonlocal index, skipped, waiting
        while index < count:
            status = ticks[index]()
            if status == passes:
                index += 1
                if breathe and index != waiting + 1 and index < count:
                    return RUNNING
            elif status == RUNNING:
                waiting = index
                return RUNNING
            elif status == SKIPPED:
                halts[index](False)
                skipped += 1
                index += 1
            else:
                skipped = 0
                waiting = -1
                if not remember:
                    index = 0
                return status
        result = SKIPPED if skipped == count else passes
        index = skipped = 0
        waiting = -1
        return result

    def halt(keep: bool) -> None:
        nonlocal index, skipped, waiting
        if index < count:  # not so where an exception came after the last child
            halts[index](keep)
        if not keep:
            skipped = 0
            waiting = -1
            if not remember:
                index = 0

    return tick, halt


def parallel(site: Site, children: Sequence[Compiled]) -> Compiled:
    """Ticks all children that have not completed; ends as soon as enough succeeded or failed, and halts the others.

    Ports success_count (all by default) and failure_count (1); -1 is all, -2 all but one. It fails also when too few
    are left to succeed. With a negative success_count a skipped child counts as a success (parallel_node.cpp).
    """
    ticks, halts = apart(children)
    count = len(ticks)
    success_count = site.number("success_count", -1, -count - 1, count)
    failure_count = site.number("failure_count", 1, -count - 1, count)
    completed = [False] * count
    successes = failures = 0
    shared = site.shared
    fault = shared.fault  # of the child that failed last

    def tick() -> int:
        nonlocal successes, failures, fault
        threshold = success_count()
        required, allowed = _of(threshold, count), _of(failure_count(), count)
        skipped = 0
        for index, child in enumerate(ticks):
            if not completed[index]:
                status = child()
                if status == SUCCESS:
                    completed[index] = True
                    successes += 1
                elif status == FAILURE:
                    completed[index] = True
                    failures += 1
                    fault = shared.fault
                elif status == SKIPPED:
                    skipped += 1
            if successes >= required or (threshold < 0 and successes + skipped >= required):
                halt(False)
                return SUCCESS
            if count - failures < required or failures == allowed:
                failed = failures
                halt(False)
                if failed == 0:
                    return site.fail("its failure_count allows no child to run")
                shared.fault = fault
                return FAILURE if failed == 1 else site.pass_on(f"{failed} of {count} failed")
        return SKIPPED if skipped == count else RUNNING

    def halt(keep: bool) -> None:
        nonlocal successes, failures
        for index, stop in enumerate(halts):
            if not completed[index]:
                stop(keep)
        if not keep:
            completed[:] = [False] * count
            successes = failures = 0

    return tick, halt


def parallel_all(site: Site, children: Sequence[Compiled]) -> Compiled:
    """Ticks all until each has completed; FAILURE if max_failures (1) or more failed (parallel_all_node.cpp)."""
    ticks, halts = apart(children)
    count = len(ticks)
    max_failures = site.number("max_failures", 1, -count - 1, count)
    completed = [False] * count
    failures = 0
    shared = site.shared
    fault = shared.fault  # of the child that made it one too many

    def tick() -> int:
        nonlocal failures, fault
        allowed = _of(max_failures(), count)
        skipped = 0
        for index, child in enumerate(ticks):
            if not completed[index]:
                status = child()
                if status == SKIPPED:
                    skipped += 1
                elif status != RUNNING:
                    completed[index] = True
                    if status == FAILURE:
                        failures += 1
                        if failures <= allowed:
                            fault = shared.fault
        if skipped == count:
            return SKIPPED
        if skipped + sum(completed) < count:
            return RUNNING
        failed = failures
        halt(False)
        if failed < allowed:
            return SUCCESS
        if failed == 0:
            return site.fail("its max_failures allows no success")
        shared.fault = fault
        return FAILURE if failed == 1 else site.pass_on(f"{failed} of {count} failed")

    def halt(keep: bool) -> None:
        nonlocal failures
        for index, stop in enumerate(halts):
            if not completed[index]:
                stop(keep)
        if not keep:
            completed[:] = [False] * count
            failures = 0

    return tick, halt


def _of(threshold: int, count: int) -> int:
    """How many children a threshold means; negative ones count from all of them down."""
    return threshold if threshold >= 0 else count + threshold + 1
