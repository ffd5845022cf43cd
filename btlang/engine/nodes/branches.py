"""Nodes that choose between their children: IfThenElse, WhileDoElse, Switch2 to Switch6 and TryCatch.

They follow if_then_else_node.cpp, while_do_else_node.cpp, switch_node.cpp and try_catch_node.cpp of BehaviorTree.CPP
4.10, with these differences:
- where IfThenElse and WhileDoElse raise an exception there because the condition was SKIPPED, they fail here, and so
  they do if the answer isn't known;
- what `catch_on_halt` of a TryCatch starts doesn't run on an emergency stop, nor if the sequence was SKIPPED, and a
  suspension is no halt.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from btlang.engine.instance import Fault, NodeInstance, blackboard_key, split_children
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import TRUTHS, choice_port
from btlang.engine.script.values import as_text
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.tree.catalogue import CATALOGUE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


NO_ANSWER = "its condition was skipped"
"""The reason of an IfThenElse or WhileDoElse whose condition decides nothing."""
NO_BRANCH = "its condition was false, and it has no other branch"
"""The reason of one that has only two children."""
_SAME = 2.0**-23  # as in scripts


def if_then_else(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Ask the condition once, then tick the second child, or the third (without one: FAILURE), until it completes."""
    ticks, halts = split_children(children)
    state = instance.state
    position = 0  # 0 the condition, then the branch that was chosen

    def tick() -> int:
        nonlocal position
        fault, unknowns = state.fault, state.unknowns
        if position == 0:
            status = ticks[0]()
            if status == SUCCESS:
                position = 1
            elif status == FAILURE and instance.not_known(unknowns):
                return FAILURE
            elif status == FAILURE and len(ticks) == 3:
                position = 2
            elif status == SKIPPED:
                halts[0](False)
                return instance.fail(NO_ANSWER)
            else:
                return instance.pass_on(NO_BRANCH) if status == FAILURE else status
        status = ticks[position]()
        if status != RUNNING:
            if status == SKIPPED:
                halts[position](False)
                state.fault = fault
            position = 0
        return status

    def halt(keep: bool) -> None:
        nonlocal position
        halts[position](keep)
        if not keep:
            position = 0

    return tick, halt


