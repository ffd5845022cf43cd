"""Values of scripts, which are doubles and texts, and what the operators do with them.

Names as in operators.hpp of BehaviorTree.CPP 4.10. All functions raise ScriptFailed where the values do not fit.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from math import copysign, inf, nan

from btlang.engine.blackboard import check_length
from btlang.engine.leaves.leaf import ActionFailed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Enums: TypeAlias = "dict[str, float]"

_SAME = 2.0**-23  # numbers that are no further apart are equal there: the epsilon of a C++ float
_EXACT = 2.0**53  # below it a double holds every whole number
_WHOLE = re.compile(r"-?[0-9]+")
_LONGEST = 1000  # characters of a whole number, zeros in front included: Python reads 4300 at most
_DECIMAL = re.compile(r"-?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


class ScriptFailed(ActionFailed):
    """An error because a script can't go on with the values that it found; the message is for people."""


def from_stored(value: Any) -> Any:
    """Return a value from the blackboard as scripts compute with it: a real number as a float, all else as it is."""
    kind = value.__class__
    if kind is float or kind is str:
        return value
    if kind is not int and kind is not bool:
        from numbers import Real  # numbers of other libraries, such as numpy's, are registered with it

        if not isinstance(value, Real):
            return value
    try:
        return float(value)
    except OverflowError:
        raise ScriptFailed("a number of more than 308 digits is too large for a script") from None


def to_stored(value: Any) -> Any:
    """Return a value as it is written to the blackboard: a whole number as an int, so that leaves show and count with
    3.
    """
    if value.__class__ is float and -_EXACT < value < _EXACT and value == (whole := int(value)):
        return whole
    return value


def as_text(value: Any) -> str:
    """Return a value as people read it: a whole number as `3`, any other with at most six decimals: `0.5`."""
    number = from_stored(value)
    return str(to_stored(round(number, 6) if isinstance(number, float) else number))


def as_whole(value: str | float) -> int:
    """Return a whole number, also one that is written `2.0`. Raises ValueError for a fraction."""
    number = float(value)
    if not number.is_integer():
        raise ValueError("a whole number is needed")
    return int(number)


def literal(text: str) -> int | float | str:
    """Return a constant in a port of a SubTree as 4.9 and later read it: a whole number of 64 bits, a double, or a
    text.
    """
    if len(text) <= _LONGEST and _WHOLE.fullmatch(text) and -(2**63) <= (whole := int(text)) < 2**63:
        return whole
    return float(text) if _DECIMAL.fullmatch(text) and abs(float(text)) < inf else text


# Unary operators


def negate(value: Any) -> float:
    if value.__class__ is not float:
        raise _only_numbers("-", value)
    return -value


def logical_not(value: Any) -> float:
    if value.__class__ is not float:
        raise _only_numbers("!", value)
    return 0.0 if value else 1.0


def complement(value: Any) -> float:
    """Complement a whole number. A fraction is cut off first."""
    if value.__class__ is not float:
        raise _only_numbers("~", value)
    if not -(2.0**63) <= value < 2.0**63:
        raise ScriptFailed(f"~ takes a number of 64 bits, not {as_text(value)}")
    return float(~int(value))


# Binary operators


def plus(left: Any, right: Any) -> Any:
    if left.__class__ is right.__class__ and (left.__class__ is float or left.__class__ is str):
        total = left + right
        return check_length(total) if total.__class__ is str else total
    raise _wrong_operands("+", "two numbers or two texts", left, right)


def minus(left: Any, right: Any) -> float:
    if left.__class__ is float and right.__class__ is float:
        return left - right
    raise _wrong_operands("-", "two numbers", left, right)


def times(left: Any, right: Any) -> float:
    if left.__class__ is float and right.__class__ is float:
        return left * right
    raise _wrong_operands("*", "two numbers", left, right)


def divide(left: Any, right: Any) -> float:
    """Divide as doubles: by zero that is inf, -inf or nan."""
    if left.__class__ is not float or right.__class__ is not float:
        raise _wrong_operands("/", "two numbers", left, right)
    if right:
        return left / right
    return copysign(inf, left) * copysign(1.0, right) if left and left == left else nan


