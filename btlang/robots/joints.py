"""Two arms and a head: joints that move towards their targets at a limited rate."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign

from btlang.robots.robot import RobotError

RATE = 120.0
_ARM = {"lift": (0.0, 180.0), "swing": (-180.0, 180.0), "bend": (0.0, 150.0)}
LIMITS = {f"{side} arm {part}": limit for side in ("left", "right") for part, limit in _ARM.items()} | {
    "head turn": (-90.0, 90.0),
    "head tilt": (-40.0, 40.0),
}


class Joints:
    """Angles in degrees; every joint begins at 0 and turns at most RATE degrees a second."""

    def __init__(self) -> None:
        self._angles = dict.fromkeys(LIMITS, 0.0)
        self._targets: dict[str, float] = {}

    @property
    def moving(self) -> bool:
        """True while any joint is on its way."""
        return bool(self._targets)

    def angle(self, name: str) -> float:
        """Raises RobotError for an unknown joint."""
        self._check(name)
        return self._angles[name]

    def move(self, targets: Mapping[str, float]) -> None:
        """Sets off towards the targets, clipped to the joints' limits."""
        for name, target in targets.items():
            self._check(name)
            low, high = LIMITS[name]
            self._targets[name] = min(high, max(low, target))

    def at_target(self, names: tuple[str, ...]) -> bool:
        """True when none of them is on its way."""
        return not any(name in self._targets for name in names)

    def freeze(self, names: tuple[str, ...] = tuple(LIMITS)) -> None:
        """They stay where they are."""
        for name in names:
            self._targets.pop(name, None)

    def step(self, dt: float) -> None:
        """Moves on by `dt` seconds."""
        for name, target in list(self._targets.items()):
            left = target - self._angles[name]
            if abs(left) <= RATE * dt:
                self._angles[name] = target
                self._targets.pop(name, None)
            else:
                self._angles[name] += copysign(RATE * dt, left)

    def _check(self, name: str) -> None:
        if name not in LIMITS:
            raise RobotError(f'the robot has no joint "{name}"')