def while_do_else(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Ask the condition at every tick and tick the second child, or the third (without one: FAILURE).

    When the answer changes, the other branch is halted first. A condition that is itself RUNNING leaves the branch as
    it is; one that is an action interrupts it (see control.py).
    """
    ticks, halts = split_children(children)
    state = instance.state
    interrupts = state.interrupts
    branch = 0  # the branch that was RUNNING at the last tick, 0 none

    def interrupt() -> None:
        nonlocal branch
        child, branch = branch, 0
        halts[child](False)

    def tick() -> int:
        nonlocal branch
        fault, unknowns = state.fault, state.unknowns
        if branch:
            interrupts.append(interrupt)
        status = ticks[0]()
        if branch:
            interrupts.pop()
        if status == RUNNING:
            return RUNNING
        not_known = status == FAILURE and instance.not_known(unknowns)
        chosen = 1 if status == SUCCESS else 2
        if branch and (branch != chosen or status == SKIPPED or not_known):
            interrupt()
        if not_known:
            return FAILURE
        if status == SKIPPED:
            halts[0](False)
            return instance.fail(NO_ANSWER)
        if chosen == len(ticks):
            return instance.pass_on(NO_BRANCH)
        status = ticks[chosen]()
        if status == SKIPPED:
            halts[chosen](False)
            state.fault = fault
        branch = chosen if status == RUNNING else 0
        return status

    def halt(keep: bool) -> None:
        nonlocal branch
        if branch:  # to halt the condition may start what cleans up after it
            interrupts.append(interrupt)
        halts[0](keep)
        if branch:
            interrupts.pop()
        for stop in halts[1:]:
            stop(keep)
        if not keep:
            branch = 0

    return tick, halt


def switch(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick the child of the first case that equals the variable, the last child if none does.

    It asks at every tick, and halts a running child whose case is no longer the one. A variable or case under a key
    without a value equals nothing. Texts are equal, or numbers and enums no further apart than in scripts.
    """
    ticks, halts = split_children(children)
    cases = len(ticks) - 1
    variable, *cases_of = [_text(instance, port) for port in CATALOGUE[instance.node.id].ports]
    values = tuple(cases_of)
    enums = instance.state.enums
    running = -1  # the child that was RUNNING at the last tick

    def chosen() -> int:
        wanted = variable()
        if wanted is not None:
            for index, value in enumerate(values):
                case = value()
                if case is not None and _equal(wanted, case, enums):
                    return index
        return cases

    def tick() -> int:
        nonlocal running
        child = chosen()
        if running not in (-1, child):
            halts[running](False)
        running = -1
        status = ticks[child]()
        if status == RUNNING:
            running = child
        elif status != SKIPPED:
            for stop in halts:  # others may have been skipped before, and keep a count
                stop(False)
        return status

    def halt(keep: bool) -> None:
        nonlocal running
        for stop in halts:
            stop(keep)
        if not keep:
            running = -1

    return tick, halt


def _text(instance: NodeInstance, port: str) -> Callable[[], str | None]:
    text = next((text for name, text in instance.node.ports if name == port), None)
    if text is None:
        return lambda: None
    key = blackboard_key(port, text)
    if key is None:
        return lambda: text

    def stored() -> str | None:
        try:
            return as_text(instance.scope.get(key))
        except KeyError:
            return None

    return stored


def _equal(left: str, right: str, enums: Mapping[str, float]) -> bool:
    if left == right:
        return True
    one, other = _number(left, enums), _number(right, enums)
    return one is not None and other is not None and abs(one - other) <= _SAME


def _number(text: str, enums: Mapping[str, float]) -> float | None:
    if text in enums:
        return enums[text]
    try:
        return float(text if "_" not in text else "")
    except ValueError:
        return None


def try_catch(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run all children but the last as a Sequence. When it fails, run the last one to its end; then FAILURE.

    With catch_on_halt="true" the last child is also ticked once, and halted where it is RUNNING, after a halt has
    stopped the sequence. The recorded failure is that of the sequence, whatever the last child does.
    """
    ticks, halts = split_children(children)
    last = len(ticks) - 1
    state = instance.state
    catch_on_halt = choice_port(instance, "catch_on_halt", TRUTHS)
    index = skipped = 0
    trying = catching = False
    cause = state.fault

    def tick() -> int:
        nonlocal index, skipped, trying, catching, cause
        trying = not catching
        while trying:
            status = ticks[index]()
            if status == RUNNING:
                return RUNNING
            if status == FAILURE:
                trying, catching, cause = False, True, state.fault
                break
            if status == SKIPPED:
                halts[index](False)
                skipped += 1
            index += 1
            if index == last:
                result = SKIPPED if skipped == last else SUCCESS
                index = skipped = 0
                trying = False
                return result
        status = ticks[last]()
        if status == RUNNING:
            return RUNNING
        if status == SKIPPED:
            halts[last](False)
        index = skipped = 0
        catching = False
        state.fault = cause
        return FAILURE

    def halt(keep: bool) -> None:
        nonlocal index, skipped, trying, catching
        halts[last if catching else index](keep)
        if keep:
            return
        index = skipped = 0
        if trying:
            trying = False  # first of all: no other halt, also one that an exception brings, comes here again
            if not state.emergency and wanted():
                catching = True
                clean_up()
                halts[last](False)
        catching = False

    def wanted() -> bool:
        try:
            return catch_on_halt()
        except ActionFailed as failed:
            state.halt_faults.append(Fault(instance.index, str(failed), failed))
            return False

    def clean_up() -> None:
        before, state.fault = state.fault, None  # why somebody halts it stays the latest failure
        failed = ticks[last]() == FAILURE
        fault, state.fault = state.fault, before
        if failed and fault is not None and fault.reason:
            state.halt_faults.append(Fault(fault.index, f"cleaning up failed: {fault.reason}", fault.exception))

    return tick, halt
