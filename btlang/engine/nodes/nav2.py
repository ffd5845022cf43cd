"""Nodes of Nav2 (nav2_behavior_tree/plugins/control and decorator) in the form they have for BehaviorTree.CPP 4.

Differences: a RecoveryNode whose recovery was SKIPPED fails and forgets its count, as after any other failure. There
the count stays, and the next run has fewer retries; what resets it by distance or time is not here. A RoundRobin with
wrap_around="false" succeeds with its last child; there it fails. A NonblockingSequence takes a child that was SKIPPED
as one that succeeded; there it throws. A PersistentSequence halts a running child when its position is set elsewhere.
A PauseResumeController has no services that could pause it.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.engine.instance import NodeInstance, blackboard_key, split_children
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import TRUTHS, choice_port, rate_port
from btlang.engine.nodes.timed import Stopwatch
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def pipeline_sequence(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick all children up to the furthest one reached, again those that have completed (pipeline_sequence.cpp).

    One before it may be RUNNING as well. A failure, or the last child's success, ends it and halts the others.
    """
    ticks, halts = split_children(children)
    count = len(ticks)
    reached = 0

    def tick() -> int:
        nonlocal reached
        skipped = 0
        for index, child in enumerate(ticks):
            status = child()
            if status == RUNNING:
                if index >= reached:
                    reached = index
                    return RUNNING
            elif status == FAILURE:
                halt(False)
                return FAILURE
            elif status == SKIPPED:
                skipped += 1
        halt(False)
        return SKIPPED if skipped == count else SUCCESS

    def halt(keep: bool) -> None:
        nonlocal reached
        for stop in halts:
            stop(keep)
        if not keep:
            reached = 0

    return tick, halt


