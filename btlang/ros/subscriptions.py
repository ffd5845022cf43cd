"""The latest messages of topics, how old they are, and whether their numbers can be true."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterable
from math import degrees, hypot, isfinite, sqrt
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan

from btlang.engine.leaves.leaf import Unknown
from btlang.robots.motion.guard.guard import FASTEST, FASTEST_TURN
from btlang.robots.motion.guard.readings import StampCheck
from btlang.robots.robot import SensorSilent
from btlang.ros.clocks import AWAKE, SteadyTime
from btlang.ros.messages import echoes, seconds_of, type_name

_FURTHEST = 1e8  # metres: more than the coordinates of any map
_UNIT = 0.05  # how far the length of a quaternion may be from 1
_JUMP = 1.0  # metres that a pose may jump, besides what the fastest robot drives meanwhile
_TURNS = 100.0  # radians that no scanner turns
_NOT_FINITE = "sends numbers that are not finite"
AGE = 5.0
"""Seconds after which the latest message no longer counts, unless a table gives another age."""
_KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_MOST = 1000  # messages of one topic that wait for a tick; older ones are forgotten
_NONSENSE = 2.0  # seconds in which only what is refused has come, however slow the topic is
QOS = {"events": QoSProfile(depth=100), "state": _KEPT}
"""How to listen to a topic: each event counts, late listeners get a state too; those of a sensor may be lost."""


class MessageGate:
    """A check of the messages of one topic, in the order in which they come.

    Without `lags` it doesn't judge how long they were under way: the clock of their stamps may run faster. With
    `all_stamps` the stamps of all kinds of messages count, otherwise those of odometry and scans.
    """

    def __init__(self, kind: Any, lags: bool = True, all_stamps: bool = False) -> None:
        self._stamps, self._lags = StampCheck(), lags
        self._before: tuple[float, float, float, float] | None = None  # x, y, stamp and arrival
        checks: dict[type, Callable[[Any], str]] = {
            Odometry: self._odometry,
            PoseStamped: lambda message: pose_fault(message.pose),
            PoseWithCovarianceStamped: lambda message: _covariance(message.pose) or pose_fault(message.pose.pose),
            LaserScan: _scan,
        }
        self._check = checks.get(kind, lambda message: "")
        self._stamped = kind in (Odometry, LaserScan) or (all_stamps and hasattr(kind, "header"))

    def refuses(self, message: Any) -> str:
        """Return why a message can't be true, to be read after the name of its topic; "" if it can."""
        reason = self._check(message)
        if not self._stamped:
            return reason
        stamp = self._stamps.fault(seconds_of(message.header.stamp), time.monotonic(), self._lags)
        return reason or stamp

    def _odometry(self, message: Any) -> str:
        pose, twist = message.pose.pose, message.twist.twist
        reason = pose_fault(pose) or _covariance(message.pose) or _covariance(message.twist)
        if reason:
            return reason
        speeds = twist.linear.x, twist.linear.y, twist.angular.z
        if not all(map(isfinite, speeds)):
            return _NOT_FINITE
        if hypot(*speeds[:2]) > FASTEST or abs(degrees(speeds[2])) > FASTEST_TURN:
            return f"says that the robot moves at {hypot(*speeds[:2]):.3g} m/s and turns at {speeds[2]:.3g} rad/s"
        return self._jump(pose.position.x, pose.position.y, seconds_of(message.header.stamp))

    def _jump(self, x: float, y: float, stamp: float) -> str:
        """Compare with the previous message; the next one is compared with this one, so that restarted odometry is
        believed.
        """
        now = time.monotonic()
        before, self._before = self._before, (x, y, stamp, now)
        if before is None:
            return ""
        passed = stamp - before[2] if stamp > before[2] else now - before[3]
        moved = hypot(x - before[0], y - before[1])
        return f"jumps by {moved:.3g} m" if moved > _JUMP + FASTEST * passed else ""


def pose_fault(pose: Any) -> str:
    """Return why a geometry_msgs/Pose can't be true, "" if it can."""
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


