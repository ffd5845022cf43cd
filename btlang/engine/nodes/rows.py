"""Leaves in a row below one node, in a generated region: each function is called on a line of its own, many in a loop.

As long as their answers are plain ones that pass, nothing else happens. `order_functions`, `react_functions` and
`join_functions` go on from any other answer. They get the slots, those of the node and of the row, and positions of
children; the slot of a row holds the instances of its functions, the one behind it their trace.

A Parallel resumes many leaves that take time in a loop, too: while all of them go on, their `send` is all it needs. The
slots of such a row are these of all that haven't completed (none if one of them isn't RUNNING), the leaves, and what
halts them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from sys import exc_info

from btlang.engine.instance import NodeInstance
from btlang.engine.leaves.callables import ClassLeaf, GeneratorLeaf, find_status
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.regions import Item, Region, Slots
    from btlang.engine.row_trace import RowTrace

AGAIN = object()
"""In place of an answer: the function hasn't been asked."""


def write_row(region: Region, item: Item, depth: int, passes: int, resumed: str, begin: str) -> int:
    """Write what calls functions in a row, until one gives another answer than the plain one that passes.

    `x` is then its position, and `r` the answer; else `x` is the end. Returns the slot of their instances, which is
    behind them; their trace follows. `resumed` says whether the row was left at a function, whose position is `begin`.
    """
    assert isinstance(item.child, list)
    leaves = item.child
    calls = [leaf.call for leaf in leaves]
    first = len(region.values)
    region.values += [tuple(calls)] if item.is_wide else calls
    row = region.slot(tuple([leaf.instance for leaf in leaves]))
    trace = region.trace_row(leaves, passes)
    region.slot(trace)
    if resumed:
        region.add(depth, f"if {resumed}: x, r = {begin}, AGAIN", "else:")
        depth += 1
    other = "is not True and r is not None" if passes else "is not False"
    all_passed = [f"x = {item.end}"]
    if not passes:  # the failure of the last one may be that of the node
        all_passed.append(f"S[0].fault = S[{row}][-1]")
    if trace is not None:
        places, before, after = (region.slot(each) for each in trace.whole)
        same = f"if W[S[{places}]] == S[{before}]: W[S[{places}]] = S[{after}]"
        all_passed += [same, f"else: S[{row + 1}].passed(0, {len(leaves)})"]
    if item.is_wide:
        region.add(depth, f"x = {item.first - 1}", "try:")
        region.add(depth + 1, f"for f in S[{first}]:", " x += 1", f" if (r := f()) {other}: break")
        region.add(depth + 1, "else:", *[f" {line}" for line in all_passed])
        region.add(depth, f"except: r, x = caught_at(x, {item.first}, {item.end})")
        return row
    region.add(depth, "try:", " while True:")
    line = region.next_line
    for number in range(len(leaves)):
        region.add(depth + 2, f"if (r := S[{first + number}]()) {other}: x = {item.first + number}; break")
    region.add(depth + 2, *all_passed, "break")
    region.add(depth, f"except: r, x = caught_in({line}, {item.first}, {item.end})")
    return row


def end_at_answer(region: Region, item: Item, row: int, passes: int, *then: str) -> list[str]:
    """Return the lines for a plain answer of a function that isn't the one that passes: the node ends with it."""
    at = f"x - {item.first}" if item.first else "x"
    lines = [" if r is True or r is None:", "  r = True"]
    if passes:
        lines = [" if r is False:", f"  S[0].fault = S[{row}][{at}]"]
    if region.trace is not None:
        lines.append(f"  S[{row + 1}].decided({at}, r)")
    return [*lines, *[f"  {line}" for line in then], "  break"]


def write_leaves(region: Region, leaves: Sequence[Any], depth: int) -> int:
    """Write what resumes leaves of one class, until one of them doesn't go on; return the slot of the row.

    `r` is then None if all go on; else `send` has given it, or raised it if `x` is true, and AGAIN if none was asked.
    """
    row = region.slot(())
    region.slot(tuple([each.leaf for each in leaves]))
    region.slot(tuple([each.halt for each in leaves]))
    argument = "None" if leaves[0].leaf.__class__ is GeneratorLeaf else ""
    region.add(depth, "r, x, send = AGAIN, False, None", "try:", f" for send in S[{row}]:")
    region.add(depth + 2, f"if (r := send({argument})) is not None: break")
    region.add(depth, "except: r, x = caught(), True")
    return row


