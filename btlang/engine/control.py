"""Nodes that tick their children in order or side by side; controls/*.cpp of BehaviorTree.CPP 4.10."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.build import Site, apart
from btlang.engine.row import row, settle
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled
    from btlang.engine.row import Ticks

    Count = Callable[[], int]


def sequence(site: Site, children: Sequence[Compiled]) -> Compiled:
    """One child after the other until one fails; a running one is resumed. SKIPPED if all (sequence_node.cpp)."""
    return _in_order(children, SUCCESS)


def fallback(site: Site, children: Sequence[Compiled]) -> Compiled:
    """One child after the other until one succeeds; a running one is resumed. SKIPPED if all (fallback_node.cpp)."""
    return _in_order(children, FAILURE)


def sequence_with_memory(site: Site, children: Sequence[Compiled]) -> Compiled:
    """An AsyncSequence that, after a failure or a halt, starts again at the child it had reached.

    Only its own success starts it at the first child (sequence_with_memory_node.cpp).
    """
    return _breathing(site, children, SUCCESS, remember=True)


def async_sequence(site: Site, children: Sequence[Compiled]) -> Compiled:
    """A Sequence that returns RUNNING after each child that succeeded within one tick: it can be interrupted."""
    return _breathing(site, children, SUCCESS)


def async_fallback(site: Site, children: Sequence[Compiled]) -> Compiled:
    """A Fallback that returns RUNNING after each child that failed within one tick."""
    return _breathing(site, children, FAILURE)


def _in_order(children: Sequence[Compiled], passes: int) -> Compiled:
    """Goes on to the next child at the status `passes`, and returns it after the last child."""
    ticks, halts, sites = row(children)
    nothing = None if passes is SUCCESS else passes  # what functions return is most often nothing
    index = skipped = 0

    # what does not change are defaults: a cell for each would be a third of the memory of a tree
    def tick(
        ticks: Ticks = ticks,
        count: int = len(ticks),
        passes: int = passes,
        nothing: int | None = nothing,
    ) -> int:
        nonlocal index, skipped
        plain = -1  # the latest child that passed, where nothing has settled what it answered
        while index < count:
            try:
                status = ticks[index]()
                if status is passes or status is nothing:
                    plain = index
                    index += 1
                    continue
                if status == RUNNING:
                    return RUNNING
            except KeyboardInterrupt:
                raise
            except BaseException as problem:
                status = problem
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
            else:
                status = settle(sites[index], status)
                if status is not passes:
                    index = skipped = 0
                    return status
                plain = -1
            index += 1
        if skipped:
            passes = SKIPPED if skipped == count else passes
            skipped = 0
        if passes is FAILURE and plain >= 0:
            settle(sites[plain], FAILURE)
        index = 0
        return passes

    def halt(keep: bool) -> None:
        nonlocal index, skipped
        if index < len(halts):  # not so where an exception came after the last child
            halts[index](keep)
        if not keep:
            index = skipped = 0

    return tick, halt


def _breathing(site: Site, children: Sequence[Compiled], passes: int, remember: bool = False) -> Compiled:
    """As `_in_order`, but RUNNING between two children of which the first took no longer than its tick.

    The next tick comes at once then; but not in a second run at the same time, so that no loop holds the time.
    """
    ticks, halts = apart(children)
    count = len(ticks)
    clock = site.shared.clock
    index = skipped = 0
    waiting = -1  # the child that was RUNNING at the last tick
    began: float | None = None  # when the first child was last started
    hurries = True

    def tick() -> int:
        nonlocal index, skipped, waiting, began, hurries
        if index == 0 and waiting != 0:
            began, hurries = clock.now, began != clock.now
        while index < count:
            status = ticks[index]()
            if status == RUNNING:
                waiting = index
                return RUNNING
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
            elif status is not passes:
                skipped = 0
                waiting = -1
                if not remember:
                    index = 0
                return status
            index += 1
            if status is passes and index != waiting + 1 and index < count:
                if hurries:
                    clock.wake_at(clock.now)
                return RUNNING
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
    if site.node.port("success_count", "-1") == "-1" and site.node.port("failure_count", "1") == "1":
        return _all_or_none(site, children)
    ticks, halts, sites = row(children)
    count = len(ticks)
    success_count = site.number("success_count", -count - 1, count)
    failure_count = site.number("failure_count", -count - 1, count)
    completed = [False] * count
    successes = failures = 0
    shared = site.shared
    fault = shared.fault  # of the child that failed last

    def tick(ticks: Ticks = ticks, success_count: Count = success_count, failure_count: Count = failure_count) -> int:
        nonlocal successes, failures, fault
        required, allowed = success_count(), failure_count()
        counts_skipped = required < 0
        if required < 0:
            required += count + 1
        if allowed < 0:
            allowed += count + 1
        skipped = 0
        undecided = False  # after the latest child, and nothing has changed since
        for index, child in enumerate(ticks):
            if not completed[index]:
                try:
                    status = child()
                    if status == RUNNING and undecided:
                        continue
                except KeyboardInterrupt:
                    raise
                except BaseException as problem:
                    status = problem
                if status is SUCCESS or (
                    status != RUNNING and status != SKIPPED and (status := settle(sites[index], status)) is SUCCESS
                ):
                    completed[index] = True
                    successes += 1
                elif status is FAILURE:
                    completed[index] = True
                    failures += 1
                    fault = shared.fault
                elif status == SKIPPED:
                    skipped += 1
            undecided = True
            if successes >= required or (counts_skipped and successes + skipped >= required):
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
        if successes + failures < count:
            for index, stop in enumerate(halts):
                if not completed[index]:
                    stop(keep)
        if not keep:
            completed[:] = [False] * count
            successes = failures = 0

    return tick, halt


def _all_or_none(site: Site, children: Sequence[Compiled]) -> Compiled:
    """A Parallel with the usual thresholds: it ends with the first failure, or when no child is RUNNING any more."""
    ticks, halts, sites = row(children)
    everyone = tuple(enumerate(ticks))
    left = everyone  # those that have not completed
    completed = [False] * len(ticks)
    shared = site.shared

    def tick(going_on: int = RUNNING) -> int:
        nonlocal left
        running = fewer = skipped = False
        for index, child in left:
            try:
                status = child()
                if status is going_on:  # what nearly all say, compared as fast as can be
                    running = True
                    continue
                if status is SUCCESS or status is None:
                    completed[index] = fewer = True
                    continue
                if status == RUNNING:
                    running = True
                    continue
            except KeyboardInterrupt:
                raise
            except BaseException as problem:
                status = problem
            if status == SKIPPED:
                skipped = True
            elif settle(sites[index], status) is FAILURE:
                fault = shared.fault
                halt(False)
                shared.fault = fault
                return FAILURE
            else:
                completed[index] = fewer = True
        if running:
            if fewer:
                find_left()
            return RUNNING
        if skipped:
            halt(False)
        else:
            completed[:] = [False] * len(completed)
            left = everyone
        return SUCCESS

    def find_left() -> None:
        nonlocal left
        left = tuple([each for each in everyone if not completed[each[0]]])

    def halt(keep: bool) -> None:
        for index, stop in enumerate(halts):
            if not completed[index]:
                stop(keep)
        if not keep:
            completed[:] = [False] * len(completed)
        find_left()

    return tick, halt


def parallel_all(site: Site, children: Sequence[Compiled]) -> Compiled:
    """Ticks all until each has completed; FAILURE if max_failures (1) or more failed (parallel_all_node.cpp)."""
    ticks, halts, sites = row(children)
    count = len(ticks)
    max_failures = site.number("max_failures", -count - 1, count)
    completed = [False] * count
    failures = 0
    shared = site.shared
    fault = shared.fault  # of the child that made it one too many

    def tick() -> int:
        nonlocal failures, fault
        allowed = max_failures()
        if allowed < 0:
            allowed += count + 1
        skipped = 0
        for index, child in enumerate(ticks):
            if not completed[index]:
                try:
                    status = child()
                    if status == RUNNING:
                        continue
                except KeyboardInterrupt:
                    raise
                except BaseException as problem:
                    status = problem
                if status == SKIPPED:
                    skipped += 1
                else:
                    completed[index] = True
                    if settle(sites[index], status) is FAILURE:
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
