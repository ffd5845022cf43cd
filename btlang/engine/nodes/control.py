"""Nodes that tick their children in order or at the same time, as controls/*.cpp of BehaviorTree.CPP 4.10.

One difference: in C++ a reactive node halts its running child after another one has become RUNNING, so for a moment two
actions drive the robot. Here the child is halted before a generator or class leaf starts under another child. Functions
run without halting anything.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.instance import NodeInstance, split_children
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled, Tick

    Count = Callable[[], int]


def sequence(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick one child after the other until one fails; a running one is resumed. SKIPPED if all are
    (sequence_node.cpp).
    """
    return _in_order(children, SUCCESS)


def fallback(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick one child after the other until one succeeds; a running one is resumed. SKIPPED if all are
    (fallback_node.cpp).
    """
    return _in_order(children, FAILURE)


def sequence_with_memory(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run an AsyncSequence that, after a failure or a halt, starts again at the child it had reached.

    Only its own success starts it at the first child (sequence_with_memory_node.cpp).
    """
    return _in_steps(instance, children, SUCCESS, remember=True)


def async_sequence(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run a Sequence that returns RUNNING after each child that succeeded within one tick: it can be interrupted."""
    return _in_steps(instance, children, SUCCESS)


def async_fallback(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run a Fallback that returns RUNNING after each child that failed within one tick."""
    return _in_steps(instance, children, FAILURE)


def _in_order(children: Sequence[Compiled], passes: int) -> Compiled:
    """Go on to the next child at the status `passes`, and return it after the last child."""
    ticks, halts = split_children(children)
    index = skipped = 0

    # what does not change are defaults: a cell for each would be a third of the memory of a tree
    def tick(ticks: tuple[Tick, ...] = ticks, count: int = len(ticks), passes: int = passes) -> int:
        nonlocal index, skipped
        while index < count:
            status = ticks[index]()
            if status == RUNNING:
                return RUNNING
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
            elif status is not passes:
                index = skipped = 0
                return status
            index += 1
        result = SKIPPED if skipped == count else passes
        index = skipped = 0
        return result

    def halt(keep: bool) -> None:
        nonlocal index, skipped
        if index < len(halts):  # not so where an exception came after the last child
            halts[index](keep)
        if not keep:
            index = skipped = 0

    return tick, halt


def _in_steps(instance: NodeInstance, children: Sequence[Compiled], passes: int, remember: bool = False) -> Compiled:
    """Run as `_in_order` does, but return RUNNING between two children if the first took no longer than its tick.

    The next tick comes at once then; but not in a second run at the same time, so that no loop holds the time.
    """
    ticks, halts = split_children(children)
    count = len(ticks)
    clock = instance.state.clock
    index = skipped = 0
    waiting = -1  # the child that was RUNNING at the last tick
    began: float | None = None  # when the first child was last started
    hurries = True  # the names of these variables are in saved runs

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


def parallel(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick all children that haven't completed; end as soon as enough succeeded or failed, and halt the others.

    Ports success_count (all by default) and failure_count (1); -1 is all, -2 all but one. It fails also when too few
    are left to succeed. With a negative success_count a skipped child counts as a success (parallel_node.cpp).
    """
    ticks, halts = split_children(children)
    count = len(ticks)
    success_count = instance.number("success_count", -count - 1, count)
    failure_count = instance.number("failure_count", -count - 1, count)
    completed = [False] * count
    successes = failures = 0
    state = instance.state
    fault = state.fault  # of the child that failed last

    def tick(success_count: Count = success_count, failure_count: Count = failure_count) -> int:
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
                status = child()
                if status == RUNNING and undecided:
                    continue
                if status == SUCCESS:
                    completed[index] = True
                    successes += 1
                elif status == FAILURE:
                    completed[index] = True
                    failures += 1
                    fault = state.fault
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
                    return instance.fail("its failure_count allows no child to run")
                state.fault = fault
                return FAILURE if failed == 1 else instance.pass_on(f"{failed} of {count} failed")
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


def parallel_all(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick all until each has completed; FAILURE if max_failures (1) or more failed (parallel_all_node.cpp)."""
    ticks, halts = split_children(children)
    count = len(ticks)
    max_failures = instance.number("max_failures", -count - 1, count)
    completed = [False] * count
    failures = 0
    state = instance.state
    fault = state.fault  # of the child that made it one too many

    def tick() -> int:
        nonlocal failures, fault
        allowed = max_failures()
        if allowed < 0:
            allowed += count + 1
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
                            fault = state.fault
        if skipped == count:
            return SKIPPED
        if skipped + sum(completed) < count:
            return RUNNING
        failed = failures
        halt(False)
        if failed < allowed:
            return SUCCESS
        if failed == 0:
            return instance.fail("its max_failures allows no success")
        state.fault = fault
        return FAILURE if failed == 1 else instance.pass_on(f"{failed} of {count} failed")

    def halt(keep: bool) -> None:
        nonlocal failures
        for index, stop in enumerate(halts):
            if not completed[index]:
                stop(keep)
        if not keep:
            completed[:] = [False] * count
            failures = 0

    return tick, halt


def reactive_sequence(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick from the first child each time, until one fails; a child that is RUNNING or fails halts the others."""
    return _reactive(instance, children, SUCCESS)


def reactive_fallback(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick from the first child each time, until one succeeds; one that is RUNNING or succeeds halts the others."""
    return _reactive(instance, children, FAILURE)


def _reactive(instance: NodeInstance, children: Sequence[Compiled], passes: int) -> Compiled:
    """Go on to the next child at the status `passes`, and return it after the last child. SKIPPED if all are."""
    ticks, halts = split_children(children)
    pairs, count = tuple(enumerate(ticks)), len(ticks)
    interrupts = instance.state.interrupts
    running = -1  # the child that was RUNNING at the last tick
    asked = 0  # the child that is being ticked

    def interrupt() -> None:
        nonlocal running
        if asked < running:
            child, running = running, -1
            halts[child](False)

    def tick() -> int:
        nonlocal running, asked
        if running > 0:
            interrupts.append(interrupt)
        skipped = 0
        status = passes
        for asked, child in pairs:
            status = child()
            if status == SKIPPED:
                halts[asked](False)
                skipped += 1
            elif status is not passes:
                break
        if interrupts and interrupts[-1] is interrupt:
            interrupts.pop()
        if status is not passes and status != SKIPPED:
            if asked < running:
                if status is FAILURE:
                    instance.pass_on("its guard failed on the way")
                halts[running](False)
            running = asked if status == RUNNING else -1
            return status
        running = -1
        return SKIPPED if skipped == count else passes

    def halt(keep: bool) -> None:
        nonlocal running
        for stop in halts:
            stop(keep)
        if not keep:
            running = -1

    return tick, halt
