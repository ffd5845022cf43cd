"""Poses of the simulated robot as messages of ROS 2: metres, and radians in a quaternion."""

from __future__ import annotations

from math import atan2, cos, degrees, radians, sin

from geometry_msgs.msg import Pose as PoseMessage

from btlang.robots.geometry import Pose

MAP, ODOM, BASE = "map", "odom", "base_link"
"""The frames. The odometry of the simulated robot does not drift: `odom` is `map`."""


def pose_message(pose: Pose) -> PoseMessage:
    """The message of a pose on the floor."""
    message = PoseMessage()
    message.position.x, message.position.y = pose.x, pose.y
    message.orientation.z, message.orientation.w = sin(radians(pose.heading) / 2), cos(radians(pose.heading) / 2)
    return message


def pose_of(message: PoseMessage) -> Pose:
    """The pose on the floor of a message: what is above it, and roll and pitch, do not count."""
    q = message.orientation
    heading = atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    return Pose(message.position.x, message.position.y, degrees(heading))