def join_leaves(slots: Slots, at: int, begin: int, row: int, send: object, answer: object, raised: bool) -> int:
    """Go on among leaves in a row, from what one gave or raised, or from the first. Returns as join_functions does."""
    completed = slots[at]
    slots[row] = ()
    result = SUCCESS
    running = []
    leaves: tuple[ClassLeaf | GeneratorLeaf, ...] = slots[row + 1]
    for position, leaf in enumerate(leaves, begin):
        if completed[position]:
            continue
        if answer is AGAIN:
            status = leaf.tick()
        elif leaf.send is not send:
            status = RUNNING
        else:
            status = leaf.ended(answer) if raised and isinstance(answer, BaseException) else leaf.yielded(answer)
            answer = AGAIN
        if status is FAILURE:
            return FAILURE
        if status is SUCCESS:
            completed[position] = True
            continue
        if status == RUNNING or result is SUCCESS:
            result = status
        running.append(leaf.send)
    if answer is not AGAIN:  # it wasn't one of theirs: an exception of a signal comes anywhere
        assert isinstance(answer, BaseException)
        raise answer
    if None not in running:
        slots[row] = tuple(running)
    return result


def halt_leaves(slots: Slots, row: int, place: tuple[int, int], keep: bool) -> None:
    """Halt the leaves in a row that haven't completed, by the slot of their Parallel and the position of the first."""
    at, begin = place
    slots[row] = ()
    for position, halt in enumerate(slots[row + 2], begin):
        if not slots[at][position]:
            halt(keep)


def caught() -> BaseException:
    """Return the exception that is being handled. Raises KeyboardInterrupt."""
    problem = exc_info()[1]
    if isinstance(problem, KeyboardInterrupt):
        raise
    assert problem is not None
    return problem


def caught_at(position: int, begin: int, end: int) -> tuple[BaseException, int]:
    """Return the exception that is being handled and the position, if it is one of a row.

    Else raises the exception: that of a signal may come between two calls.
    """
    problem = caught()
    if not begin <= position < end:
        raise
    return problem, position


def caught_in(line: int, begin: int, end: int) -> tuple[BaseException, int]:
    """Return the exception that is being handled and the position of the function that raised it, which its line says,
    beginning with this one: to note at each tick which function is called would take time.
    """
    trace = caught().__traceback__
    return caught_at(-1 if trace is None else trace.tb_lineno - line + begin, begin, end)


def order_functions(slots: Slots, at: int, begin: int, row: int, first: int, answer: object, passes: int) -> int:
    """Go on in a row of functions at a position, from an answer that isn't plain. Returns `passes` if all have."""
    for position, status in _statuses(slots, begin, row, first, answer, passes):
        if status == RUNNING:
            slots[at] = position
            return RUNNING
        if status == SKIPPED:
            slots[at + 1] += 1
        elif status is not passes:
            slots[at] = slots[at + 1] = 0
            return status
    return passes


def react_functions(slots: Slots, at: int, begin: int, row: int, first: int, answer: object, passes: int) -> int:
    """Go on in a row of functions at a position, from an answer that isn't plain. Returns `passes` if all have."""
    for position, status in _statuses(slots, begin, row, first, answer, passes):
        if status == SKIPPED:
            slots[at + 2] += 1
        elif status is not passes:
            slots[at + 1] = position
            return status
    return passes


def join_functions(slots: Slots, at: int, begin: int, row: int, position: int, answer: object) -> int:
    """Go on among functions at a position, from an answer that isn't plain. Returns FAILURE if one failed, else RUNNING
    or SKIPPED if one is, else SUCCESS. Those before were called in this tick if there is an answer.
    """
    completed = slots[at]
    calls, instances, trace = _row(slots, row)
    if answer is not AGAIN and position > begin:
        completed[begin:position] = [True] * (position - begin)
        if trace is not None:
            trace.passed(0, position - begin)
    result = SUCCESS
    for number in range(position - begin, len(instances)):
        if answer is AGAIN:
            if completed[begin + number]:
                continue
            answer = _ask(calls[number])
        status = find_status(instances[number], answer)
        answer = AGAIN
        if trace is not None:
            trace.answered(number, status)
        if status is FAILURE:
            return FAILURE
        if status is SUCCESS:
            completed[begin + number] = True
        elif status == RUNNING or result is SUCCESS:
            result = status
    return result


def _row(slots: Slots, row: int) -> tuple[Sequence[Callable[[], object]], tuple[NodeInstance, ...], RowTrace | None]:
    """Return the functions of a row, their instances and their trace."""
    instances, before = slots[row], slots[row - 1]
    return before if before.__class__ is tuple else slots[row - len(instances) : row], instances, slots[row + 1]


def _statuses(
    slots: Slots, begin: int, row: int, position: int, answer: object, passes: int
) -> Iterator[tuple[int, int]]:
    """Yield positions and statuses of the functions of a row, from one that gave an answer that isn't plain."""
    calls, instances, trace = _row(slots, row)
    behind = position - begin
    if behind and answer is not AGAIN:
        if trace is not None:
            trace.passed(0, behind)
        if passes is FAILURE:
            slots[0].fault = instances[behind - 1]
    for number in range(behind, len(instances)):
        if answer is AGAIN:
            answer = _ask(calls[number])
        status = find_status(instances[number], answer)
        if trace is not None:
            trace.answered(number, status)
        yield begin + number, status
        answer = AGAIN


def _ask(function: Callable[[], object]) -> object:
    try:
        return function()
    except KeyboardInterrupt:
        raise
    except BaseException as problem:
        return problem
