"""The sensors of a ROS 2 robot: its scanner, its bumper, and the people and objects that it recognises."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, isfinite
from typing import Any

import numpy as np
import numpy.typing as npt
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from btlang.robots.bodies.body import Body, Sensor
from btlang.robots.geometry import CENTRE, Pose
from btlang.robots.motion.guard.guard import FRESH
from btlang.robots.motion.guard.readings import ObstacleReading, ScanReading
from btlang.robots.robot import SensorSilent
from btlang.robots.worlds.scan import around, summary
from btlang.ros.available import optional_interface
from btlang.ros.messages import BASE, MAP, echoes
from btlang.ros.robot.base import RosBase
from btlang.ros.robot.places import RosPlaces
from btlang.ros.subscriptions import SubscriptionCache

SCAN, BUMP = "scan", "bump"
_SILENT = 2.0  # seconds without a scan
_LOOK_AGAIN = 1.0  # seconds between two looks for a publisher
_FREE_AGAIN = 0.03  # metres from where it bumped
SIGHTINGS = "sightings"
SIGHTINGS_TYPE = "btlang_interfaces/msg/Sightings"
_SIGHT_SILENT = 2.0  # seconds without word of what is in view
_MOST = 1000  # things in one message
_LONGEST = 100  # letters of a name
KINDS = ("person", "object")
"""The kinds of what is recognised."""


class RosSensors:
    """The scanner and the bumper. `bumps` counts contacts.

    `emit` reports contacts, a base that doesn't move as commanded, and once a scanner that is silent when it is asked
    for.
    """

    def __init__(
        self, subscriptions: SubscriptionCache, base: RosBase, emit: Callable[..., object], body: Body
    ) -> None:
        self._subscriptions, self._base, self._emit = subscriptions, base, emit
        self._scanner, self._radius = body.sensor("scanner") or Sensor("scanner", BASE), body.radius
        self._seen: tuple[Any, npt.NDArray[np.float64], float, float] | None = None  # see `_look`
        self._looked, self._published = -inf, False
        self._contact: Pose | None = None
        self._unknown_frame = ""
        self._stuck_reported = self._silence_reported = False
        self.bumps = 0
        subscriptions.listen(SCAN, LaserScan, "laser scan")
        subscriptions.listen(BUMP, String, "bumps", qos="events")

    def scan(self) -> npt.NDArray[np.float64]:
        """Return the nearest echo in each degree. Raises RobotError if the scanner is silent."""
        try:
            scan = self._subscriptions.get(SCAN, _SILENT)
        except SensorSilent as silent:
            if not self._silence_reported:
                self._silence_reported = True
                self._emit("warning", text=str(silent))
            raise
        self._silence_reported = False
        return self._look(scan)[0]

    def readings(self, now: float) -> list[ObstacleReading]:
        """Return the readings for the guard; none of a scanner that isn't there and has never sent a scan."""
        found, scanner = self._subscriptions.reading(SCAN, FRESH), self._scanner
        if found is None:
            reason = self._never(now)
            return [ScanReading("scanner", now, reason, self.scan, scanner.view, scanner.angle)] if reason else []
        message, arrived, fault = found
        ranges, room, content = self._look(message)
        return [ScanReading("scanner", arrived, fault, lambda: ranges, scanner.view, scanner.angle, room, content)]

    def _look(self, message: Any) -> tuple[npt.NDArray[np.float64], float, float]:
        """Return a scan around the centre, and its summary, once for all who ask before the next one."""
        seen = self._seen
        if seen is None or seen[0] is not message:
            ranges = self._around(message)
            self._seen = seen = message, ranges, *summary(ranges, self._radius)
        return seen[1:]

    def _never(self, now: float) -> str:
        """Return why no scan has come, although somebody publishes scans."""
        if now - self._looked >= _LOOK_AGAIN:
            self._looked = now
            self._published = self._subscriptions.is_published(SCAN)
        return self._subscriptions.why_not(SCAN) if self._published else ""

    @property
    def bumped(self) -> bool:
        """Whether it ran into something and hasn't moved away yet."""
        return self._contact is not None

    def step(self) -> None:
        """Report contacts."""
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


class RosPerception:
    """The perception of a ROS 2 robot, which passes what is in view on to `places`. Raises SensorSilent if nothing
    reports it.
    """

    def __init__(self, node: Node, subscriptions: SubscriptionCache, places: RosPlaces) -> None:
        self._node, self._subscriptions, self._places = node, subscriptions, places
        kind = optional_interface(SIGHTINGS_TYPE)
        self._listens = kind is not None
        if self._listens:
            subscriptions.listen(SIGHTINGS, kind, "word of what is in view", refuses=_fault)

    def step(self, now: float, pose: Pose | None) -> None:
        """Note what is in view at a second of the run."""
        seen = self._subscriptions.latest(SIGHTINGS, _SIGHT_SILENT) if self._listens else None
        found = seen.sightings if seen is not None else ()
        points = {each.name: (each.kind, (each.position.x, each.position.y)) for each in found}
        self._places.notice(points, now, pose or Pose(0.0, 0.0, 0.0))

    def sees(self, name: str, pose: Pose) -> bool:
        """Return whether a name is in view now. Raises RobotError for an unknown name."""
        known = self._places.known(name)
        self._check()
        return self._places.sight.sees(known, pose)

    def seen(self, kind: str, pose: Pose) -> list[str]:
        """Return the names of a type that are in view, nearest first."""
        self._check()
        return self._places.sight.seen(kind, pose)

    def find_unreported(self) -> list[str]:
        """Return the topic, if somebody publishes it and it has reported nothing yet."""
        comes = not self._listens or self._subscriptions.has(SIGHTINGS) or not self._node.count_publishers(SIGHTINGS)
        return [] if comes else [SIGHTINGS]

    def _check(self) -> None:
        if not self._listens:
            raise SensorSilent("nothing reports what is in view: btlang's interfaces aren't compiled")
        self._subscriptions.get(SIGHTINGS, _SIGHT_SILENT)


def _fault(message: Any) -> str:
    if message.header.frame_id not in (MAP, ""):
        return f"gives points in the frame {message.header.frame_id}, not {MAP}"
    if len(message.sightings) > _MOST:
        return f"has more than {_MOST} things in view at once"
    for each in message.sightings:
        if not (isfinite(each.position.x) and isfinite(each.position.y)):
            return "sends numbers that are not finite"
        if each.kind not in KINDS or not 0 < len(each.name) <= _LONGEST:
            return "names something that is neither a person nor an object"
    return ""
