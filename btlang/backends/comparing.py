"""A quantity as a condition: what its function gives is compared with the values of its ports, and may be kept.

Where it does not hold, what was read is the reason, in words that are looked for when somebody asks.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from inspect import Parameter, signature

from btlang.engine.leaves.leaf import Failed, Unknown
from btlang.vocabulary.entry import MEASURED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_AS_GOOD_AS_EQUAL = 1e-9


def _is_equal(value: Any, wanted: Any) -> bool:
    """Numbers up to rounding, texts in any case."""
    if isinstance(value, str) or isinstance(wanted, str):
        return str(value).casefold() == str(wanted).casefold()
    return bool(abs(value - wanted) <= _AS_GOOD_AS_EQUAL * max(1.0, abs(wanted)))


_HOLDS: dict[str, Callable[[float, float], bool]] = {
    "below": operator.lt,
    "above": operator.gt,
    "at_least": operator.ge,
    "at_most": operator.le,
    "equal": _is_equal,
}
_MOST_DIGITS = 17  # all that a double has


def comparing(
    quantity: Callable[..., Any], say: Callable[[Mapping[str, Any], str], str]
) -> Callable[..., bool | Failed]:
    """A function that calls the quantity and holds if all comparisons with given ports hold.

    What the quantity gives goes to the function in the output port first, so without comparisons it is just remembered.
    `say` gives the words for what was read, of the arguments of the quantity and the value as a text. Raises ValueError
    where the quantity has a parameter that is named as one of these ports.
    """

    def compare(**given: Any) -> bool | Failed:
        store = given.pop(MEASURED, None)
        limits = {name: given.pop(name) for name in _HOLDS if name in given}
        value = quantity(**given)
        if store is not None:
            store(value)
        if _hold(limits, value):
            return True
        if value != value:
            raise Unknown("it is not a number")
        return Failed(lambda: say(given, _rounded(value, limits)))

    own = signature(quantity)
    ports = [Parameter(name, Parameter.KEYWORD_ONLY, default=None) for name in (*_HOLDS, MEASURED)]
    compare.__signature__ = own.replace(parameters=[*own.parameters.values(), *ports])  # type: ignore[attr-defined]
    compare.__name__ = getattr(quantity, "__name__", "quantity")
    return compare


def _hold(limits: Mapping[str, Any], value: Any) -> bool:
    return all(_HOLDS[name](value, limit) for name, limit in limits.items() if limit is not None)


def _rounded(value: Any, limits: Mapping[str, Any]) -> str:
    """The value in three digits, or in more where so few would hold: 19.96 is not at least 20."""
    if isinstance(value, str):
        return value
    texts = (f"{value:.{digits}g}" for digits in range(3, _MOST_DIGITS + 1))
    return next((text for text in texts if not _hold(limits, float(text))), str(value))