def recovery_node(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run the second child, which recovers, when the first fails, and try the first again (recovery_node.cpp).

    At most number_of_retries (1) times, all within one tick where nothing is RUNNING. FAILURE also where the recovery
    fails or is SKIPPED; SKIPPED where the first child is.
    """
    ticks, halts = split_children(children)
    retries = instance.number("number_of_retries")
    position = count = 0  # of the child, and of the recoveries so far

    def tick() -> int:
        nonlocal position, count
        most = retries()
        while True:
            status = ticks[position]()
            if status == RUNNING:
                return RUNNING
            if position == 0 and status == FAILURE and count < most:
                position = 1
            elif position == 1 and status == SUCCESS:
                position = 0
                count += 1
            else:
                if status == SKIPPED:
                    halts[position](False)
                if position == 1:
                    instance.pass_on("its recovery failed" if status == FAILURE else "its recovery was skipped")
                    status = FAILURE
                elif count and status == FAILURE:
                    instance.pass_on(f"{count} {'recovery' if count == 1 else 'recoveries'} did not help")
                position = count = 0
                return status

    def halt(keep: bool) -> None:
        nonlocal position, count
        halts[position](keep)
        if not keep:
            position = count = 0

    return tick, halt


def round_robin(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run one child after the other until one succeeds; the next run begins after that one (round_robin_node.cpp).

    FAILURE when all have failed or were SKIPPED, SKIPPED when all were SKIPPED; with wrap_around="false" once the last
    one has. Then, and when it is halted while it runs, the next run begins with the first child.
    """
    ticks, halts = split_children(children)
    wraps = choice_port(instance, "wrap_around", TRUTHS)
    count = len(ticks)
    position = failed = 0
    running = False

    def tick() -> int:
        nonlocal position, failed, running
        running, around = True, wraps()
        skipped = 0
        while failed + skipped < count:
            status = ticks[position]()
            if status == RUNNING:
                return RUNNING
            if status == SKIPPED:
                halts[position](False)
                skipped += 1
            position = (position + 1) % count
            if status == SUCCESS:
                failed, running = 0, False
                return SUCCESS
            if status == FAILURE:
                failed += 1
            if position == 0 and not around:
                break
        position = failed = 0
        running = False
        return SKIPPED if skipped == count else FAILURE

    def halt(keep: bool) -> None:
        nonlocal position, failed, running
        halts[position](keep)
        if running and not keep:
            position = failed = 0
            running = False

    return tick, halt


def nonblocking_sequence(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick all children at each tick, again those that have completed (nonblocking_sequence.cpp).

    A failure, or that none is RUNNING any more, ends it and halts the others.
    """
    ticks, halts = split_children(children)
    count = len(ticks)

    def tick() -> int:
        skipped, running = 0, False
        for child in ticks:
            status = child()
            if status == FAILURE:
                halt(False)
                return FAILURE
            running = running or status == RUNNING
            skipped += status == SKIPPED
        if running:
            return RUNNING
        halt(False)
        return SKIPPED if skipped == count else SUCCESS

    def halt(keep: bool) -> None:
        for stop in halts:
            stop(keep)

    return tick, halt


def persistent_sequence(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run the children from the one whose number is in current_child_idx, and count it there (persistent_sequence.cpp).

    A halt doesn't change the number; a failure and the end set it to 0. SKIPPED is as SUCCESS.
    """
    ticks, halts = split_children(children)
    position = instance.number("current_child_idx", 0, len(ticks))
    key = blackboard_key("current_child_idx", instance.node.port("current_child_idx"))
    if key is None:
        raise instance.error("current_child_idx must be a {key}, where a Script has set it to 0")
    scope, running = instance.scope, -1  # the child that was RUNNING at the last tick

    def tick() -> int:
        nonlocal running
        try:
            at = position()
        except ActionFailed as problem:
            halt(False)
            return instance.fail(str(problem))
        if running not in (-1, at):
            halts[running](False)
        while at < len(ticks):
            status, running = ticks[at](), at
            if status == RUNNING:
                return RUNNING
            running = -1
            if status == FAILURE:
                scope.set(key, 0)
                return FAILURE
            if status == SKIPPED:
                halts[at](False)
            at += 1
            scope.set(key, at)
        scope.set(key, 0)
        return SUCCESS

    def halt(keep: bool) -> None:
        nonlocal running
        for stop in halts:
            stop(keep)
        if not keep:
            running = -1

    return tick, halt


def pause_resume_controller(_instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run the first child, as while nothing asks its services to pause it (pause_resume_controller.cpp)."""
    child, halt_child = children[0]

    def tick() -> int:
        status = child()
        if status != SKIPPED:
            return status
        halt_child(False)
        return SUCCESS

    return tick, halt_child


def single_trigger(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its child once, then return FAILURE until it is halted (single_trigger_node.cpp).

    Only a PipelineSequence and a NonblockingSequence keep nodes that have completed; elsewhere it starts anew.
    """
    [(child, halt_child)] = children
    stays = instance.parent_keeps_completed
    done = False

    def tick() -> int:
        nonlocal done
        if done:
            return FAILURE
        status = child()
        done = stays and status in (SUCCESS, FAILURE)
        return status

    def halt(keep: bool) -> None:
        nonlocal done
        halt_child(keep)
        if not keep:
            done = False

    return tick, halt


def rate_controller(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick its child at the start, while it is RUNNING, and every 1/hz s (hz: 10) (rate_controller.cpp).

    RUNNING in between. The time counts from the child's last success, and a PipelineSequence leaves it running.
    """
    [(child, halt_child)] = children
    hz = rate_port(instance, "hz")
    stopwatch = Stopwatch(instance.state.clock)
    stays = instance.parent_keeps_completed  # it does not reset a child that has completed
    fresh, running = True, False  # not yet started; the child was RUNNING at the last tick

    def tick() -> int:
        nonlocal fresh, running
        period = 1000 / hz()
        due = stopwatch.reached(period)
        if not (fresh or running or due):
            return stopwatch.wait(period)
        fresh = False
        status = child()
        running = status == RUNNING
        if not stays and status in (SUCCESS, FAILURE):
            reset()
        elif not running:
            if status == SUCCESS:
                stopwatch.halt(False)
                stopwatch.reached(period)
            stopwatch.wait(period)
        return status

    def reset() -> None:
        nonlocal fresh, running
        fresh, running = True, False
        stopwatch.halt(False)

    def halt(keep: bool) -> None:
        halt_child(keep)
        if keep:
            stopwatch.halt(True)
        else:
            reset()

    return tick, halt
