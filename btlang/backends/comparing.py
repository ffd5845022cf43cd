"""A quantity as a condition: what its function gives is compared with the values of its ports, and may be kept."""

from __future__ import annotations

import operator
from collections.abc import Callable
from inspect import Parameter, signature

from btlang.vocabulary.entry import MEASURED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_AS_GOOD_AS_EQUAL = 1e-9
_HOLDS: dict[str, Callable[[float, float], bool]] = {
    "below": operator.lt,
    "above": operator.gt,
    "at_least": operator.ge,
    "at_most": operator.le,
    "equal": lambda value, wanted: abs(value - wanted) <= _AS_GOOD_AS_EQUAL * max(1.0, abs(wanted)),
}


def comparing(quantity: Callable[..., Any]) -> Callable[..., bool]:
    """A function that calls the quantity and holds where all comparisons do whose ports are given.

    What the quantity gives goes to the function in the output port first, so without comparisons it is just remembered.
    Raises ValueError where the quantity has a parameter that is named as one of these ports.
    """

    def compare(**given: Any) -> bool:
        store = given.pop(MEASURED, None)
        limits = {name: given.pop(name) for name in _HOLDS if name in given}
        value = quantity(**given)
        if store is not None:
            store(value)
        return all(_HOLDS[name](value, limit) for name, limit in limits.items() if limit is not None)

    own = signature(quantity)
    ports = [Parameter(name, Parameter.KEYWORD_ONLY, default=None) for name in (*_HOLDS, MEASURED)]
    compare.__signature__ = own.replace(parameters=[*own.parameters.values(), *ports])  # type: ignore[attr-defined]
    compare.__name__ = getattr(quantity, "__name__", "quantity")
    return compare
