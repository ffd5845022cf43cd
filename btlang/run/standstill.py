"""Whether the robot stood still when a run ended, as far as somebody looked."""

from __future__ import annotations

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Standstill(Record):
    """`moving` is None where nothing reports it; `speed` says how fast.

    `pending` are reasons why the robot may be moved on, such as a goal that its server did not give up. `early`: what
    was measured may be older than the motion of a goal that was given up a moment ago.
    """

    moving: bool | None = False
    speed: str = ""
    pending: tuple[str, ...] = ()
    early: bool = False

    @property
    def still(self) -> bool | None:
        """Whether it stands still for good; None where that is not known."""
        if self.moving:
            return False
        return None if self.moving is None or self.pending else True

    @property
    def alarming(self) -> bool:
        """Whether people have to be warned."""
        return bool(self.moving or self.pending)

    def __str__(self) -> str:
        reasons = "; ".join(dict.fromkeys(self.pending))
        if self.moving:
            moving = f"the robot is still moving{f' {self.speed}' if self.speed else ''}"
            return f"{moving}: {reasons}" if reasons else moving
        if self.moving is None:
            unknown = "nothing reports whether the robot moves"
            return f"{unknown}, and {reasons}" if reasons else unknown
        return f"the robot stands still, but {reasons}" if reasons else "the robot stands still"


def standstill_of(robot: Any) -> Standstill:
    """Of any robot: its `standstill`, else what its `moving` says."""
    found: Standstill | None = getattr(robot, "standstill", None)
    return Standstill(getattr(robot, "moving", None)) if found is None else found