class NodeClock:
    """The clock of a node in seconds, for any thread.

    Without simulated time these are real seconds in which this process runs; with it those of SteadyTime: a limit is
    always reached.
    """

    def __init__(self, node: Any) -> None:
        self._clock = node.get_clock()
        simulated = getattr(self._clock, "ros_time_is_active", True)
        self.now: Callable[[], float] = SteadyTime(self._seconds).now if simulated else AWAKE.now
        """The seconds of the node's clock."""

    def message(self) -> Any:
        """Return the time as builtin_interfaces/Time."""
        return self._clock.now().to_msg()

    def _seconds(self) -> float:
        return float(self._clock.now().nanoseconds) * 1e-9


class Latest:
    """The latest message of a topic. `store` is for the thread of the callbacks, everything else for any thread.

    `named` is the name of the topic, such as "/scan"; `absence` returns why nothing may have come, "" for no known
    reason. A message for which `refuses` returns a reason counts as silence.
    """

    depth = 5
    """How many messages may wait for the thread that spins."""

    def __init__(
        self,
        named: str,
        now: Callable[[], float],
        absence: Callable[[], str] = str,
        refuses: Callable[[Any], str] = lambda message: "",
    ) -> None:
        self.named = named
        self.refused = ""
        """Why the latest message was refused; "" if it wasn't."""
        self._now = now
        self._absence = absence
        self._refuses = refuses
        self._last: tuple[Any, float] | None = None  # with its time of arrival

    @property
    def has_come(self) -> bool:
        """Whether there is any message."""
        return self._last is not None

    @property
    def arrived(self) -> float:
        """The second at which the message came; -inf if there is none."""
        return -math.inf if self._last is None else self._last[1]

    @property
    def message(self) -> Any:
        """The message, however old; None if there is none."""
        return None if self._last is None else self._last[0]

    def store(self, message: Any) -> bool:
        """Keep a message in place of the previous one, unless it is refused."""
        reason = self._refuses(message)
        self.refused = f"{self.named} {reason}" if reason else ""
        if not reason:
            self._last = message, self._now()
        return not reason

    def silence(self) -> float:
        """Return the seconds since it came, without those in which this process was asleep."""
        return math.inf if self._last is None else min(self._now() - self._last[1], AWAKE.since_woke())

    def take(self, age: float | None = AGE) -> Any:
        """Return the message if it isn't older than so many seconds; None means any age. Raises Unknown with the
        reason.
        """
        last = self._last
        if last is None:
            raise Unknown(self.why_not())
        silence = self.silence()
        if age is not None and silence > age:
            reason = self.refused or self._absence()
            raise Unknown(reason or f"nothing has arrived on {self.named} for {silence:.1f} s")
        return last[0]

    def why_not(self) -> str:
        """Return why nothing has come, "" if something has."""
        if self.has_come:
            return ""
        return self.refused or self._absence() or f"nothing has arrived on {self.named} yet"


class LatestJoints(Latest):
    """The latest position of each joint. A robot may report its limbs in separate messages."""

    depth = 50

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._joints: dict[str, tuple[float, float, float]] = {}  # position, time of arrival, stamp

    def store(self, message: Any) -> bool:
        if not super().store(message):
            return False
        now, stamp = self._now(), seconds_of(message.header.stamp)
        self._joints.update((name, (at, now, stamp)) for name, at in zip(message.name, message.position, strict=False))
        return True

    def missing(self, joints: Iterable[str]) -> list[str]:
        """Return the joints, of these, whose position has never come."""
        return [joint for joint in joints if joint not in self._joints]

    def position(self, joint: str, age: float) -> tuple[float, float]:
        """Return the position of a joint, in radians or metres, and its stamp. Raises
        SensorSilent if it isn't known.
        """
        position, arrived, stamp = self._joints.get(joint, (math.nan, math.inf, 0.0))
        if not math.isfinite(position):
            raise SensorSilent(f'{self.named} doesn\'t report the joint "{joint}"')
        if min(self._now() - arrived, AWAKE.since_woke()) > age:
            raise SensorSilent(f'{self.named} hasn\'t reported the joint "{joint}" for {age:g} s')
        return position, stamp


def latest_of(cls: type) -> type[Latest]:
    """Return the class that keeps the latest messages of a type."""
    return LatestJoints if type_name(cls) == "sensor_msgs/msg/JointState" else Latest


