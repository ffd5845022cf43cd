"""The base of a ROS 2 robot: velocity out, odometry and localization in."""

from __future__ import annotations

from collections import deque
from math import cos, degrees, hypot, inf, isfinite, radians, sin
from threading import RLock
from typing import Any

from geometry_msgs.msg import PoseWithCovarianceStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.node import Node

from btlang.robots.command_gate import Latch
from btlang.robots.geometry import Pose, wrap
from btlang.robots.motion.guard.guard import FRESH
from btlang.robots.motion.guard.readings import OdometryReading
from btlang.robots.robot import RobotError
from btlang.ros.messages import pose_of, seconds_of, type_name, velocity
from btlang.ros.robot.interface import VELOCITY
from btlang.ros.subscriptions import SubscriptionCache

ODOMETRY, LOCATED = "odom", "amcl_pose"
TWIST, STAMPED = type_name(Twist), type_name(TwistStamped)
_TYPES: dict[str, Any] = {TWIST: Twist, STAMPED: TwistStamped}
_SILENT = 2.0  # seconds without odometry
_FRESH = 0.5  # seconds for which odometry can say that the robot does not move
_JUST = 1.0  # seconds for which odometry can say that the robot stands still
_REMEMBERED = 200  # odometry that a late localization is matched with
_REST, _TURN_REST = 0.01, 1.0  # metres and degrees a second that odometry reports of a robot that stands
_STUCK_AFTER, _STUCK_SHARE = 1.0, 0.05
_BEGINS = 3.0  # seconds that it gets to set off, from the time when somebody listens
_STEP = 0.1  # seconds that a step counts at most: robots brake by themselves before one that comes late
_ACKNOWLEDGED = Duration(seconds=0.5)
_NEWEST = 1  # velocity is kept: with each that fills what is kept, Fast DDS asks whether it has arrived, else each 3 s


