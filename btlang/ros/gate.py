"""The gate for messages: one whose numbers cannot be true counts as silence, for a reason that is reported."""

from __future__ import annotations

import time
from math import hypot, isfinite, sqrt

import numpy as np
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from btlang.robots.motion.guard.stamps import StampCheck
from btlang.ros.commands import FASTEST, FASTEST_TURN
from btlang.ros.scans import echoes
from btlang.ros.times import seconds_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

_FURTHEST = 1e8  # metres: more than the coordinates of any map
_UNIT = 0.05  # how far the length of a quaternion may be from 1
_JUMP = 1.0  # metres that a pose may jump, besides what the fastest robot drives meanwhile
_TURNS = 100.0  # radians that no scanner turns
_NOT_FINITE = "sends numbers that are not finite"


class Gate:
    """For the messages of one topic, in the order in which they come.

    Without `lags` it doesn't judge how long they were under way: the clock of their stamps may be a faster one.
    """

    def __init__(self, kind: type, lags: bool = True) -> None:
        self._stamps, self._lags = StampCheck(), lags
        self._before: tuple[float, float, float, float] | None = None  # x, y, stamp and arrival
        checks: dict[type, Callable[[Any], str]] = {
            Odometry: self._odometry,
            PoseStamped: lambda message: pose_fault(message.pose),
            PoseWithCovarianceStamped: lambda message: _covariance(message.pose) or pose_fault(message.pose.pose),
            LaserScan: lambda message: _scan(message) or self._stamp(message),
        }
        self.refuses = checks.get(kind, lambda message: "")
        """Why a message is not to be believed, to be read behind the name of its topic; "" where it is."""

    def _odometry(self, message: Any) -> str:
        pose, twist = message.pose.pose, message.twist.twist
        reason = pose_fault(pose) or _covariance(message.pose) or _covariance(message.twist)
        if reason:
            return reason
        speeds = twist.linear.x, twist.linear.y, twist.angular.z
        if not all(map(isfinite, speeds)):
            return _NOT_FINITE
        if hypot(*speeds[:2]) > FASTEST or abs(speeds[2]) > FASTEST_TURN:
            return f"says that the robot moves at {hypot(*speeds[:2]):.3g} m/s and turns at {speeds[2]:.3g} rad/s"
        return self._stamp(message) or self._jump(pose.position.x, pose.position.y, seconds_of(message.header.stamp))

    def _stamp(self, message: Any) -> str:
        return self._stamps.fault(seconds_of(message.header.stamp), time.monotonic(), self._lags)

    def _jump(self, x: float, y: float, stamp: float) -> str:
        """The next message is compared with this one: odometry that restarted is believed again."""
        now = time.monotonic()
        before, self._before = self._before, (x, y, stamp, now)
        if before is None:
            return ""
        passed = stamp - before[2] if stamp > before[2] else now - before[3]
        moved = hypot(x - before[0], y - before[1])
        return f"jumps by {moved:.3g} m" if moved > _JUMP + FASTEST * passed else ""


def pose_fault(pose: Any) -> str:
    """Why a geometry_msgs/Pose is not to be believed, "" where it is."""
    at, q = pose.position, pose.orientation
    if not all(map(isfinite, (at.x, at.y, q.x, q.y, q.z, q.w))):
        return _NOT_FINITE
    if max(abs(at.x), abs(at.y)) > _FURTHEST:
        return f"says that the robot is {hypot(at.x, at.y):.3g} m away"
    if abs(sqrt(q.x**2 + q.y**2 + q.z**2 + q.w**2) - 1.0) > _UNIT:
        return "sends an invalid quaternion"
    return ""


def _covariance(estimate: Any) -> str:
    return "" if np.isfinite(estimate.covariance).all() else "has a covariance that is not finite"


def _scan(scan: Any) -> str:
    if scan.range_min > scan.range_max > 0.0:
        return f"says that it sees from {scan.range_min:.3g} m to {scan.range_max:.3g} m"
    if not abs(scan.angle_min) <= _TURNS or not 0.0 < abs(scan.angle_increment) <= _TURNS:
        return "doesn't say where its beams point"
    return "has no valid beam" if np.isnan(echoes(scan)).all() else ""
