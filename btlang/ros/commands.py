"""The last line before the wire: a command is finite and within limits, or it is not sent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import degrees
from typing import Any

from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from btlang.robots.motion.guard.guard import check_velocity
from btlang.robots.robot import RobotError
from btlang.ros.poses import BASE
from btlang.ros.times import duration
from btlang.support.record import Record

_ABSURD = 1e4  # radians or metres of a joint
_ROUNDING = 1.05  # of a limit


class Reach(Record):
    """Where a joint may be, and how fast, in radians or metres."""

    low: float
    high: float
    speed: float


def velocity(kind: Any, linear: float, angular: float, stamp: Any) -> Any:
    """A Twist or a TwistStamped, in metres and radians a second. Raises RobotError for what is no velocity."""
    check_velocity(linear, degrees(angular))
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


def motion(
    joints: Mapping[str, Reach],
    times: Sequence[float],
    rows: Sequence[tuple[Sequence[float], Sequence[float]]],
    stamp: Any,
) -> JointTrajectory:
    """Joints by their names on the wire, which are at each time (seconds from `stamp` on) at positions with velocities.

    Raises RobotError where times don't rise, and for what is beyond the limits of a joint. One that begins beyond them
    may come back.
    """
    if not times or times[0] < 0.0 or not all(one < other for one, other in pairwise(times)):
        raise RobotError("the times of a trajectory don't rise")
    for index, (name, reach) in enumerate(joints.items()):
        begin = rows[0][0][index]
        low, high, slack = min(reach.low, begin), max(reach.high, begin), (_ROUNDING - 1.0) * (reach.high - reach.low)
        for positions, velocities in rows:
            if not low - slack <= positions[index] <= high + slack or not abs(positions[index]) <= _ABSURD:
                raise RobotError(f"{positions[index]:g} isn't a valid position for the joint {name}")
            if not abs(velocities[index]) <= reach.speed * _ROUNDING:
                raise RobotError(f"{velocities[index]:g} isn't a valid velocity for the joint {name}")
    made = JointTrajectory(joint_names=list(joints))
    made.header.stamp = stamp
    made.points = [
        JointTrajectoryPoint(positions=positions, velocities=velocities, time_from_start=duration(time))
        for time, (positions, velocities) in zip(times, rows, strict=True)
    ]
    return made
