"""Poses on the floor as messages of ROS 2: metres, and radians in a quaternion."""

from __future__ import annotations

from math import atan2, cos, degrees, radians, sin
from typing import Any

from geometry_msgs.msg import Pose as PoseMessage
from geometry_msgs.msg import PoseStamped

from btlang.robots.geometry import Pose

MAP, ODOM, BASE = "map", "odom", "base_link"
"""The frames of navigation, of odometry, and of the robot."""


def pose_message(pose: Pose) -> PoseMessage:
    """The message of a pose."""
    message = PoseMessage()
    message.position.x, message.position.y = pose.x, pose.y
    set_yaw(message.orientation, radians(pose.heading))
    return message


def stamped_pose(pose: Pose, stamp: Any) -> PoseStamped:
    """A pose on the map at a time."""
    message = PoseStamped(pose=pose_message(pose))
    message.header.frame_id, message.header.stamp = MAP, stamp
    return message


def pose_of(message: Any) -> Pose:
    """The pose of a geometry_msgs/Pose: what is above the floor, and roll and pitch, do not count."""
    return Pose(message.position.x, message.position.y, degrees(yaw_of(message.orientation)))


def set_yaw(quaternion: Any, yaw: float) -> None:
    """Makes an upright quaternion face a direction in radians."""
    quaternion.z, quaternion.w = sin(yaw / 2), cos(yaw / 2)


def yaw_of(quaternion: Any) -> float:
    """The direction that a quaternion faces, in radians."""
    q = quaternion
    return atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
