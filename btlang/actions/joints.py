"""What gestures and manipulation share: bringing joints to angles."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.actions.motion import Steps
from btlang.actions.watch import Watch
from btlang.robots.robot import Hand, Robot

Posture = Mapping[str, float]

HANGING: Posture = {"lift": 0.0, "swing": 0.0, "bend": 0.0}
RAISED: Posture = {"lift": 150.0, "swing": 0.0, "bend": 0.0}
STRETCHED: Posture = {"lift": 90.0, "swing": 0.0, "bend": 0.0}
FOLDED: Posture = {"lift": 0.0, "swing": 0.0, "bend": 150.0}
REACHING: Posture = {"lift": 60.0, "swing": 0.0, "bend": 0.0}
CARRYING: Posture = {"lift": 40.0, "swing": 0.0, "bend": 90.0}


def arm(side: Hand, posture: Posture) -> dict[str, float]:
    """The posture as targets of one arm's joints."""
    return {f"{side} arm {part}": angle for part, angle in posture.items()}


def bring(robot: Robot, targets: Posture) -> Steps:
    """Moves joints to angles (degrees); halted, just these joints freeze. Raises ActionFailed on an emergency stop."""
    watch = Watch(robot)
    robot.move_joints(targets)
    try:
        while not robot.joints_at_target(*targets):
            yield
            watch.check_stop()
    finally:
        robot.freeze_joints(*targets)
