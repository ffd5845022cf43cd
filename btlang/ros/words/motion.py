"""Leaves that move: driving and turning by velocities, and joints by a trajectory of one point."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable, Mapping

from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState

from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere
from btlang.robots.bodies.body import PATIENCE
from btlang.robots.motion.progress import Approach, DriveProgress
from btlang.ros.graph import no_listener
from btlang.ros.messages import trajectory, type_name, velocity, yaw_of
from btlang.ros.subscriptions import AGE, Latest
from btlang.ros.words.clients import RosClients
from btlang.ros.words.word import RosWord
from btlang.vocabulary.ros_table import SLOT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


SPEED, TURN = 0.3, math.radians(45)
"""Default speeds in metres and radians a second."""
_GAIN = 3.0  # speed per way that is left; twice as much would swing where odometry comes 0.1 s late
_SLOWEST = (0.03, 0.08)  # metres and radians a second that still move a robot
_CLOSE = (0.01, math.radians(1.0))
_ODOMETRY_AGE = 1.0  # seconds; a robot that does not know where it is should not drive on
_DURATION = 2.0  # seconds for the way
_JOINTS_CLOSE = 0.05  # radians or metres
_OTHERS = 0.5  # seconds in which the messages with other joints come
_PATIENCE = 5.0  # seconds beyond the duration


def drive_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a generator leaf. FAILURE if odometry is silent or the robot makes no progress;
    zero velocity at each end.
    """
    cls, name = word.interface(), word.ros.name
    if type_name(cls) not in ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"):
        raise word.misfit(cls, word.ros.interface, "a drive takes geometry_msgs/msg/Twist or TwistStamped")
    [way] = [way for way in ("forward", "backward", "left", "right") if word.ros.get(way) is not None]
    turns, sign = way in ("left", "right"), -1.0 if way in ("backward", "right") else 1.0
    amount, speed = word.amount(way, 0.0), word.amount("speed", TURN if turns else SPEED)
    close = word.ros.get("tolerance", _CLOSE[turns])
    patience = word.ros.get("patience", PATIENCE)
    publisher = clients.publisher(cls, name)
    odometry = clients.latest(Odometry, word.ros.get("odometry", "odom"))

    def send(speed: float, turning: float = 0.0) -> str:
        """Send the velocity that the guard allows; return why it is slower, "" if it isn't."""
        speeds = (0.0, speed) if turns else (speed, turning)
        verdict = clients.judge(name, speeds[0], math.degrees(speeds[1]))
        if verdict is not None:
            speeds = verdict.linear, math.radians(verdict.angular)
        publisher.publish(velocity(cls, *speeds, clients.clock.message()))
        return "" if verdict is None else verdict.reason

    def drive(**values: Any) -> Generator[None, None, bool]:
        way_to_go = sign * amount(values)
        approach = Approach(abs(speed(values)), _GAIN, slowest=_SLOWEST[turns])
        if not publisher.get_subscription_count() or not odometry.has_come:
            yield from _ready(clients, cls, name, publisher, odometry, patience)
        travelled = _measure_turn if turns else _measure_drive
        start = pose = _pose(odometry.take(_ODOMETRY_AGE))
        done, shown = 0.0, math.degrees if turns else float
        reason = ""
        bounds = DriveProgress(shown(way_to_go), shown(close), turns, clients.clock.now, patience, lambda: reason)
        try:
            while True:
                before, pose = pose, _pose(odometry.take(_ODOMETRY_AGE))
                done = done + travelled(before, pose) if turns else travelled(start, pose)
                left = way_to_go - done
                if abs(left) <= close:
                    return True
                bounds.check(shown(left), shown(done) if turns else math.dist(start[:2], pose[:2]))
                reason = send(approach.velocity(left), 0.0 if turns else -_GAIN * _measure_turn(start, pose))
                yield
        finally:
            send(0.0)

    return drive


