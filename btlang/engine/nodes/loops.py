"""LoopInt, LoopBool, LoopDouble and LoopString: the child once for each value of a queue; loop_node.h of 4.10.

Differences: a list on the blackboard is a queue too, a text there becomes one, and values that are no texts are passed
on as they are.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

from btlang.engine.instance import NodeInstance, blackboard_key
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import STATUSES, TRUTHS, choice_port
from btlang.engine.script.values import kept
from btlang.engine.status import FAILURE, RUNNING, SKIPPED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled

    Next = Callable[[], list[Any]]

_IF_EMPTY = {name: status for name, status in STATUSES.items() if status != RUNNING}


def loop_int(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Whole numbers."""
    return _loop(instance, children, int, "whole numbers")


def loop_bool(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """true, false, 1 and 0."""
    return _loop(instance, children, TRUTHS.__getitem__, "true and false")


def loop_double(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Numbers; a whole one is an int on the blackboard, as scripts write it."""
    return _loop(instance, children, lambda text: kept(float(text)), "numbers")


def loop_string(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Texts."""
    return _loop(instance, children, str, "texts")


def _loop(instance: NodeInstance, children: Sequence[Compiled], convert: Callable[[str], Any], sort: str) -> Compiled:
    """Takes the first value off the queue, sets the key in `value` to it and ticks the child until it completes.

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
            left = queue if key is None else _stored(instance, key)
            if not left:
                status = if_empty()
                if status != SKIPPED and not stays:
                    reset()
                return instance.fail("its queue is empty") if status == FAILURE else status
            value = left.popleft() if isinstance(left, deque) else left.pop(0)
            if target:
                scope.set(target, _converted(value, convert, sort))
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
        return [_converted(part, convert, sort) for part in _split(text)]
    except ActionFailed as problem:
        raise instance.error(str(problem)) from None


def _stored(instance: NodeInstance, key: str) -> Any:
    """The queue under the key, itself and no copy, so that who else holds it sees what is taken off."""
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
    return text.removesuffix(";").split(";") if text else []


def _converted(value: Any, convert: Callable[[str], Any], sort: str) -> Any:
    if not isinstance(value, str):
        return value
    try:
        return convert(value)
    except (ValueError, KeyError):
        raise ActionFailed(f"the queue must hold {sort}, not {value!r}") from None