class SubscriptionCache:
    """The latest messages of a robot: callbacks put them in, the tick takes them out.

    Ages count from arrival, in the seconds of `now`. A message that the gate refuses counts as silence.
    """

    def __init__(self, node: Node, now: Callable[[], float] = AWAKE.now) -> None:
        self._node = node
        self._now = now
        self._latest: dict[str, Latest] = {}
        self._events: dict[str, deque[Any]] = {}
        self._read: dict[str, Any] = {}
        self._what: dict[str, str] = {}

    def listen(
        self,
        topic: str,
        kind: type,
        what: str,
        qos: str = "sensor",
        also: Callable[[Any], object] | None = None,
        refuses: Callable[[Any], str] | None = None,
        key: str = "",
    ) -> None:
        """Subscribe; `what` names the messages for people.

        `also` is called with each message, in the thread that spins. `refuses` replaces the gate for messages of this
        type, `key` the topic as the name by which they are asked for.
        """
        key = key or topic
        self._what[key] = what
        named, refuses = self._node.resolve_topic_name(topic), refuses or self._gate(kind).refuses
        latest = latest_of(kind)(named, self._now, refuses=refuses)
        self._latest[key] = latest
        if qos != "sensor":
            self._events[key] = deque(maxlen=_MOST)

        def arrived(message: Any) -> None:
            if not latest.store(message):
                return
            if also is not None:
                also(message)
            if qos != "sensor":
                self._events[key].append(message)

        profile = QoSProfile(depth=latest.depth, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._node.create_subscription(kind, topic, arrived, QOS.get(qos, profile))

    def _gate(self, kind: type) -> MessageGate:
        return MessageGate(kind, lags=not self._node.get_clock().ros_time_is_active)

    def read(self) -> None:
        """Take what has arrived until now, so that all leaves of a tick get the same messages."""
        self._read = {topic: latest.message for topic, latest in self._latest.items() if latest.has_come}

    def events(self, topic: str) -> list[Any]:
        """Return the messages since the last call, oldest first."""
        waiting = self._events[topic]
        return [waiting.popleft() for _ in range(len(waiting))]

    def has(self, topic: str) -> bool:
        """Return whether a message has ever come, also since the latest `read`."""
        return self._latest[topic].has_come

    def why_not(self, topic: str) -> str:
        """Return why there is no message to believe, "" if there is one."""
        return self._latest[topic].refused or self._latest[topic].why_not()

    def is_published(self, topic: str) -> bool:
        """Return whether somebody publishes a subscribed topic."""
        return bool(self._node.count_publishers(self._latest[topic].named))

    def shown(self, topic: str) -> str:
        """Return the name of a subscribed topic, with the namespace."""
        return self._latest[topic].named

    def get(self, topic: str, limit: float | None = None) -> Any:
        """Return the latest message. Raises SensorSilent if there is none, or none for `limit` seconds."""
        what, latest = self._what[topic], self._latest[topic]
        if topic not in self._read:
            raise SensorSilent(f"no {what}: {latest.refused or f'nothing has arrived on {latest.named}'}")
        # after a tick that took long, newer ones are there but not read yet
        if limit is not None:
            limit = min(limit, _NONSENSE) if latest.refused else limit
            if latest.silence() > limit:
                raise SensorSilent(f"no {what} for {limit:g} s: {latest.refused or f'{latest.named} is silent'}")
        return self._read[topic]

    def reading(self, topic: str, fresh: float) -> tuple[Any, float, str] | None:
        """Return the latest message, when it arrived, and why it can't be believed: nothing true has come for `fresh`
        seconds.

        None if no message has ever come.
        """
        latest = self._latest[topic]
        if not latest.has_come:
            return None
        silence = latest.silence()
        reason = latest.refused or f"{latest.named} is silent for {silence:.1f} s"
        return latest.message, latest.arrived, reason if silence > fresh else ""

    def latest_joints(self, topic: str) -> LatestJoints:
        """Return the joints that a topic reports."""
        latest = self._latest[topic]
        assert isinstance(latest, LatestJoints)
        return latest

    def latest(self, topic: str, limit: float) -> Any:
        """Return the latest message like `get`, but None in place of an error."""
        try:
            return self.get(topic, limit)
        except SensorSilent:
            return None