def _ready(
    clients: RosClients, cls: Any, name: str, publisher: Any, odometry: Latest, patience: float
) -> Generator[None]:
    """Yield until somebody listens and odometry has come."""
    until = clients.clock.now() + patience
    while not publisher.get_subscription_count() or not odometry.has_come:
        if clients.clock.now() >= until:
            raise ActionFailed(NotThere(odometry.why_not() or no_listener(clients.node, cls, name)))
        yield


def _pose(message: Any) -> tuple[float, float, float]:
    """Return x, y in metres and the direction in radians."""
    pose = message.pose.pose
    return pose.position.x, pose.position.y, yaw_of(pose.orientation)


def _measure_drive(start: tuple[float, float, float], pose: tuple[float, float, float]) -> float:
    """Return the metres ahead, in the direction at the start."""
    return (pose[0] - start[0]) * math.cos(start[2]) + (pose[1] - start[1]) * math.sin(start[2])


def _measure_turn(start: tuple[float, float, float], pose: tuple[float, float, float]) -> float:
    """Return the radians to the left, less than half a turn."""
    return math.remainder(pose[2] - start[2], math.tau)


def joints_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a generator leaf. FAILURE if a joint doesn't get there; when it is halted, joints stay where they are."""
    cls, name = word.interface(), word.ros.name
    if type_name(cls) != "trajectory_msgs/msg/JointTrajectory":
        raise word.misfit(cls, word.ros.interface, "joints takes trajectory_msgs/msg/JointTrajectory")
    targets = {joint: _target(word, joint, given) for joint, given in word.ros.get("positions").given}
    publisher = clients.publisher(cls, name)
    states: Any = clients.latest(JointState, word.ros.get("states", "joint_states"))
    seconds, close = word.amount("duration", _DURATION), word.ros.get("tolerance", _JOINTS_CLOSE)
    patience, now = word.ros.get("patience", _PATIENCE), clients.clock.now

    def send(wanted: Mapping[str, float], time_from_start: float) -> None:
        publisher.publish(trajectory(wanted, time_from_start))

    def move(**values: Any) -> Generator[None, None, bool | Failed]:
        wanted, length = {joint: target(values) for joint, target in targets.items()}, seconds(values)
        until = now() + patience
        while not publisher.get_subscription_count() or not states.has_come:
            if now() >= until:
                raise ActionFailed(NotThere(states.why_not() or no_listener(clients.node, cls, name)))
            yield
        until = now() + _OTHERS
        while states.missing(wanted) and now() < until:
            yield
        at = _positions(states, wanted)
        send(wanted, length)
        until, arrived = now() + length + patience, False
        try:
            while not arrived:
                yield
                at = _positions(states, wanted)
                arrived = all(abs(at[joint] - target) <= close for joint, target in wanted.items())
                if not arrived and now() >= until:
                    joint = max(wanted, key=lambda joint: abs(at[joint] - wanted[joint]))
                    raise ActionFailed(f"{joint} is at {at[joint]:.2f} and doesn't reach {wanted[joint]:.2f}")
        finally:
            if not arrived:
                send(at, 0.0)
        return True

    return move


def _target(word: RosWord, joint: str, given: Any) -> Callable[[Mapping[str, Any]], float]:
    """Return the position of a joint in radians or metres."""
    slot = SLOT.fullmatch(given) if isinstance(given, str) else None
    if slot is None:
        if not isinstance(given, int | float) or isinstance(given, bool):
            raise word.misfit(word.ros.interface, joint, f"the position of {joint} is a number or a slot")
        return lambda values: float(given)
    name = slot[1]
    try:
        factor = word.factor(name, slot[2] or "")
    except LookupError as error:
        raise word.misfit(word.ros.interface, given, str(error)) from None

    def target(values: Mapping[str, Any]) -> float:
        if name not in values:
            raise ActionFailed(f"it needs a value for {name}")
        return float(values[name]) * factor

    return target


def _positions(states: Any, joints: Iterable[str]) -> dict[str, float]:
    """Return the positions of some joints. Raises ActionFailed."""
    states.take(AGE)
    return {joint: states.position(joint, AGE)[0] for joint in joints}
