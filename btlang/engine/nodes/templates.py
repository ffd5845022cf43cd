"""What nodes do, as templates of the functions that are generated for whole regions of a tree (see regions.py).

Each template does the same as the function of its node in another module here, and remembers it by the same names. It
writes lines that leave the status of the node in `r`; 2 is RUNNING, 3 SKIPPED. What happens seldom is written once, as
a helper that these lines call. A template returns a layout, by which its node is halted: a function, a slot, and the
layouts of the children that may run for longer than a tick, by position.

Nothing that lasts is kept in a variable while a child is ticked: an interrupt may end the tick, and halts what runs by
the slots alone.
"""

from __future__ import annotations

from functools import partial

from btlang.engine.leaves.callables import find_status
from btlang.engine.nodes.branch_templates import (
    end_undecided,
    if_then_else,
    leave_branch,
    skip_branch,
    while_do_else,
)
from btlang.engine.nodes.decorator_templates import (
    begins_pause,
    complete_rounds,
    end_rounds,
    end_timeout,
    force_failure,
    inverter,
    is_pausing,
    other_status,
    rounds,
    subtree,
    timeout,
)
from btlang.engine.nodes.rows import (
    AGAIN,
    caught,
    caught_at,
    caught_in,
    end_at_answer,
    halt_leaves,
    join_functions,
    join_leaves,
    order_functions,
    react_functions,
    write_leaves,
    write_row,
)
from btlang.engine.regions import Resumed, group_lasting, halt_part, halt_row
from btlang.engine.status import FAILURE, RUNNING, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.regions import Emit, Fragment, Layout, Region, Slots

    Layouts: TypeAlias = dict[int, Layout]


def in_order(region: Region, node: Fragment, depth: int, level: int, passes: int) -> Layout:
    """Write a Sequence or Fallback: go on to the next child at the status `passes`, and return it after the last."""
    at = region.remember(node.instance, index=0, skipped=0)
    position = f"p{level}"
    children: Layouts = {}
    region.add(depth, f"{position} = S[{at}]", "while True:")
    for item in node.items:
        inside = depth + 1
        if item.end < node.count:  # what has passed in an earlier tick is left out
            region.add(inside, f"if {position} < {item.end}:")
            inside += 1
        if isinstance(item.child, list):
            row = write_row(region, item, inside, passes, f"{position} > {item.first}", position)
            children[item.first] = halt_row, row + 1, None
            region.add(
                inside,
                f"if x != {item.end}:",
                *end_at_answer(region, item, row, passes, *([f"S[{at}] = S[{at + 1}] = 0"] if item.first else [])),
                f" r = order_functions(S, {at}, {item.first}, {row}, x, r, {passes})",
                f" if r is not {passes}: break",
            )
            continue
        children[item.first] = layout = region.child(
            item, inside, level + 1, [f"S[{at}] = {item.first}"], "r = 2; break"
        )
        region.add(
            inside,
            f"if r is not {passes}:",
            f" if r is {not passes}: S[{at}] = S[{at + 1}] = 0; break",
            " if r == 2: break",
            f" skip(S, L[{region.layout(layout)}], {at + 1})",
        )
    is_row = len(node.items) == 1 and isinstance(node.items[0].child, list)  # of which nothing changed if all passed
    region.add(
        depth + 1 + is_row,
        f"r = {passes}",
        f"if S[{at + 1}]:",
        f" if S[{at + 1}] == {node.count}: r = 3",
        f" S[{at + 1}] = 0",
        f"S[{at}] = 0",
        "break",
    )
    if is_row:
        region.add(depth + 1, f"r = {passes}", "break")
    return _halt_in_order, at, children


def skip(slots: Slots, layout: Layout, count: int) -> None:
    """Halt a child that was SKIPPED, and count it in a slot."""
    halt_part(slots, layout, False)
    slots[count] += 1


def _halt_in_order(slots: Slots, at: int, children: Layouts, keep: bool) -> None:
    _halt_child(slots, children, slots[at], keep)
    if not keep:
        slots[at] = slots[at + 1] = 0


