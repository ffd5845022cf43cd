"""What a ROS 2 robot sees and runs into."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, radians
from typing import Any

import numpy as np
import numpy.typing as npt
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from btlang.robots.geometry import Pose
from btlang.robots.robot import SensorSilent
from btlang.ros.base import RosBase
from btlang.ros.scans import echoes
from btlang.ros.subscription_cache import SubscriptionCache

SCAN, BUMP = "scan", "bump"
_SILENT = 2.0  # seconds without a scan
_FREE_AGAIN = 0.03  # metres from where it bumped


class RosSensors:
    """`bumps` counts contacts; `emit` is told of them, of a base that does not move as it is told to, and once of a
    scanner that somebody asks and that is silent.
    """

    def __init__(self, subscriptions: SubscriptionCache, base: RosBase, emit: Callable[..., object]) -> None:
        self._subscriptions, self._base, self._emit = subscriptions, base, emit
        self._contact: Pose | None = None
        self._stuck_told = self._silence_told = False
        self.bumps = 0
        subscriptions.listen(SCAN, LaserScan, "laser scan")
        subscriptions.listen(BUMP, String, "bumps", qos="events")

    def scan(self) -> npt.NDArray[np.float64]:
        """The nearest echo in each degree. Raises RobotError when the scanner is silent."""
        try:
            scan = self._subscriptions.get(SCAN, _SILENT)
        except SensorSilent as silent:
            if not self._silence_told:
                self._silence_told = True
                self._emit("warning", text=str(silent))
            raise
        self._silence_told = False
        return _degrees(scan)

    @property
    def bumped(self) -> bool:
        """True from a contact until it has moved away."""
        return self._contact is not None

    def step(self) -> None:
        """Tells of contacts."""
        for message in self._subscriptions.events(BUMP):
            self.bumps += 1
            self._contact = self._base.where()
            self._emit("bump", into=message.data)
        now = self._base.where()
        if self._contact is not None and now is not None and self._contact.distance_to((now.x, now.y)) > _FREE_AGAIN:
            self._contact = None
        if self._base.stuck and not self._stuck_told:
            self._emit("stuck")
        self._stuck_told = self._base.stuck


def _degrees(scan: Any) -> npt.NDArray[np.float64]:
    """360 distances, index = degrees left of the heading; inf where no beam came back."""
    ranges = echoes(scan)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    seen = np.isfinite(ranges)
    found = np.full(360, inf)
    np.minimum.at(found, np.rint(angles[seen] / radians(1.0)).astype(int) % 360, ranges[seen])
    return found
