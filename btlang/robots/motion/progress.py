"""The pace of a drive or a turn, and its bounds: one that gets no further, or goes much too far, must end."""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, inf, sqrt

from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.bodies.body import PATIENCE

_STEP = 0.2  # of the way to what counts as being close: less is no progress
_TOO_FAR, _ROOM = 1.5, (1.0, 90.0)  # times the way, and metres or degrees beyond
_LOOK = 1.0  # seconds that one look counts at most: a look that comes late says nothing of the time before


class DriveProgress:
    """The progress of a drive in metres, or of a turn in degrees if it `turns`. To pass the goal is progress too:
    the approach is slower behind it.

    `close` is how near is near enough, `now` returns seconds, `why` a reason.
    """

    def __init__(
        self,
        wanted: float,
        close: float,
        turns: bool,
        now: Callable[[], float],
        patience: float = PATIENCE,
        why: Callable[[], str] = str,
    ) -> None:
        self._wanted, self._close, self._turns = abs(wanted), close, turns
        self._now, self._patience, self._why = now, patience, why
        self._nearest, self._before = inf, 0.0
        self._looked, self._waited = now(), 0.0

    def check(self, left: float, gone: float) -> None:
        """Raise ActionFailed without progress. `gone` is the distance from the start, in any direction."""
        now = self._now()
        self._waited += min(now - self._looked, _LOOK)
        self._looked = now
        gone = abs(gone)
        if gone > _TOO_FAR * self._wanted + _ROOM[self._turns]:
            raise ActionFailed(f"the robot {'turned' if self._turns else 'went'} too far: {self._of(gone)}")
        passed, self._before = left * self._before < 0, left
        if passed or abs(left) < self._nearest - _STEP * self._close:
            self._nearest, self._waited = min(abs(left), self._nearest), 0.0
        elif self._waited > self._patience:
            reason = self._why()
            raise ActionFailed(f"the robot makes no progress: {self._of(gone)} done{reason and f', {reason}'}")

    def _of(self, gone: float) -> str:
        digits, unit = (0, "degrees") if self._turns else (2, "m")
        return f"{gone:.{digits}f} of {self._wanted:.{digits}f} {unit}"


class Approach:
    """The speed to approach a goal, in metres or degrees a second, at least `slowest`: `gain` of the rest in each
    second.

    Each overshoot halves the pace and the slowest one: where commands or poses arrive late, the robot would oscillate
    around the goal forever.
    """

    def __init__(self, fastest: float, gain: float, slowing: float = inf, slowest: float = 0.0) -> None:
        self._fastest, self._gain, self._slowing, self._slowest = fastest, gain, slowing, min(slowest, fastest)
        self._before = 0.0

    def velocity(self, left: float) -> float:
        """Return the velocity, with the sign of what is left."""
        if left * self._before < 0:
            self._fastest, self._gain, self._slowest = self._fastest / 2, self._gain / 2, self._slowest / 2
        self._before, way = left, abs(left)
        pace = min(self._gain * way, self._fastest, sqrt(2 * self._slowing * way))
        return copysign(max(self._slowest, pace), left)
