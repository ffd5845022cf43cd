"""Faster variants of nodes that tick many children, with the same results. Only compile.py chooses them.

A wrapper around each function leaf would take as long as the function itself. So these nodes call the functions as they
are, and normalize what is neither True nor False: another answer, or an exception. What a node does is written, simply,
in nodes/; tests/engine/test_reference.py runs both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from btlang.engine.instance import NodeInstance
from btlang.engine.leaves.callables import find_function, find_status
from btlang.engine.nodes import control
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.instance import Compiled, Halt

    Call: TypeAlias = Callable[[], Any]
    Ticks: TypeAlias = tuple[Call, ...]
    Calls: TypeAlias = tuple[Ticks, tuple[Halt, ...], tuple[NodeInstance | None, ...]]
    Compile: TypeAlias = Callable[[NodeInstance, Sequence[Compiled]], Compiled]


def choose_compiler(usual: Compile, instance: NodeInstance, children: Sequence[Compiled]) -> Compile:
    """Return the function that compiles a node fastest: its `usual` one, or a variant of it."""
    if usual is control.parallel:
        return default_parallel if has_usual_thresholds(instance.node) else usual
    if usual in _VARIANTS and any(find_function(tick) for tick, _ in children):
        return _VARIANTS[usual]
    return usual


def has_usual_thresholds(node: Node) -> bool:
    """Return whether a Parallel has its default thresholds; any other node counts as one that has."""
    return node.port("success_count", "-1") == "-1" and node.port("failure_count", "1") == "1"


def _calls(children: Sequence[Compiled]) -> Calls:
    """Return what to call for a tick of each child, the halts, and the instances of function leaves, None for other
    children.

    The caller of the ticks catches all but KeyboardInterrupt, and normalizes what it caught, every answer that is no
    status, and each FAILURE that makes it fail, so that the failure is that of the leaf.
    """
    functions = [find_function(tick) for tick, _ in children]
    ticks = [tick if leaf is None else leaf.call for (tick, _), leaf in zip(children, functions, strict=True)]
    instances = [None if leaf is None else leaf.instance for leaf in functions]
    return tuple(ticks), tuple([halt for _, halt in children]), tuple(instances)


def normalize_status(instance: NodeInstance | None, answer: object) -> int:
    """Return the status of an answer, or of an exception that was raised instead. A node's answer is its status."""
    if instance is None:
        if isinstance(answer, BaseException):
            raise answer
        assert isinstance(answer, int)
        return answer
    return find_status(instance, answer)


def in_order(instance: NodeInstance, children: Sequence[Compiled], passes: int) -> Compiled:
    """Compile a Sequence or Fallback; see nodes/control.py."""
    ticks, halts, instances = _calls(children)
    nothing = None if passes is SUCCESS else passes  # what functions return is most often nothing
    index = skipped = 0

    # what does not change are defaults: a cell for each would be a third of the memory of a tree
    def tick(ticks: Ticks = ticks, count: int = len(ticks), passes: int = passes, nothing: int | None = nothing) -> int:
        nonlocal index, skipped
        plain = -1  # the latest child that passed, whose answer has not been normalized
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
            status = SKIPPED if status == SKIPPED else normalize_status(instances[index], status)
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
            elif status is passes:
                plain = -1
            else:
                index = skipped = 0
                return status
            index += 1
        if skipped:
            passes = SKIPPED if skipped == count else passes
            skipped = 0
        if passes is FAILURE and plain >= 0:
            normalize_status(instances[plain], FAILURE)
        index = 0
        return passes

    def halt(keep: bool) -> None:
        nonlocal index, skipped
        if index < len(halts):  # not so where an exception came after the last child
            halts[index](keep)
        if not keep:
            index = skipped = 0

    return tick, halt


def default_parallel(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Compile a Parallel with its default thresholds: it ends with the first failure, or when no child is RUNNING."""
    ticks, halts, instances = _calls(children)
    everyone = tuple(enumerate(ticks))
    left = everyone  # those that have not completed; none where they are to be found
    completed = [False] * len(ticks)
    state = instance.state

    def tick(going_on: int = RUNNING) -> int:
        nonlocal left
        running = fewer = skipped = False
        if not left:
            left = find_left()
        for index, child in left:
            try:
                status = child()
                if status is going_on or status == RUNNING:  # what nearly all say, compared as fast as can be
                    running = True
                    continue
                if status is SUCCESS or status is None:
                    completed[index] = fewer = True
                    continue
            except KeyboardInterrupt:
                raise
            except BaseException as problem:
                status = problem
            status = SKIPPED if status == SKIPPED else normalize_status(instances[index], status)
            if status == SKIPPED:
                skipped = True
            elif status is FAILURE:
                fault = state.fault
                halt(False)
                state.fault = fault
                return FAILURE
            else:
                completed[index] = fewer = True
        if running:
            if fewer:
                left = ()
            return RUNNING
        if skipped:
            halt(False)
        else:
            completed[:] = [False] * len(completed)
            left = everyone
        return SUCCESS

    def find_left() -> tuple[tuple[int, Call], ...]:
        return everyone if not any(completed) else tuple([each for each in everyone if not completed[each[0]]])

    def halt(keep: bool) -> None:
        nonlocal left
        for index, stop in enumerate(halts):
            if not completed[index]:
                stop(keep)
        if not keep:
            completed[:] = [False] * len(completed)
        left = ()

    return tick, halt


_VARIANTS: dict[Compile, Compile] = {
    control.sequence: partial(in_order, passes=SUCCESS),
    control.fallback: partial(in_order, passes=FAILURE),
}
