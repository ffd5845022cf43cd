"""Whether joints get on: one that is on its way and gets no nearer has failed, within the patience of the body."""

from __future__ import annotations

from collections.abc import Callable, Collection
from math import inf

from btlang.robots.body import Body, Joint
from btlang.robots.joints import joint_of
from btlang.robots.robot import RobotError

_NEARER = 0.5  # of what is close enough counts as nearer


class JointProgress:
    """The joints of a body that are on their way. `now` gives seconds."""

    def __init__(self, body: Body, now: Callable[[], float]) -> None:
        self._body, self._now = body, now
        self._nearest: dict[str, tuple[float, float]] = {}  # what was left at the nearest, and since when

    def start(self, names: Collection[str]) -> None:
        """These joints set off now."""
        self._nearest.update(dict.fromkeys(names, (inf, self._now())))

    def has_arrived(self, name: str, left: float) -> bool:
        """Whether a joint is close enough, with so much left. Raises RobotError if it gets no nearer for too long."""
        joint = joint_of(self._body, name)
        if abs(left) <= joint.close_enough:
            self._nearest.pop(name, None)
            return True
        now = self._now()
        nearest, since = self._nearest.setdefault(name, (inf, now))
        if abs(left) < nearest - _NEARER * joint.close_enough:
            self._nearest[name] = abs(left), now
        elif now - since > self._body.patience:
            raise RobotError(f"the {name} doesn't move: it is {shown_distance(joint, left)} from where it should be")
        return False


def shown_distance(joint: Joint, distance: float) -> str:
    """How far a joint is from where it should be, for people."""
    return f"{abs(distance):.2f} m" if joint.slides else f"{abs(distance):.0f} degrees"
