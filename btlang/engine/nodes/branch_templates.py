"""What nodes that choose between their children do, as templates of generated functions; see templates.py."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from btlang.engine.nodes.branches import NO_ANSWER, NO_BRANCH
from btlang.engine.regions import halt_part
from btlang.engine.status import FAILURE, RUNNING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Fault, NodeInstance
    from btlang.engine.regions import Fragment, Layout, Region, Slots


def _begin(region: Region, instance: NodeInstance, halt: Callable[..., None], **memory: int) -> tuple[Layout, int]:
    """Give a node the slots of what it remembers and of itself; return its layout, still without children, and the
    number of that.
    """
    at = region.remember(instance, **memory)
    region.slot(instance)
    children: list[Layout] = []
    layout: Layout = halt, at, children
    return layout, region.layout(layout)


def if_then_else(region: Region, node: Fragment, depth: int, level: int) -> Layout:
    """Write an IfThenElse."""
    condition, *branches = node.singles
    own, number = _begin(region, node.instance, _halt_chosen, position=0)
    _, at, children = own
    fault, unknowns = f"e{level}", f"u{level}"
    region.add(depth, f"{fault} = S[0].fault", f"if not S[{at}]:", f" {unknowns} = S[0].unknowns")
    children.append(region.child(condition, depth + 1, level + 1))
    region.add(depth + 1, f"if r is True: S[{at}] = 1")
    if len(branches) == 2:
        region.add(depth + 1, f"elif r is False and S[0].unknowns == {unknowns}: S[{at}] = 2")
    region.add(depth + 1, f"else: r = end_undecided(S, L[{number}], r, {unknowns})")
    for chosen, branch in enumerate(branches, 1):
        region.add(depth, f"{'if' if chosen == 1 else 'elif'} S[{at}] == {chosen}:")
        children.append(region.child(branch, depth + 1, level + 1))
        region.add(depth + 1, "if r != 2:", f" if r == 3: skip_branch(S, L[{number}], {chosen}, {fault})")
        region.add(depth + 2, f"S[{at}] = 0")
    return own


def while_do_else(region: Region, node: Fragment, depth: int, level: int) -> Layout:
    """Write a WhileDoElse."""
    condition, *branches = node.singles
    own, number = _begin(region, node.instance, _halt_while, branch=0)
    _, at, children = own
    stop = region.slot(None)
    fault, unknowns = f"e{level}", f"u{level}"
    region.add(depth, f"{fault} = S[0].fault", f"{unknowns} = S[0].unknowns")
    if not isinstance(condition.child, list):  # a function starts nothing under the condition
        region.values[stop] = partial(leave_branch, region.values, own)
        region.add(depth, f"if S[{at}]: S[0].interrupts.append(S[{stop}])")
    children.append(region.child(condition, depth, level + 1))
    if not isinstance(condition.child, list):
        region.add(depth, f"if S[{at}]: S[0].interrupts.pop()")
    for chosen, branch in enumerate(branches, 1):
        region.add(depth, "if r is True:" if chosen == 1 else f"elif r is False and S[0].unknowns == {unknowns}:")
        if len(branches) == 2:
            region.add(depth + 1, f"if S[{at}] == {3 - chosen}: leave_branch(S, L[{number}])")
        children.append(region.child(branch, depth + 1, level + 1))
        region.add(depth + 1, f"if r == 2: S[{at}] = {chosen}", "else:")
        region.add(depth + 2, f"if r == 3: skip_branch(S, L[{number}], {chosen}, {fault})", f"S[{at}] = 0")
    region.add(depth, f"else: r = end_undecided(S, L[{number}], r, {unknowns})")
    return own


def end_undecided(slots: Slots, layout: Layout, status: int, unknowns: int) -> int:
    """Return the status of an IfThenElse or WhileDoElse whose condition had this one, and chose no branch."""
    if status == RUNNING:
        return RUNNING
    _, at, children = layout
    instance: NodeInstance = slots[at + 1]
    not_known = status == FAILURE and instance.not_known(unknowns)
    leave_branch(slots, layout)
    if not_known:
        return FAILURE
    if status == FAILURE:
        return instance.pass_on(NO_BRANCH)
    halt_part(slots, children[0], False)
    return instance.fail(NO_ANSWER)


def leave_branch(slots: Slots, layout: Layout) -> None:
    """Halt the branch of a WhileDoElse that was RUNNING, if there is one."""
    _, at, children = layout
    branch, slots[at] = slots[at], 0
    if branch:
        halt_part(slots, children[branch], False)


def skip_branch(slots: Slots, layout: Layout, branch: int, fault: Fault | NodeInstance | None) -> None:
    """Halt a branch that was SKIPPED; what failed latest is what had failed before the condition."""
    halt_part(slots, layout[2][branch], False)
    slots[0].fault = fault


def _halt_chosen(slots: Slots, at: int, children: list[Layout], keep: bool) -> None:
    halt_part(slots, children[slots[at]], keep)
    if not keep:
        slots[at] = 0


def _halt_while(slots: Slots, at: int, children: list[Layout], keep: bool) -> None:
    interrupts, stop = slots[0].interrupts, slots[at + 2]
    if slots[at] and stop is not None:  # to halt the condition may start what cleans up after it
        interrupts.append(stop)
    halt_part(slots, children[0], keep)
    if slots[at] and stop is not None:
        interrupts.pop()
    for branch in children[1:]:
        halt_part(slots, branch, keep)
    if not keep:
        slots[at] = 0
