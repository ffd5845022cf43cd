"""What a ROS 2 robot sees and runs into."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np
import numpy.typing as npt
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from btlang.robots.body import Body, Sensor
from btlang.robots.geometry import CENTRE, Pose
from btlang.robots.motion.guard.guard import FRESH
from btlang.robots.motion.guard.readings import ObstacleReading, ScanReading
from btlang.robots.robot import SensorSilent
from btlang.robots.scan import around
from btlang.ros.base import RosBase
from btlang.ros.poses import BASE
from btlang.ros.scans import echoes
from btlang.ros.subscription_cache import SubscriptionCache

SCAN, BUMP = "scan", "bump"
_SILENT = 2.0  # seconds without a scan
_LOOK_AGAIN = 1.0  # seconds between two looks for a publisher
_FREE_AGAIN = 0.03  # metres from where it bumped


class RosSensors:
    """`bumps` counts contacts; `emit` reports them, a base that does not move as commanded, and once a scanner that is
    silent when somebody asks it.
    """

    def __init__(
        self, subscriptions: SubscriptionCache, base: RosBase, emit: Callable[..., object], body: Body
    ) -> None:
        self._subscriptions, self._base, self._emit = subscriptions, base, emit
        self._scanner, self._radius = body.sensor("scanner") or Sensor("scanner", BASE), body.radius
        self._seen: tuple[Any, npt.NDArray[np.float64], float] | None = None  # a scan, around the centre, and its room
        self._looked, self._published = -inf, False
        self._contact: Pose | None = None
        self._unknown_frame = ""
        self._stuck_reported = self._silence_reported = False
        self.bumps = 0
        subscriptions.listen(SCAN, LaserScan, "laser scan")
        subscriptions.listen(BUMP, String, "bumps", qos="events")

    def scan(self) -> npt.NDArray[np.float64]:
        """The nearest echo in each degree. Raises RobotError when the scanner is silent."""
        try:
            scan = self._subscriptions.get(SCAN, _SILENT)
        except SensorSilent as silent:
            if not self._silence_reported:
                self._silence_reported = True
                self._emit("warning", text=str(silent))
            raise
        self._silence_reported = False
        return self._around(scan)

    def readings(self, now: float) -> list[ObstacleReading]:
        """What the guard lets the base drive by; nothing of a scanner that has never sent a scan and isn't there."""
        found, scanner = self._subscriptions.reading(SCAN, FRESH), self._scanner
        if found is None:
            reason = self._never(now)
            return [ScanReading("scanner", now, reason, self.scan, scanner.view, scanner.angle)] if reason else []
        message, arrived, fault = found
        if self._seen is None or self._seen[0] is not message:
            ranges = self._around(message)
            room = -inf if np.isnan(ranges).any() else float(ranges.min(initial=inf)) - self._radius
            self._seen = message, ranges, room
        _, ranges, room = self._seen
        return [ScanReading("scanner", arrived, fault, lambda: ranges, scanner.view, scanner.angle, room)]

    def _never(self, now: float) -> str:
        """Why no scan has come, although something publishes them."""
        if now - self._looked >= _LOOK_AGAIN:
            self._looked = now
            self._published = self._subscriptions.is_published(SCAN)
        return f"nothing has arrived on {self._subscriptions.shown(SCAN)} yet" if self._published else ""

    @property
    def bumped(self) -> bool:
        """True from a contact until it has moved away."""
        return self._contact is not None

    def step(self) -> None:
        """Reports contacts."""
        for message in self._subscriptions.events(BUMP):
            self.bumps += 1
            self._contact = self._base.where()
            self._emit("bump", into=message.data)
        now = self._base.where()
        if self._contact is not None and now is not None and self._contact.distance_to((now.x, now.y)) > _FREE_AGAIN:
            self._contact = None
        if self._base.stuck and not self._stuck_reported:
            self._emit("stuck")
        self._stuck_reported = self._base.stuck

    def _around(self, scan: Any) -> npt.NDArray[np.float64]:
        ranges, frame = echoes(scan), scan.header.frame_id.rpartition("/")[2]
        if frame not in ("", BASE, self._scanner.frame.rpartition("/")[2], self._unknown_frame):
            self._unknown_frame = frame
            wanted = f"the laser scan is in the frame '{frame}', but the robot file has '{self._scanner.frame}'"
            self._emit("warning", text=f"{wanted}: what it shows may be elsewhere")
        angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
        at = CENTRE if frame == BASE else self._scanner.pose
        return around(ranges, angles, at, abs(np.degrees(scan.angle_increment)))
