"""What nodes with one child do, as templates of generated functions; see templates.py."""

from __future__ import annotations

from btlang.engine.instance import Fault
from btlang.engine.nodes.decorators import NOT_THIS_TIME, WAS_TRUE, fail_attempts, pass_on_round, pause_after
from btlang.engine.nodes.timed import Stopwatch, fail_late
from btlang.engine.regions import halt_part
from btlang.engine.status import FAILURE, SKIPPED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.regions import Fragment, Layout, Region, Slots


def inverter(region: Region, node: Fragment, depth: int, level: int) -> Layout:
    """Write an Inverter."""
    region.remember(node.instance)
    at = region.slot(Fault(node.instance.index, WAS_TRUE))
    region.add(depth, f"u{level} = S[0].unknowns")
    layout = region.child(node.items[0], depth, level + 1)
    region.add(
        depth,
        "if r is True:",
        f" S[0].fault = S[{at}]",
        " r = False",
        "elif r is False:",
        f" if S[0].unknowns == u{level}: r = True",
        " else: S[0].fault = S[0].unknown",
    )
    return layout


def other_status(region: Region, node: Fragment, depth: int, level: int, line: str) -> Layout:
    """Write a node that only makes another status of its child's, by a line."""
    region.remember(node.instance)
    layout = region.child(node.items[0], depth, level + 1)
    region.add(depth, line)
    return layout


def force_failure(region: Region, node: Fragment, depth: int, level: int) -> Layout:
    """Write a ForceFailure."""
    region.remember(node.instance)
    at = region.slot(Fault(node.instance.index, NOT_THIS_TIME))
    layout = region.child(node.items[0], depth, level + 1)
    region.add(depth, f"if r is True: S[0].fault, r = S[{at}], False")
    return layout


def subtree(region: Region, node: Fragment, depth: int, level: int) -> Layout:
    """Write a SubTree."""
    return region.child(node.items[0], depth, level)


def rounds(region: Region, node: Fragment, depth: int, level: int, again: int) -> Layout:
    """Write a Repeat or RetryUntilSuccessful, which begins another round at the status `again`."""
    instance = node.instance
    most = instance.number("num_cycles" if again else "num_attempts")()
    pauses = again is FAILURE and most != -1
    limit = region.slot(most)
    region.slot(instance)
    own_pause = {"pause": Stopwatch(instance.state.clock), "msec": 0.0} if pauses else {}
    at = region.remember(instance, count=0, waiting=False, **own_pause)
    children: list[Layout] = []
    own = _halt_attempts if pauses else _halt_rounds, at, children
    number = region.layout(own)
    if pauses:
        region.add(depth, f"if S[{at + 3}] and is_pausing(S, {at}): r = 2", "else:")
        depth += 1
    resumed, is_next = f"q{level}", "True" if most == -1 else f"S[{at}] < S[{limit}]"
    region.add(depth, f"{resumed} = S[{at + 1}]", f"if {resumed}: S[{at + 1}] = False", f"while {is_next}:")
    children.append(region.child(node.items[0], depth + 1, level + 1))
    region.add(
        depth + 1,
        f"if r is not {again}:",
        f" if r == 2: S[{at + 1}] = True",
        f" else: r = end_rounds(S, L[{number}], r)",
        " break",
        f"S[{at}] += 1",
        *([f"if {is_next} and begins_pause(S, {at}): r = 2; break"] if pauses else []),
        f"if not {resumed} and {is_next}: r = 2; break",
        f"{resumed} = False",
    )
    if most != -1:
        region.add(depth, f"else: r = complete_rounds(S, {at}, {again})")
    return own


def end_rounds(slots: Slots, layout: Layout, status: int) -> int:
    """Return the status of a Repeat or RetryUntilSuccessful whose child ended the rounds, or was SKIPPED."""
    _, at, [child] = layout
    if status == SKIPPED:
        halt_part(slots, child, False)
        return status
    if slots[at] and status == FAILURE:
        pass_on_round(slots[at - 1], slots[at], slots[at - 2])
    slots[at] = 0
    return status


def complete_rounds(slots: Slots, at: int, again: int) -> int:
    """Return the status of a Repeat or RetryUntilSuccessful after its last round."""
    if again is FAILURE:
        fail_attempts(slots[at - 1], slots[at])
    slots[at] = 0
    return again


def begins_pause(slots: Slots, at: int) -> bool:
    """Begin the pause after an attempt that failed for what isn't there; return whether there is one."""
    if not slots[at - 1].is_not_there():
        return False
    msec = slots[at + 3] = pause_after(slots[at])
    slots[at + 2].reached(msec)
    slots[at + 2].wait(msec)
    return True


def is_pausing(slots: Slots, at: int) -> bool:
    """Return whether the pause between two attempts goes on."""
    pause, msec = slots[at + 2], slots[at + 3]
    if not pause.reached(msec):
        pause.wait(msec)
        return True
    pause.halt(False)
    slots[at + 3] = 0.0
    return False


def _halt_rounds(slots: Slots, at: int, children: list[Layout], keep: bool) -> None:
    halt_part(slots, children[0], keep)
    if not keep:
        slots[at], slots[at + 1] = 0, False


def _halt_attempts(slots: Slots, at: int, children: list[Layout], keep: bool) -> None:
    _halt_rounds(slots, at, children, keep)
    slots[at + 2].halt(keep)
    if not keep:
        slots[at + 3] = 0.0


def timeout(region: Region, node: Fragment, depth: int, level: int) -> Layout:
    """Write a Timeout."""
    instance = node.instance
    msec = instance.number("msec")()
    limit = region.slot(msec)
    region.slot(instance)
    at = region.remember(instance, stopwatch=Stopwatch(instance.state.clock))
    if not msec:
        return region.child(node.items[0], depth, level + 1)
    children: list[Layout] = []
    own = _halt_timeout, at, children
    region.add(depth, f"if S[{at}].reached(S[{limit}]): r = end_timeout(S, L[{region.layout(own)}])", "else:")
    children.append(region.child(node.items[0], depth + 1, level + 1))
    region.add(depth + 1, f"if r == 2: S[{at}].wait(S[{limit}])", f"else: S[{at}].halt(False)")
    return own


def end_timeout(slots: Slots, layout: Layout) -> int:
    """Halt a Timeout whose time is over; return FAILURE."""
    halt_part(slots, layout, False)
    return fail_late(slots[layout[1] - 1], slots[layout[1] - 2])


def _halt_timeout(slots: Slots, at: int, children: list[Layout], keep: bool) -> None:
    halt_part(slots, children[0], keep)
    slots[at].halt(keep)