class RosBase:
    """The base of a ROS 2 robot. It repeats the wanted velocity between two steps, since robots brake without it.

    It never publishes a velocity that isn't finite, or is faster than `fastest`: metres and degrees a second.

    The pose is the latest one of the localization, moved on by the odometry since; if nothing localizes the robot, it
    is the odometry alone. `halt` may be called from any thread. Nothing is published before somebody listens: the type
    of the listener, Twist or TwistStamped, decides, since a node can use a topic with only one type.
    """

    def __init__(
        self,
        node: Node,
        subscriptions: SubscriptionCache,
        radius: float,
        fastest: tuple[float, float],
        latch: Latch | None = None,
    ) -> None:
        self._node, self._subscriptions = node, subscriptions
        self._radius, self._fastest = radius, fastest
        self._latch = latch or Latch()
        self._lock = RLock()  # a signal handler may halt while this thread drives
        self.limits = inf, inf
        """Metres and degrees a second that it doesn't exceed, whatever is commanded."""
        self._wanted = (0.0, 0.0)
        self._published = False  # since the latest step
        self._idle = self._passed = 0.0
        self._under_way = False
        self._seen: tuple[Any, Pose] | None = None  # the odometry that was looked at last
        self._track: deque[tuple[float, Pose]] = deque(maxlen=_REMEMBERED)
        self._fix: tuple[Pose, Pose] | None = None
        self._early: Any = None  # a localization that is newer than the odometry
        self._publisher: Any = None
        self._type = TWIST
        subscriptions.listen(ODOMETRY, Odometry, "odometry", also=self._on_odometry)
        subscriptions.listen(LOCATED, PoseWithCovarianceStamped, "pose", qos="state", also=self._on_pose)

    def adapt(self) -> str:
        """Choose the type of velocity messages that listeners take, and return its name."""
        types = {end.topic_type for end in self._node.get_subscriptions_info_by_topic(VELOCITY)} & {TWIST, STAMPED}
        with self._lock:
            if types and (self._publisher is None or self._type not in types):
                if self._publisher is not None:
                    self._node.destroy_publisher(self._publisher)
                self._type = TWIST if TWIST in types else STAMPED
                self._publisher = self._node.create_publisher(_TYPES[self._type], VELOCITY, _NEWEST)
            return self._type

    def drive(self, linear: float, angular: float) -> None:
        """Set the wanted metres and degrees a second, within the limits. Raises RobotError for numbers that aren't
        finite.

        While the latch refuses commands, only zero is accepted. The latch is checked within the lock, so that the zero
        of a stop comes after all that was let through before it.
        """
        with self._lock:
            wanted = self.clip(linear, angular)
            if self._latch.refuses and wanted != (0.0, 0.0):
                return
            if wanted == (0.0, 0.0):
                self._idle, self._under_way, self._seen = 0.0, False, None
            elif self._published and wanted == self._wanted:
                return
            self._wanted = wanted
            try:
                self._publish()
            except RobotError:
                self.halt()
                raise

    def halt(self) -> None:
        """Publish zero velocity, from any thread."""
        self.drive(0.0, 0.0)

    def confirm_halt(self) -> None:
        """Publish zero velocity, and wait at most half a second until all listeners have it."""
        self.halt()
        if self._publisher is not None:
            self._publisher.wait_for_all_acked(_ACKNOWLEDGED)

    def step(self, dt: float) -> None:
        """Publish the wanted velocity again, unless it was since the last step; `dt` seconds have passed."""
        with self._lock:
            if self._wanted != (0.0, 0.0):
                self._watch(min(dt, _STEP))
                if not self._published:
                    self._publish()
            self._published = False

    def clip(self, linear: float, angular: float) -> tuple[float, float]:
        """Return a velocity within the limits of the base."""
        return _at_most(linear, self._fastest[0]), _at_most(angular, self._fastest[1])

    @property
    def commanded(self) -> tuple[float, float]:
        """The commanded metres and degrees a second."""
        return self._wanted

    @property
    def driving(self) -> bool:
        """Whether it is commanded to move."""
        return self._wanted != (0.0, 0.0)

    @property
    def stuck(self) -> bool:
        """Whether it has been commanded to move for a second (to set off: for three) and doesn't."""
        return self._idle >= (_STUCK_AFTER if self._under_way else _BEGINS)

    @property
    def velocity(self) -> tuple[float, float]:
        """The measured metres and degrees a second. Raises RobotError if the odometry is silent."""
        return self._measure(_SILENT)

    @property
    def motion(self) -> tuple[float, float] | None:
        """The metres and degrees a second measured a moment ago; None if there is no measurement."""
        try:
            return self._measure(_JUST)
        except RobotError:
            return None

    def _measure(self, age: float) -> tuple[float, float]:
        twist = self._subscriptions.get(ODOMETRY, age).twist.twist
        linear, angular = float(twist.linear.x), degrees(twist.angular.z)
        return (linear if abs(linear) > _REST else 0.0), (angular if abs(angular) > _TURN_REST else 0.0)

    @property
    def pose(self) -> Pose:
        """The pose on the map. Raises RobotError if the odometry is silent."""
        now = pose_of(self._subscriptions.get(ODOMETRY, _SILENT).pose.pose)
        return now if self._fix is None else _move_with_odometry(*self._fix, now)

    def reading(self) -> OdometryReading | None:
        """Return the latest odometry, for the guard; None if none has come."""
        found = self._subscriptions.reading(ODOMETRY, FRESH)
        if found is None:
            return None
        message, arrived, fault = found
        pose, measured = pose_of(message.pose.pose), seconds_of(message.header.stamp) or None
        return OdometryReading(self._subscriptions.shown(ODOMETRY), arrived, fault, pose, measured)

    @property
    def is_localized(self) -> bool:
        """Whether the pose comes from more than odometry."""
        return self._fix is not None

    def where(self) -> Pose | None:
        """Return the pose; None if the odometry is silent."""
        try:
            return self.pose
        except RobotError:
            return None

    def _publish(self) -> None:
        if self._publisher is None:
            self.adapt()
        stamp = self._node.get_clock().now().to_msg()
        linear, angular = self._sent
        message = velocity(_TYPES[self._type], linear, radians(angular), stamp)
        if self._publisher is not None:
            self._publisher.publish(message)
            self._published = True

    def _watch(self, dt: float) -> None:
        """Count the time without the commanded motion, by the pose. A command has to arrive first."""
        try:
            message = self._subscriptions.get(ODOMETRY, _FRESH)
        except RobotError:
            self._seen = None
            return  # whoever asks for the pose gets the error
        if self._publisher is None or not self._publisher.get_subscription_count():
            return
        sent = self._sent
        if sent == (0.0, 0.0):  # the guard lets it stand
            self._idle, self._seen = 0.0, None
            return
        before, self._passed = self._seen, self._passed + dt
        if before is not None and before[0] is message:
            return
        pose, twist = pose_of(message.pose.pose), message.twist.twist
        self._seen = message, pose
        passed, self._passed = self._passed, 0.0
        if before is None:
            return
        least = _STUCK_SHARE * self._arc(*sent)
        turned = wrap(pose.heading - before[1].heading)
        if self._arc(before[1].distance_to((pose.x, pose.y)), turned) >= least * passed:
            self._idle, self._under_way = 0.0, True
        else:
            speed = self._arc(hypot(twist.linear.x, twist.linear.y), degrees(twist.angular.z))
            sets_off = not self._under_way and speed >= least
            self._idle = 0.0 if sets_off else self._idle + passed  # how long the command took to arrive is not counted
            self._under_way |= sets_off

    @property
    def _sent(self) -> tuple[float, float]:
        """The part of the wanted velocity that may be sent."""
        return _at_most(self._wanted[0], self.limits[0]), _at_most(self._wanted[1], self.limits[1])

    def _arc(self, way: float, angle: float) -> float:
        """Return the metres that the rim of the robot moves for metres and degrees."""
        return abs(way) + self._radius * radians(abs(angle))

    def _on_odometry(self, message: Any) -> None:
        self._track.append((seconds_of(message.header.stamp), pose_of(message.pose.pose)))
        if self._early is not None:
            early, self._early = self._early, None
            self._match(early)

    def _on_pose(self, message: Any) -> None:
        """Match a pose with the odometry of its time, which may come a moment later."""
        if self._track and seconds_of(message.header.stamp) <= self._track[-1][0]:
            self._match(message)
        else:
            self._early = message

    def _match(self, message: Any) -> None:
        at = seconds_of(message.header.stamp)
        odometry = min(self._track, key=lambda entry: abs(entry[0] - at))[1]
        self._fix = pose_of(message.pose.pose), odometry


def _at_most(speed: float, most: float) -> float:
    """Clip a value to a limit. A value that isn't finite stays so, and is refused later."""
    return max(-most, min(most, speed)) + 0.0 if isfinite(speed) else speed


def _move_with_odometry(located: Pose, before: Pose, now: Pose) -> Pose:
    """Return a pose on the map, moved on as the odometry did."""
    turn = wrap(located.heading - before.heading)
    c, s = cos(radians(turn)), sin(radians(turn))
    dx, dy = now.x - before.x, now.y - before.y
    return Pose(located.x + c * dx - s * dy, located.y + s * dx + c * dy, wrap(now.heading + turn))
