"""Messages of ROS 2 from plain values and back: types, times, poses, scans, and commands within their limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import atan2, cos, degrees, radians, sin
from typing import Any

import numpy as np
import numpy.typing as npt
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Pose as PoseMessage
from geometry_msgs.msg import PoseStamped
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.guard import check_velocity
from btlang.robots.robot import RobotError
from btlang.support.record import Record

MAP, ODOM, BASE = "map", "odom", "base_link"
"""The frames of navigation, of odometry, and of the robot."""
_TOUCHING = 0.01  # metres of an echo that is too close, where a scanner measures from 0 on
_ABSURD = 1e4  # radians or metres of a joint
_ROUNDING = 1.05  # of a limit


def duration(seconds: float) -> Duration:
    """Return seconds as builtin_interfaces/Duration."""
    whole, part = _parts(seconds)
    return Duration(sec=whole, nanosec=part)


def stamp(seconds: float) -> Time:
    """Return seconds as builtin_interfaces/Time."""
    whole, part = _parts(seconds)
    return Time(sec=whole, nanosec=part)


def seconds_of(message: Any) -> float:
    """Return a Time or a Duration in seconds."""
    return float(message.sec + message.nanosec * 1e-9)


def _parts(seconds: float) -> tuple[int, int]:
    return divmod(round(seconds * 1e9), 10**9)


def type_name(cls: Any) -> str:
    """Return the name of a message class in ROS 2: std_msgs/msg/String."""
    if isinstance(cls, str):
        return cls
    package, module = cls.__module__.split(".")[:2]
    return f"{package}/{module}/{cls.__name__.replace('_', ' ')}"


def pose_message(pose: Pose) -> PoseMessage:
    """Return the message of a pose."""
    message = PoseMessage()
    message.position.x, message.position.y = pose.x, pose.y
    set_yaw(message.orientation, radians(pose.heading))
    return message


def stamped_pose(pose: Pose, stamp: Any) -> PoseStamped:
    """Return a PoseStamped on the map at a time."""
    message = PoseStamped(pose=pose_message(pose))
    message.header.frame_id, message.header.stamp = MAP, stamp
    return message


def pose_of(message: Any) -> Pose:
    """Return the pose of a geometry_msgs/Pose; height, roll and pitch don't count."""
    return Pose(message.position.x, message.position.y, degrees(yaw_of(message.orientation)))


def set_yaw(quaternion: Any, yaw: float) -> None:
    """Make an upright quaternion face a direction in radians."""
    quaternion.z, quaternion.w = sin(yaw / 2), cos(yaw / 2)


def yaw_of(quaternion: Any) -> float:
    """Return the direction that a quaternion faces, in radians."""
    q = quaternion
    return atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def echoes(scan: Any) -> npt.NDArray[np.float64]:
    """Return the metres of each beam by REP 117: inf if nothing is in range, NaN if the beam has no measurement.

    A beam of -inf is too close to be measured, and becomes the nearest distance of the scanner. A scanner with a
    `range_max` of 0 sees as far as its echoes are.
    """
    ranges = np.array(scan.ranges, dtype=np.float64)
    close = ranges == -np.inf
    if scan.range_max > scan.range_min:
        ranges[ranges > scan.range_max] = np.inf
    ranges[~(ranges >= scan.range_min) | (ranges <= 0.0)] = np.nan
    ranges[close] = max(scan.range_min, _TOUCHING)
    return ranges


class JointRange(Record):
    """The limits of a joint, and of its speed, in radians or metres."""

    low: float
    high: float
    speed: float


def velocity(kind: Any, linear: float, angular: float, stamp: Any) -> Any:
    """Return a Twist or a TwistStamped, in metres and radians a second. Raises RobotError for numbers that aren't
    finite.
    """
    check_velocity(linear, degrees(angular))
    message = twist = kind()
    if hasattr(message, "header"):
        message.header.stamp, message.header.frame_id = stamp, BASE
        twist = message.twist
    twist.linear.x, twist.angular.z = float(linear), float(angular)
    return message


def trajectory(positions: Mapping[str, float], seconds: float) -> JointTrajectory:
    """Return a trajectory of one point for joints, by their names in messages, in radians or metres.

    Raises RobotError for positions that aren't finite.
    """
    for name, position in positions.items():
        if not abs(position) <= _ABSURD:
            raise RobotError(f"{position:g} isn't a valid position for the joint {name}")
    point = JointTrajectoryPoint(positions=list(map(float, positions.values())), time_from_start=duration(seconds))
    return JointTrajectory(joint_names=list(positions), points=[point])


def motion(
    joints: Mapping[str, JointRange],
    times: Sequence[float],
    rows: Sequence[tuple[Sequence[float], Sequence[float]]],
    stamp: Any,
) -> JointTrajectory:
    """Return a trajectory of joints, by their names in messages, with positions and velocities at each time.

    Times are seconds from `stamp` on. Raises RobotError if times don't rise, or a position is beyond the limits of its
    joint. A joint that begins beyond them may come back.
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
