"""Values of files of other programs, checked one by one: what is wrong is a Problem that names the value."""

from __future__ import annotations

from math import atan2, degrees

from btlang.robots.geometry import wrap
from btlang.text.enumeration import joined
from btlang.text.toml_table import Problem, is_coordinate

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LONGEST = 40  # characters of a value in a message


def shown(value: object) -> str:
    """A value in a message, cut short."""
    # a long number has no text, and that of a large list takes long to make
    text = repr(value) if isinstance(value, str | float | bool | None) else f"a {type(value).__name__}"
    return text if len(text) <= _LONGEST else text[:_LONGEST] + "..."


def number(value: Any, what: str, low: float | None = None, high: float | None = None) -> float:
    """A finite number of at most a million, within the bounds. Raises Problem."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Problem(f"{what} must be a number, not {shown(value)}")
    if not is_coordinate(value):
        raise Problem(f"{what} must be a number from -1,000,000 to 1,000,000")
    if (low is not None and value < low) or (high is not None and value > high):
        bounds = f"at least {low:g}" if high is None else f"from {low:g} to {high:g}"
        raise Problem(f"{what} must be {bounds}, not {value:g}")
    return float(value)


def numbers(value: Any, what: str, *counts: int) -> list[float]:
    """A list of so many numbers. Raises Problem."""
    if not isinstance(value, list) or len(value) not in counts:
        raise Problem(f"{what} must be a list of {joined([*map(str, counts)], 'or')} numbers")
    return [number(each, what) for each in value]


def yaw(what: str, x: float, y: float, z: float, w: float) -> float:
    """The direction in degrees, (-180, 180], of a quaternion of any length but 0. Raises Problem."""
    length = x * x + y * y + z * z + w * w
    if length < 1e-9:
        raise Problem(f"{what} must be a quaternion, and this one has the length 0")
    return wrap(degrees(atan2(2 * (w * z + x * y), length - 2 * (y * y + z * z))))
