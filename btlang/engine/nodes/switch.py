"""Switch2 to Switch6: one child for each value of a variable; switch_node.h and switch_node.cpp of 4.10."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from btlang.engine.instance import NodeInstance, apart, blackboard_key
from btlang.engine.script.values import as_text
from btlang.engine.status import RUNNING, SKIPPED
from btlang.tree.catalogue import CATALOGUE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled

_SAME = 2.0**-23  # as in scripts


def switch(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Ticks the child of the first case that equals the variable, the last child where none does.

    It asks at every tick, and halts a running child whose case is no longer the one. A variable or case under a key
    without a value equals nothing. Texts are equal, or numbers and enums no further apart than in scripts.
    """
    ticks, halts = apart(children)
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