def concat(left: Any, right: Any) -> str:
    if left.__class__ is str:
        if right.__class__ is str:
            return check_length(left + right)
        if right.__class__ is float:
            return check_length(left + as_text(right))
    elif left.__class__ is float and right.__class__ is str:
        return check_length(as_text(left) + right)
    raise _wrong_operands("..", "two texts, or a text and a number", left, right)


def bit_and(left: Any, right: Any) -> float:
    return float(_integer("&", left, right) & _integer("&", right, left))


def bit_or(left: Any, right: Any) -> float:
    return float(_integer("|", left, right) | _integer("|", right, left))


def bit_xor(left: Any, right: Any) -> float:
    return float(_integer("^", left, right) ^ _integer("^", right, left))


def logic_and(left: Any, right: Any) -> float:
    if left.__class__ is float and right.__class__ is float:
        return 1.0 if left and right else 0.0
    raise _wrong_operands("&&", "two numbers", left, right)


def logic_or(left: Any, right: Any) -> float:
    if left.__class__ is float and right.__class__ is float:
        return 1.0 if left or right else 0.0
    raise _wrong_operands("||", "two numbers", left, right)


# Comparisons


def _same(left: Any, right: Any) -> bool:
    return bool(left == right) if left.__class__ is str else abs(left - right) <= _SAME


# Written as there, which matters for nan: less, for one, fails only if left >= right.
COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "==": _same,
    "!=": lambda left, right: not _same(left, right),
    "<": lambda left, right: not left >= right,
    ">": lambda left, right: not left <= right,
    "<=": lambda left, right: not left > right,
    ">=": lambda left, right: not left < right,
}


def comparable(sign: str, left: Any, right: Any, enums: Enums) -> tuple[Any, Any]:
    """Return two numbers or two texts; of a number and a text, the text as a number."""
    if left.__class__ is float and right.__class__ is str:
        return left, number(right, enums)
    if left.__class__ is str and right.__class__ is float:
        return number(left, enums), right
    if left.__class__ is right.__class__ and (left.__class__ is float or left.__class__ is str):
        return left, right
    raise _wrong_operands(sign, "numbers and texts", left, right)


# What values stand for


def number(value: Any, enums: Enums) -> float:
    """Return a number, or the one that a text stands for: `true`, `false`, the name of an enum, or digits."""
    if value.__class__ is float:
        return value
    if value.__class__ is not str:
        raise ScriptFailed(f"{describe_value(value)} isn't a number")
    if value in ("true", "false"):
        return float(value == "true")
    if value in enums:
        return enums[value]
    try:
        return float(value if "_" not in value else "")
    except ValueError:
        raise ScriptFailed(f"the text {value!r} isn't a number") from None


def truth(value: Any) -> bool:
    """Whether a script's result is true: any number but 0. A text raises ScriptFailed."""
    if value.__class__ is float:
        return value != 0
    raise ScriptFailed(f"{describe_value(value)} is neither true nor false")


def describe_value(value: Any) -> str:
    """Describe a value for a message."""
    if value.__class__ is float:
        return as_text(value)
    return f"the text {value!r}" if value.__class__ is str else f"a value of type {type(value).__name__}"


def _integer(sign: str, value: Any, other: Any) -> int:
    if value.__class__ is not float or other.__class__ is not float:
        raise _wrong_operands(sign, "two whole numbers", value, other)
    if not -(2.0**63) <= value < 2.0**63 or value != int(value):
        raise ScriptFailed(f"{sign} takes whole numbers of 64 bits, not {as_text(value)}")
    return int(value)


def _only_numbers(sign: str, value: Any) -> ScriptFailed:
    return ScriptFailed(f"{sign} takes a number, not {describe_value(value)}")


def _wrong_operands(sign: str, wanted: str, left: Any, right: Any) -> ScriptFailed:
    return ScriptFailed(f"{sign} takes {wanted}, not {describe_value(left)} and {describe_value(right)}")
