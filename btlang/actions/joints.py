"""What gestures and manipulation share: bringing joints to angles, and parts of the body to postures."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.actions.common import Watch
from btlang.actions.motion import Steps
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.bodies.gesture import angle_of
from btlang.robots.robot import Joints


def bring(robot: Joints, targets: Mapping[str, float]) -> Steps:
    """Move joints to angles (degrees); when halted, freeze just these joints. Raises
    ActionFailed on an emergency stop.
    """
    watch = Watch(robot)
    robot.move_joints(targets)
    try:
        while not robot.joints_at_target(*targets):
            yield
            watch.check_stop()
    finally:
        robot.freeze_joints(*targets)


def take(robot: Joints, *postures: str, bearing: float = 0.0) -> Steps:
    """Bring the body to postures of its file, all at once, or their steps one after the other.

    `bearing` is the angle of a joint that points or looks somewhere. Raises ActionFailed as `bring` does.
    """
    known = robot.body.postures
    for name in postures:
        if name not in known:
            raise ActionFailed(f'the robot has no posture "{name}"')
    for at in range(max(len(known[name]) for name in postures)):
        step: dict[str, float | str] = {}
        for name in postures:
            for angles in known[name][at : at + 1]:
                step.update(angles)
        yield from bring(robot, {joint: angle_of(angle, bearing) for joint, angle in step.items()})


def posture(*names: str, bearing: float = 0.0) -> Callable[[Joints], Steps]:
    """Return an action that brings the body to postures, as `take` does."""

    def assume(robot: Joints) -> Steps:
        """Bring the body to the postures."""
        yield from take(robot, *names, bearing=bearing)

    return assume
