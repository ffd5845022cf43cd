"""The closures that expressions of scripts are compiled to: each takes a blackboard and returns a value.

A value within a script is a float, a text, or anything else that a leaf wrote, which can only be passed on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.script import values
from btlang.engine.script.values import COMPARISONS, ScriptFailed, comparable, from_stored, number, to_stored

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.script.values import Enums

    Run: TypeAlias = Callable[[Blackboard], Any]

_PREFIX: dict[str, Callable[[Any], float]] = {
    "-": values.negate,
    "!": values.logical_not,
    "~": values.complement,
}
_INFIX: dict[str, Callable[[Any, Any], Any]] = {
    "+": values.plus,
    "-": values.minus,
    "*": values.times,
    "/": values.divide,
    "..": values.concat,
    "&": values.bit_and,
    "|": values.bit_or,
    "^": values.bit_xor,
    "&&": values.logic_and,
    "||": values.logic_or,
}


def constant(value: Any) -> Run:
    return lambda board: value


def name(key: str) -> Run:
    def run(board: Blackboard) -> Any:
        try:
            return from_stored(board.get(key))
        except KeyError:
            raise ScriptFailed(f"{{{key}}} has no value") from None

    return run


def prefix(sign: str, operand: Run) -> Run:
    apply = _PREFIX[sign]
    return lambda board: apply(operand(board))


def infix(sign: str, left: Run, right: Run) -> Run:
    """Evaluate both sides always, even those of && and ||, as in C++."""
    apply = _INFIX[sign]
    return lambda board: apply(left(board), right(board))


def comparison(signs: Sequence[str], operands: Sequence[Run], enums: Enums) -> Run:
    """Evaluate `a < b < c`, which holds if both do. What follows the first that doesn't hold isn't evaluated."""
    first, *others = operands
    steps = [(sign, COMPARISONS[sign], operand) for sign, operand in zip(signs, others, strict=True)]

    def run(board: Blackboard) -> float:
        left = first(board)
        for sign, holds, operand in steps:
            right = operand(board)
            if left.__class__ is float is right.__class__:
                if not holds(left, right):
                    return 0.0
            elif not holds(*comparable(sign, left, right, enums)):
                return 0.0
            left = right
        return 1.0

    return run


def choice(enums: Enums, condition: Run, then: Run, otherwise: Run) -> Run:
    return lambda board: then(board) if number(condition(board), enums) else otherwise(board)


def assignment(enums: Enums, sign: str, key: str, right: Run) -> Run:
    """Write and return the value. An entry that exists keeps its kind: a number stays one, and a text a text."""
    if sign == ":=" or sign == "=":
        return _assignment(enums, key, right, sign == ":=")
    apply = _INFIX[sign[0]]

    def run(board: Blackboard) -> Any:
        _need(board, key, sign)
        value = right(board)
        value = apply(from_stored(board.get(key)), value)
        board.set(key, to_stored(value))
        return value

    return run


def _assignment(enums: Enums, key: str, right: Run, creates: bool) -> Run:
    def run(board: Blackboard) -> Any:
        if not creates:
            _need(board, key, "=")
        value = right(board)
        if key in board:
            value = _of_kind(from_stored(board.get(key)), value, key, enums)
        board.set(key, to_stored(value))
        return value

    return run


def _of_kind(old: Any, value: Any, key: str, enums: Enums) -> Any:
    if old is None or old.__class__ is value.__class__:
        return value
    try:
        if old.__class__ is float and value.__class__ is str:
            return number(value, enums)
    except ScriptFailed:
        pass  # the message below says more
    raise ScriptFailed(f"{{{key}}} holds {values.describe_value(old)} and cannot become {values.describe_value(value)}")


def _need(board: Blackboard, key: str, sign: str) -> None:
    if key not in board:
        raise ScriptFailed(f"{{{key}}} has no value for {sign} to change; create it with :=")
