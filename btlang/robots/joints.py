"""The joints: they move towards their targets at a limited rate."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign, isnan

from btlang.robots.body import Body, Joint
from btlang.robots.robot import RobotError


def joint_of(body: Body, name: str) -> Joint:
    """The joint of a name. Raises RobotError where the body has none of it."""
    joint = body.joint(name)
    if joint is None:
        raise RobotError(f'the robot has no joint "{name}"')
    return joint


def clipped(body: Body, targets: Mapping[str, float]) -> dict[str, float]:
    """The targets within the limits of their joints. Raises RobotError for an unknown joint, and for no number."""
    for name, target in targets.items():
        if isnan(target):
            raise RobotError(f'the joint "{name}" can\'t move to what is not a number')
    joints = {name: joint_of(body, name) for name in targets}
    return {name: min(joint.high, max(joint.low, targets[name])) for name, joint in joints.items()}


class Joints:
    """Angles in degrees; every joint begins at rest and turns at most as fast as the body says."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._angles = {joint.name: joint.rest for joint in body.joints}
        self._rates = {joint.name: joint.speed for joint in body.joints}
        self._targets: dict[str, float] = {}

    @property
    def moving(self) -> bool:
        """True while any joint is on its way."""
        return bool(self._targets)

    def angle(self, name: str) -> float:
        """Raises RobotError for an unknown joint."""
        return self._angles[joint_of(self._body, name).name]

    def move(self, targets: Mapping[str, float]) -> None:
        """Sets off towards the targets, clipped to the joints' limits. Raises RobotError for an unknown joint."""
        self._targets.update(clipped(self._body, targets))

    def at_target(self, names: tuple[str, ...]) -> bool:
        """True when none of them is on its way."""
        return not any(name in self._targets for name in names)

    def freeze(self, names: tuple[str, ...] | None = None) -> None:
        """They stay where they are; None: all of them."""
        for name in tuple(self._targets) if names is None else names:
            self._targets.pop(name, None)

    def step(self, dt: float) -> None:
        """Moves on by `dt` seconds."""
        for name, target in list(self._targets.items()):
            left, most = target - self._angles[name], self._rates[name] * dt
            if abs(left) <= most:
                self._angles[name] = target
                self._targets.pop(name, None)
            else:
                self._angles[name] += copysign(most, left)