def _halt_child(slots: Slots, children: Layouts, position: int, keep: bool) -> None:
    first = position if position in children else max([first for first in children if first < position])
    halt, at, _ = children[first]
    if halt is not halt_row:
        halt_part(slots, children[first], keep)
    elif slots[at] is not None:
        slots[at].halted(position - first)


def reactive(region: Region, node: Fragment, depth: int, level: int, passes: int) -> Layout:
    """Write a ReactiveSequence or ReactiveFallback, which goes on at the status `passes`."""
    at = region.remember(node.instance, running=-1, asked=0)
    skipped = region.slot(0)
    children: Layouts = {}
    region.slot(node.instance)
    lasting = [item.first for item in node.items if not isinstance(item.child, list)]
    interrupts = len(lasting) > 1  # else no action can start under a child before the one that is RUNNING
    stop = region.slot(None)
    if interrupts:
        region.values[stop] = partial(_interrupt, region.values, at, children)
        region.add(depth, f"if S[{at}] > {lasting[0]}: S[0].interrupts.append(S[{stop}])")
    region.add(depth, f"S[{skipped}] = 0", "while True:")
    for item in node.items:
        if isinstance(item.child, list):
            row = write_row(region, item, depth + 1, passes, "", "")
            region.add(
                depth + 1,
                f"if x != {item.end}:",
                *end_at_answer(region, item, row, passes, f"S[{at + 1}] = x"),
                f" r = react_functions(S, {at}, {item.first}, {row}, x, r, {passes})",
                f" if r is not {passes}: break",
            )
            children[item.first] = halt_row, row + 1, None
            continue
        region.add(depth + 1, f"S[{at + 1}] = {item.first}")
        children[item.first] = layout = region.child(item, depth + 1, level + 1, running="r = 2; break")
        region.add(
            depth + 1,
            f"if r is not {passes}:",
            f" if r is {not passes} or r == 2: break",
            f" skip(S, L[{region.layout(layout)}], {skipped})",
        )
    region.add(
        depth + 1, f"r = {passes}", f"if S[{skipped}] == {node.count}: r, S[{at + 1}] = 3, {node.count}", "break"
    )
    own = _halt_reactive, at, children
    if interrupts:
        region.add(depth, f"if S[0].interrupts and S[0].interrupts[-1] is S[{stop}]: S[0].interrupts.pop()")
    region.add(
        depth,
        f"if r is {passes}: S[{at}] = -1",
        f"elif r != 2 or S[{at + 1}] != S[{at}]: end_reactive(S, L[{region.layout(own)}], r)",
    )
    return own


def end_reactive(slots: Slots, layout: Layout, status: int) -> None:
    """Note that a child decided, or is RUNNING and wasn't; halt a later one that was. All may have been SKIPPED."""
    _, at, children = layout
    running, asked = slots[at], slots[at + 1]
    if asked < running:
        if status is FAILURE:
            slots[at + 3].pass_on("its guard failed on the way")
        _halt_child(slots, children, running, False)
    slots[at] = asked if status == RUNNING else -1


def _interrupt(slots: Slots, at: int, children: Layouts) -> None:
    running = slots[at]
    if slots[at + 1] < running:
        slots[at] = -1
        _halt_child(slots, children, running, False)


def _halt_reactive(slots: Slots, at: int, children: Layouts, keep: bool) -> None:
    for child in children.values():
        halt_part(slots, child, keep)
    if not keep:
        slots[at] = -1


