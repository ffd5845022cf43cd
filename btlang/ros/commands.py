"""The last line before the wire: what a robot is told is finite and within limits, or it is not told."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from btlang.robots.robot import RobotError
from btlang.ros.poses import BASE
from btlang.ros.times import duration

FASTEST, FASTEST_TURN = 20.0, 30.0
"""Metres and radians a second that no robot exceeds."""
_ABSURD = 1e4  # radians or metres of a joint


def velocity(kind: Any, linear: float, angular: float, stamp: Any, fastest: float = FASTEST) -> Any:
    """A Twist or a TwistStamped, in metres and radians a second. Raises RobotError for what is no velocity."""
    if not isfinite(linear) or not isfinite(angular):
        raise RobotError(f"a velocity of {linear:g} m/s and {angular:g} rad/s is not finite")
    if abs(linear) > fastest or abs(angular) > FASTEST_TURN:
        raise RobotError(
            f"a velocity of {linear:.3g} m/s and {angular + 0.0:.3g} rad/s is beyond the limits of the robot"
        )
    message = twist = kind()
    if hasattr(message, "header"):
        message.header.stamp, message.header.frame_id = stamp, BASE
        twist = message.twist
    twist.linear.x, twist.angular.z = float(linear), float(angular)
    return message


def trajectory(positions: Mapping[str, float], seconds: float) -> JointTrajectory:
    """Joints by their names on the wire, to radians or metres. Raises RobotError for what is no position."""
    for name, position in positions.items():
        if not abs(position) <= _ABSURD:
            raise RobotError(f"{position:g} isn't a valid position for the joint {name}")
    point = JointTrajectoryPoint(positions=list(map(float, positions.values())), time_from_start=duration(seconds))
    return JointTrajectory(joint_names=list(positions), points=[point])
