"""The zones of the world on a ROS 2 robot, against which goals and plans are checked, and the limit of its speed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import ceil, dist, inf, isfinite

from nav_msgs.msg import Path
from rclpy.node import Node
from std_msgs.msg import Bool

from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world import Zone, said
from btlang.robots.zones import Zones, zone_names
from btlang.ros.available import optional_interface
from btlang.ros.graph import graph_names
from btlang.ros.node import LATCHED
from btlang.ros.subscriptions import SubscriptionCache

PLAN, SPEED_LIMIT = "plan", "speed_limit"
_STEP = 0.1  # metres between two points of a plan that are looked at
_SAME_GOAL = 1.0  # metres from the goal at which a plan to it ends
_NEW_PLAN = 1.0  # seconds of the mission in which the robot plans again when a zone was closed or opened
_REPEAT = 1.0  # seconds after which a limit is published again
_LONGEST = 100_000  # points of a plan
_NO_LIMIT = False, 0.0  # in the message of Nav2: whether it is a percentage, and how much


class RosZones:
    """The zones of the world, which a mission may close and open; topics publish which are closed.

    A topic limits the speed to that of the slow zone that the robot is in, or to `pace` if that is slower.
    """

    def __init__(
        self,
        node: Node,
        subscriptions: SubscriptionCache,
        zones: Zones,
        world_zones: Sequence[Zone],
        normal_speed: float,
    ) -> None:
        self.zones = zones
        self.pace = 1.0
        """The share of the normal speed at which the robot goes its ways; above 1 there is no limit."""
        self._normal_speed = normal_speed
        self._subscriptions = subscriptions
        topics = zone_topics(world_zones)
        self._closed = {name: node.create_publisher(Bool, topic, LATCHED) for name, topic in topics.items()}
        self._limit_type = optional_interface("nav2_msgs/msg/SpeedLimit")
        self._limits = node.create_publisher(self._limit_type, SPEED_LIMIT, 10) if self._limit_type else None
        self._time = self._changed = self._limited = 0.0
        self._limit = _NO_LIMIT
        self._goal: tuple[str, Point] | None = None
        self._plan: list[Point] = []
        self._version = self._checked = -1
        if world_zones:
            subscriptions.listen(PLAN, Path, "plan", qos="events", refuses=_fault)

    def begin(self) -> None:
        """Begin a run, or end all: zones are as in the world, and the pace is the normal one."""
        self.zones.begin()
        self._announce()
        self.pace = 1.0
        if self._limit != _NO_LIMIT:
            self._publish_limit(_NO_LIMIT)

    def set_out(self, name: str, pose: Pose) -> None:
        """Note the goal of the robot. Raises RobotError for a goal in a closed zone."""
        refusal = self.zones.refusal(name, (pose.x, pose.y))
        if refusal is not None:
            raise RobotError(refusal)
        self._announce()
        self._goal, self._plan = (name, (pose.x, pose.y)), []

    def step(self, dt: float, pose: Pose | None) -> str:
        """Go on after `dt` seconds; return why the robot must not follow its plan, "" if it may."""
        self._time += dt
        self._announce()
        self._update_limit(pose)
        if not self._closed:
            return ""
        for message in self._subscriptions.events(PLAN):
            points = [(at.pose.position.x, at.pose.position.y) for at in message.poses]
            if self._goal is not None and points and dist(points[-1], self._goal[1]) <= _SAME_GOAL:
                self._plan, self._checked = points, -1
        if not self._plan or self._checked == self.zones.version or self._time - self._changed < _NEW_PLAN:
            return ""
        self._checked = self.zones.version
        if self._goal is None:
            return ""
        left = next((zones for zones in self.zones.confines if leaves(self._plan, zones)), None)
        if left is not None:
            return f"the way to {said(self._goal[0])} leads out of {zone_names(left)}, where the robot has to stay"
        zone = next((zone for zone in self.zones.closed if enters(self._plan, zone)), None)
        if zone is None:
            return ""
        return f"the way to {said(self._goal[0])} leads through the {zone.name}, where the robot may not go"

    def limit(self, pose: Pose | None) -> float:
        """Return the metres a second that the slow zones at a pose allow; infinite if there are none."""
        if pose is None:
            return inf
        return min((zone.speed for zone in self.zones.slow if zone.contains((pose.x, pose.y))), default=inf)

    def _announce(self) -> None:
        """Publish which zones are closed, if that has changed."""
        if self._version == self.zones.version:
            return
        if self._version >= 0:
            self._changed = self._time
        self._version = self.zones.version
        for name, publisher in self._closed.items():
            publisher.publish(Bool(data=self.zones.is_closed(name)))

    def _update_limit(self, pose: Pose | None) -> None:
        if self._limits is None or pose is None:
            return
        allowed = self.limit(pose)
        limit = _NO_LIMIT if allowed == inf else (False, allowed)
        if self.pace < 1.0 and self.pace * self._normal_speed <= allowed:
            limit = True, 100.0 * self.pace
        if limit != self._limit or (limit != _NO_LIMIT and self._time - self._limited >= _REPEAT):
            self._publish_limit(limit)

    def _publish_limit(self, limit: tuple[bool, float]) -> None:
        self._limit, self._limited = limit, self._time
        if self._limits is not None:
            self._limits.publish(self._limit_type(percentage=limit[0], speed_limit=limit[1]))


def zone_topics(zones: Iterable[Zone]) -> dict[str, str]:
    """Return the topic of each zone that reports whether it is closed."""
    tokens = graph_names((zone.name for zone in zones), "zone")
    return {name: f"zones/{token}/closed" for name, token in tokens.items()}


def enters(plan: Sequence[Point], zone: Zone) -> bool:
    """Return whether a plan leads into a zone; one that only leads out of it doesn't."""
    was_inside = True
    for (ax, ay), (bx, by) in pairwise((plan[0], *plan)):
        steps = max(1, ceil(dist((ax, ay), (bx, by)) / _STEP))
        for step in range(1, steps + 1):
            share = step / steps
            inside = zone.contains((ax + share * (bx - ax), ay + share * (by - ay)))
            if inside and not was_inside:
                return True
            was_inside = inside
    return False


def leaves(plan: Sequence[Point], zones: Sequence[Zone]) -> bool:
    """Return whether a plan leads out of zones, so that it is in none of them any more; one that
    only leads in doesn't.
    """
    inside = [any(zone.contains(point) for zone in zones) for point in plan]
    return any(before and not after for before, after in pairwise(inside)) or not inside[-1]


def _fault(message: Path) -> str:
    if len(message.poses) > _LONGEST:
        return f"sends a plan of more than {_LONGEST:,} points"
    points = (at.pose.position for at in message.poses)
    return "" if all(isfinite(at.x) and isfinite(at.y) for at in points) else "sends numbers that are not finite"