def parallel(region: Region, node: Fragment, depth: int, level: int) -> Layout:
    """Write a Parallel with its default thresholds: it ends with the first failure, or when no child is RUNNING."""
    count = node.count
    at = region.remember(node.instance, completed=[False] * count)
    region.slot(None)  # whether one has completed; None: it isn't known
    children: Layouts = {}
    own = _halt_parallel, at, children
    number = region.layout(own)
    completed, some, fewer = f"z{level}", f"w{level}", f"h{level}"
    running, skipped = f"g{level}", f"k{level}"
    region.add(
        depth,
        f"{completed} = S[{at}]",
        f"{some} = S[{at + 1}]",
        f"if {some} is None: {some} = S[{at + 1}] = True in {completed}",
        f"{running} = {skipped} = {fewer} = False",
        "while True:",
    )
    for item, *others in group_lasting(node.items):
        inside = depth + 1
        if others:
            row = write_leaves(region, [each.child for each in (item, *others)], inside)
            children[item.first] = halt_leaves, row, (at, item.first)
            region.add(
                inside,
                f"if r is None: {running} = True",
                "else:",
                f" r, {fewer} = join_leaves(S, {at}, {item.first}, {row}, send, r, x), True",
                f" if r == 2: {running} = True",
                " elif r is False: break",
                f" elif r == 3: {skipped} = True",
            )
            continue
        done = f"{completed}[{item.first}] = {fewer} = True"
        if isinstance(item.child, list):
            row = write_row(region, item, inside, SUCCESS, some, str(item.first))
            region.add(
                inside,
                f"if x == {item.end}: r = True",
                "else:",
                *end_at_answer(region, item, row, SUCCESS),
                f" r, {fewer} = join_functions(S, {at}, {item.first}, {row}, x, r), True",
            )
            children[item.first] = halt_row, row + 1, None
            done = "pass"
            if len(node.items) > 1:
                done = f"{completed}[{item.first}:{item.end}] = [True] * {item.end - item.first}; {fewer} = True"
        else:
            region.add(inside, f"if not {some} or not {completed}[{item.first}]:")
            inside += 1
            children[item.first] = region.child(item, inside, level + 1, running=f"{running} = True")
            if isinstance(item.child, Resumed):
                region.add(inside, "if r is None: pass", f"elif r is True: {done}")
                done = ""
        region.add(
            inside,
            *([f"if r is True: {done}"] if done else []),
            f"elif r == 2: {running} = True",
            "elif r is False: break",
            f"else: {skipped} = True",
        )
    region.add(
        depth + 1,
        f"if {running}:",
        " r = 2",
        f" if {fewer}: S[{at + 1}] = None",
        "else:",
        f" if {skipped}: halt_part(S, L[{number}], False)",
        f" elif {some} or {fewer}: S[{at}], S[{at + 1}] = [False] * {count}, False",
        " r = True",
        "break",
    )
    region.add(depth, f"if r is False: end_parallel(S, L[{number}])")
    return own


def end_parallel(slots: Slots, layout: Layout) -> None:
    """Halt the children of a Parallel, one of which has failed."""
    fault = slots[0].fault
    halt_part(slots, layout, False)
    slots[0].fault = fault


def _halt_parallel(slots: Slots, at: int, children: Layouts, keep: bool) -> None:
    completed = slots[at]
    for position, child in children.items():
        if child[0] is halt_row or child[0] is halt_leaves or not completed[position]:
            halt_part(slots, child, keep)
    if not keep:
        slots[at] = [False] * len(completed)
    slots[at + 1] = None


TEMPLATES: dict[str, Emit] = {
    "Sequence": partial(in_order, passes=SUCCESS),
    "Fallback": partial(in_order, passes=FAILURE),
    "ReactiveSequence": partial(reactive, passes=SUCCESS),
    "ReactiveFallback": partial(reactive, passes=FAILURE),
    "Parallel": parallel,
    "IfThenElse": if_then_else,
    "WhileDoElse": while_do_else,
    "Inverter": inverter,
    "ForceSuccess": partial(other_status, line="if r is False: r = True"),
    "ForceFailure": force_failure,
    "Repeat": partial(rounds, again=SUCCESS),
    "RetryUntilSuccessful": partial(rounds, again=FAILURE),
    "Timeout": timeout,
    "SubTree": subtree,
    "KeepRunningUntilFailure": partial(other_status, line="if r is not False: r = 2"),
}
"""The template of each node that has one, by its id. None of them reads the blackboard."""
NAMES: dict[str, Any] = {
    "__builtins__": {},
    "AGAIN": AGAIN,
    **{
        each.__name__: each
        for each in (
            begins_pause, caught, caught_at, caught_in, complete_rounds, end_parallel, end_reactive, end_rounds,
            end_timeout, end_undecided, find_status, halt_part, is_pausing, join_functions, join_leaves, leave_branch,
            order_functions, react_functions, skip, skip_branch,
        )
    },
}  # fmt: skip
"""All that generated code knows."""
