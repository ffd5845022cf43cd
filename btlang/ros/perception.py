"""The people and objects that a ROS 2 robot recognises."""

from __future__ import annotations

from math import isfinite
from typing import Any

from rclpy.node import Node

from btlang.robots.geometry import Pose
from btlang.robots.robot import SensorSilent
from btlang.ros.available import optional_interface
from btlang.ros.places import Places
from btlang.ros.poses import MAP
from btlang.ros.subscription_cache import SubscriptionCache

SIGHTINGS = "sightings"
SIGHTINGS_TYPE = "btlang_interfaces/msg/Sightings"
_SILENT = 2.0  # seconds without word of what is in view
_MOST = 1000  # things in one message
_LONGEST = 100  # letters of a name
KINDS = ("person", "object")
"""The kinds of what is recognised."""


class RosPerception:
    """Hands on to `places` what is in view. Raises SensorSilent if nothing reports what is asked for."""

    def __init__(self, node: Node, subscriptions: SubscriptionCache, places: Places) -> None:
        self._node, self._subscriptions, self._places = node, subscriptions, places
        kind = optional_interface(SIGHTINGS_TYPE)
        self._listens = kind is not None
        if self._listens:
            subscriptions.listen(SIGHTINGS, kind, "word of what is in view", refuses=_fault)

    def step(self, now: float, pose: Pose | None) -> None:
        """Notes what is in view at a second of the run."""
        seen = self._subscriptions.latest(SIGHTINGS, _SILENT) if self._listens else None
        found = seen.sightings if seen is not None else ()
        points = {each.name: (each.kind, (each.position.x, each.position.y)) for each in found}
        self._places.notice(points, now, pose or Pose(0.0, 0.0, 0.0))

    def sees(self, name: str, pose: Pose) -> bool:
        """Whether it is in view now. Raises RobotError for an unknown name."""
        known = self._places.known(name)
        self._check()
        return self._places.sight.sees(known, pose)

    def seen(self, kind: str, pose: Pose) -> list[str]:
        """The names of a type that are in view, nearest first."""
        self._check()
        return self._places.sight.seen(kind, pose)

    def awaited(self) -> list[str]:
        """The topic, where somebody publishes it and it has said nothing yet."""
        comes = not self._listens or self._subscriptions.has(SIGHTINGS) or not self._node.count_publishers(SIGHTINGS)
        return [] if comes else [SIGHTINGS]

    def _check(self) -> None:
        if not self._listens:
            raise SensorSilent("nothing reports what is in view: btlang's interfaces aren't compiled")
        self._subscriptions.get(SIGHTINGS, _SILENT)


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
