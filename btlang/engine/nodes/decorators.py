"""Nodes that change the status of their one child, or run it several times, as decorators/ of BehaviorTree.CPP 4.10.

Differences in LoopInt, LoopBool, LoopDouble and LoopString (loop_node.h): a list on the blackboard is a queue too, a
text there becomes one, and values that aren't texts are passed on as they are.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Sequence

from btlang.engine.instance import NodeInstance, blackboard_key
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import STATUSES, TRUTHS, choice_port
from btlang.engine.nodes.timed import Stopwatch
from btlang.engine.script.values import to_stored
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled

    Next = Callable[[], list[Any]]

_JSON = "json:"
_FIRST_PAUSE, _LONGEST_PAUSE = 500.0, 8000.0  # milliseconds
WAS_TRUE = "it is true"
"""The reason of an Inverter: what it denies succeeded."""
NOT_THIS_TIME = "it turns success into failure"
"""The reason of a ForceFailure."""
_IF_EMPTY = {name: status for name, status in STATUSES.items() if status != RUNNING}


def inverter(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return SUCCESS for FAILURE and the other way round (inverter_node.cpp). What isn't known stays a FAILURE."""
    [(child, halt)] = children
    state = instance.state

    def tick() -> int:
        unknowns = state.unknowns
        status = child()
        if status == SUCCESS:
            return instance.fail(WAS_TRUE)
        return SUCCESS if status == FAILURE and not instance.not_known(unknowns) else status

    return tick, halt


