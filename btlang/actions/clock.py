"""What the clock says."""

from __future__ import annotations

from btlang.engine.leaves.leaf import Failed
from btlang.text.time_of_day import seconds_of, shown

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.clock import Clock


def time_of_day(clock: Clock, above: str = "", below: str = "", at_least: str = "", at_most: str = "") -> bool | Failed:
    """Whether it is after or before a time of this day, or between two, which may be before and after midnight."""
    now = clock.time_of_day
    begun, over = not at_least or now >= seconds_of(at_least), bool(at_most) and now > seconds_of(at_most)
    if at_least and at_most and seconds_of(at_least) > seconds_of(at_most):
        is_between = begun or not over
    else:
        is_between = begun and not over
    holds = is_between and (not above or now > seconds_of(above)) and (not below or now < seconds_of(below))
    return holds or Failed(lambda: f"it is {shown(now)}")
