"""Nodes that decide whether their one child runs, or runs again, and nodes that ask for news on the blackboard.

They follow decorators/*.h, updated_decorator.cpp and updated_action.cpp of BehaviorTree.CPP 4.10. When a node first
asks for news, an entry that has a value counts as new; setting the value that it has counts too. No halt makes a node
forget what it has seen. Differences:
- a Precondition whose child was SKIPPED or halted asks its condition again. There it remembers that the condition
  once held until the child completes;
- halting a decorator that asks for news halts its child; there the child is left alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.instance import NodeInstance, halt_nothing
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.built_in_leaves import refusal_text, script_port
from btlang.engine.nodes.ports import STATUSES, TRUTHS, choice_port, key_port
from btlang.engine.script.values import truth
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def keep_running_until_failure(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return RUNNING until its child fails: FAILURE (keep_running_until_failure_node.h). SKIPPED is RUNNING too."""
    [(child, halt)] = children

    def tick() -> int:
        return FAILURE if child() == FAILURE else RUNNING

    return tick, halt


def run_once(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its child until it completes, once for as long as the tree exists: no halt makes it run again.

    From then on SKIPPED, or with then_skip="false" the status of that one run (run_once_node.h).
    """
    [(child, halt)] = children
    then_skip = choice_port(instance, "then_skip", TRUTHS)
    result = IDLE
    state = instance.state
    fault = state.fault  # of that run

    def tick() -> int:
        nonlocal result, fault
        skips = then_skip()
        if result == IDLE:
            status = child()
            if status in (SUCCESS, FAILURE):
                result, fault = status, state.fault
            return status
        if skips:
            return SKIPPED
        if result == FAILURE:
            state.fault = fault
            return instance.pass_on("its one run had failed")
        return result

    return tick, halt


def precondition(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its child if the script `if` holds at the start, else return the status in `else` (script_precondition.h)."""
    condition, scope = script_port(instance, "if"), instance.scope
    refusal = refusal_text(instance, "if")
    otherwise = choice_port(instance, "else", STATUSES)

    def ask() -> int:
        try:
            holds = truth(condition(scope))
        except ActionFailed as failed:
            return instance.cannot_know(str(failed))
        if holds:
            return IDLE
        status = otherwise()
        return instance.fail(refusal) if status == FAILURE else status

    return guard_start(children, ask)


def guard_start(children: Sequence[Compiled], ask: Callable[[], int]) -> Compiled:
    """Run the one child if `ask` returns IDLE when it is to start; else return the status from `ask`."""
    [(child, halt_child)] = children
    running = False  # whether the child was RUNNING at the last tick

    def tick() -> int:
        nonlocal running
        if not running:
            status = ask()
            if status != IDLE:
                return status
        status = child()
        running = status == RUNNING
        return status

    def halt(keep: bool) -> None:
        nonlocal running
        halt_child(keep)
        if not keep:
            running = False

    return tick, halt


def skip_unless_updated(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its child if the entry is new, else return SKIPPED; a RUNNING child is ticked on without asking."""
    return guard_start(children, _EntryUpdates(instance, SKIPPED))


def wait_value_update(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return RUNNING until the entry is new, then run its child."""
    return guard_start(children, _EntryUpdates(instance, RUNNING))


def was_entry_updated(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return SUCCESS if the entry is new, else FAILURE."""
    news = _EntryUpdates(instance, FAILURE)
    refusal = f"nothing has been written to {{{key_port(instance, 'entry')}}} since the last check"
    return (lambda: SUCCESS if news() == IDLE else instance.fail(refusal)), halt_nothing


class _EntryUpdates:
    """A check of an entry: IDLE if it is new since the last call, else the status `otherwise`."""

    __slots__ = ("key", "otherwise", "scope", "seen")

    def __init__(self, instance: NodeInstance, otherwise: int) -> None:
        self.scope, self.key = instance.scope, key_port(instance, "entry")
        self.otherwise = otherwise
        self.seen = -1

    def __call__(self) -> int:
        before = self.seen
        if self.key in self.scope:
            self.seen = self.scope.writes(self.key)
        return IDLE if self.seen != before else self.otherwise

    def saved(self) -> int:
        """Return how often the entry had been set."""
        return self.seen

    def restore(self, seen: int) -> None:
        """Take back what `saved` returned."""
        self.seen = seen