def force_success(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return SUCCESS for FAILURE (force_success_node.h)."""
    [(child, halt)] = children

    def tick() -> int:
        status = child()
        return SUCCESS if status == FAILURE else status

    return tick, halt


def force_failure(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Return FAILURE for SUCCESS (force_failure_node.h)."""
    [(child, halt)] = children

    def tick() -> int:
        status = child()
        return instance.fail(NOT_THIS_TIME) if status == SUCCESS else status

    return tick, halt


def repeat(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its child num_cycles times (-1: for ever) or until it fails (repeat_node.cpp)."""
    return _rounds(instance, children, instance.number("num_cycles"), SUCCESS)


def retry_until_successful(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run its child until it succeeds, at most num_attempts times (-1: for ever) (retry_node.cpp)."""
    return _rounds(instance, children, instance.number("num_attempts"), FAILURE)


def _rounds(instance: NodeInstance, children: Sequence[Compiled], limit: Callable[[], int], again: int) -> Compiled:
    """Run another round at the status `again`, which is the result after the last round.

    After a round within one tick it returns RUNNING, so that an endless loop cannot block a tick. After a longer one
    the child starts again in the same tick. A SKIPPED child makes it SKIPPED without a change of the count.

    If what the child needs isn't there now (NotThere), some attempts would be over in a moment: each of them waits for
    longer than the one before.
    """
    [(child, halt_child)] = children
    count = 0
    waiting = False  # whether the child was RUNNING at the last tick
    pause = Stopwatch(instance.state.clock)
    msec = 0.0  # the length of the pause that goes on

    def tick() -> int:
        nonlocal count, waiting, msec
        if msec:
            if not pause.reached(msec):
                return pause.wait(msec)
            pause.halt(False)
            msec = 0.0
        most = limit()
        resumed, waiting = waiting, False
        while count < most or most == -1:
            status = child()
            if status == RUNNING:
                waiting = True
                return RUNNING
            if status == SKIPPED:
                halt_child(False)
                return SKIPPED
            if status != again:
                if count and status == FAILURE:
                    pass_on_round(instance, count, most)
                count = 0
                return status
            count += 1
            if again is FAILURE and count < most and instance.is_not_there():
                msec = pause_after(count)
                pause.reached(msec)
                return pause.wait(msec)
            if not resumed and (count < most or most == -1):
                return RUNNING
            resumed = False
        if again == FAILURE:
            fail_attempts(instance, count)
        count = 0
        return again

    def halt(keep: bool) -> None:
        nonlocal count, waiting, msec
        halt_child(keep)
        pause.halt(keep)
        if not keep:
            count = 0
            waiting = False
            msec = 0.0

    return tick, halt


def pass_on_round(instance: NodeInstance, count: int, most: int) -> None:
    """Record in which round a Repeat failed."""
    instance.pass_on(f"in round {count + 1}" if most == -1 else f"in round {count + 1} of {most}")


def fail_attempts(instance: NodeInstance, count: int) -> None:
    """Record that all attempts failed, if their number says more than the failure of the last one."""
    if count == 0:
        instance.fail("it allows no attempt")
    elif count > 1:
        instance.pass_on(f"{'both' if count == 2 else f'all {count}'} attempts failed")


def pause_after(attempts: int) -> float:
    """Return how many milliseconds to wait for what isn't there after so many attempts."""
    return min(_FIRST_PAUSE * 2.0 ** (attempts - 1), _LONGEST_PAUSE)


def loop_int(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run the child for each whole number."""
    return _loop(instance, children, int, "whole numbers")


def loop_bool(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run the child for each true, false, 1 and 0."""
    return _loop(instance, children, TRUTHS.__getitem__, "true and false")


def loop_double(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run the child for each number; a whole one is an int on the blackboard, as scripts write it."""
    return _loop(instance, children, lambda text: to_stored(float(text)), "numbers")


def loop_string(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Run the child for each text."""
    return _loop(instance, children, str, "texts")


def _loop(instance: NodeInstance, children: Sequence[Compiled], convert: Callable[[str], Any], sort: str) -> Compiled:
    """Take the first value off the queue, set the key in `value` to it and tick the child until it completes.

    RUNNING after each round, also a SKIPPED one; when the queue is empty, the status in `if_empty`. A child that fails
    ends it: FAILURE. A queue on the blackboard is taken apart there; that in a text `1;2;3` is whole again at the next
    start.
    """
    [(child, halt_child)] = children
    if_empty = choice_port(instance, "if_empty", _IF_EMPTY)
    scope, target = instance.scope, _target(instance)
    text = instance.node.port("queue")
    key = blackboard_key("queue", text)
    values = [] if key is not None else _constants(instance, text, convert, sort)
    stays = instance.parent_keeps_completed  # it does not reset a child that has completed
    queue = deque(values)  # its own, if there is none on the blackboard
    running = False  # whether the child was RUNNING at the last tick

    def reset() -> None:
        nonlocal running
        queue.clear()
        queue.extend(values)
        running = False

    def tick() -> int:
        nonlocal running
        if not running:
            left = queue if key is None else _find_queue(instance, key)
            if not left:
                status = if_empty()
                if status != SKIPPED and not stays:
                    reset()
                return instance.fail("its queue is empty") if status == FAILURE else status
            value = left.popleft() if isinstance(left, deque) else left.pop(0)
            if target:
                scope.set(target, _convert(value, convert, sort))
        status = child()
        running = status == RUNNING
        if status == FAILURE:
            reset()
            return FAILURE
        return RUNNING

    def halt(keep: bool) -> None:
        halt_child(keep)
        if not keep:
            reset()

    return tick, halt


def _target(instance: NodeInstance) -> str:
    text = instance.node.port("value")
    key = blackboard_key("value", text)
    if key is None and text:
        raise instance.error(f"value is an output: it must be a {{key}}, not {text!r}")
    return key or ""


def _constants(instance: NodeInstance, text: str, convert: Callable[[str], Any], sort: str) -> list[Any]:
    if not any(name == "queue" for name, _ in instance.node.ports):
        raise instance.error(f"{instance.node.id} needs a port queue")
    try:
        return [_convert(part, convert, sort) for part in _split(text)]
    except ActionFailed as problem:
        raise instance.error(str(problem)) from None


def _find_queue(instance: NodeInstance, key: str) -> Any:
    """Return the queue under the key itself and not a copy, so that its other holders see what is taken off."""
    try:
        found = instance.scope.get(key)
    except KeyError:
        return ()
    if isinstance(found, (deque, list)):
        return found
    if isinstance(found, str):
        found = _split(found)
    elif not isinstance(found, tuple):
        raise ActionFailed(f"{{{key}}} holds {found!r}, which isn't a queue")
    queue = deque(found)
    instance.scope.set(key, queue)
    return queue


def _split(text: str) -> list[str]:
    """Return the parts of a queue, `a;b` or `json:["a", "b"]`. Raises ActionFailed for other JSON."""
    if not text.startswith(_JSON):
        return text.removesuffix(";").split(";") if text else []
    try:
        found = json.loads(text.removeprefix(_JSON))
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, list) or any(isinstance(each, dict | list | None) for each in found):
        raise ActionFailed(f"the queue must be a list of values, such as json:[1, 2], not {text!r}")
    return [each if isinstance(each, str) else json.dumps(each) for each in found]


def _convert(value: Any, convert: Callable[[str], Any], sort: str) -> Any:
    if not isinstance(value, str):
        return value
    try:
        return convert(value)
    except (ValueError, KeyError):
        raise ActionFailed(f"the queue must hold {sort}, not {value!r}") from None
