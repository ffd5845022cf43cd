"""A quantity as a condition: what its function gives is compared with the values of its ports."""

from __future__ import annotations

import operator
from collections.abc import Callable
from inspect import Parameter, signature

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
    """A function that calls the quantity and holds where all comparisons do whose ports are given."""

    def compare(**given: Any) -> bool:
        limits = {name: given.pop(name) for name in _HOLDS if name in given}
        value = quantity(**given)
        return all(_HOLDS[name](value, limit) for name, limit in limits.items() if limit is not None)

    own = signature(quantity)
    ports = [Parameter(name, Parameter.KEYWORD_ONLY, default=None) for name in _HOLDS]
    compare.__signature__ = own.replace(parameters=[*own.parameters.values(), *ports])  # type: ignore[attr-defined]
    compare.__name__ = getattr(quantity, "__name__", "quantity")
    return compare
