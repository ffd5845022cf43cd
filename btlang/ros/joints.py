"""The joints of a ROS 2 robot: a JointTrajectory out, JointState in."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, isfinite

from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from btlang.robots.body import Body
from btlang.robots.joints import clipped, joint_of
from btlang.robots.robot import RobotError, SensorSilent
from btlang.ros.awake import AWAKE
from btlang.ros.commands import trajectory
from btlang.ros.subscription_cache import SubscriptionCache

STATES, TRAJECTORY = "joint_states", "joint_trajectory"
_SILENT = 2.0  # seconds without joint states
_STALLED = 5.0  # seconds in which a joint on its way gets no nearer
_PROGRESS = 0.5  # of what is close enough counts as nearer


class RosJoints:
    """Degrees here, radians on the wire, metres in both of a joint that slides; names have `_` for blanks there.

    `freeze` may be called from any thread.
    """

    def __init__(self, node: Node, subscriptions: SubscriptionCache, body: Body) -> None:
        self._body = body
        self._subscriptions = subscriptions
        self._targets: dict[str, float] = {}
        self._nearest: dict[str, tuple[float, float]] = {}  # what was left at the nearest, and since when
        self._publisher = node.create_publisher(JointTrajectory, TRAJECTORY, 10)
        subscriptions.listen(STATES, JointState, "joint states")

    @property
    def moving(self) -> bool:
        """Whether a joint is on its way."""
        return bool(self._targets)

    def angle(self, name: str) -> float:
        """Raises RobotError for an unknown joint, and where the joint states are silent."""
        joint = joint_of(self._body, name)
        states = self._subscriptions.get(STATES, _SILENT)
        wire = _on_wire(name)
        position = positions(states).get(wire)
        if position is None:
            raise SensorSilent(f'{self._subscriptions.shown(STATES)} doesn\'t report the joint "{wire}"')
        return position / joint.si

    def move(self, targets: Mapping[str, float]) -> None:
        """Sets off towards the targets, clipped to the limits. Raises RobotError as `angle` does."""
        goals = clipped(self._body, targets)
        times = (abs(goal - self.angle(name)) / joint_of(self._body, name).speed for name, goal in goals.items())
        self._tell(goals, max(times, default=0.0))
        self._targets.update(goals)
        self._nearest.update(dict.fromkeys(goals, (float("inf"), AWAKE.now())))

    def at_target(self, names: tuple[str, ...]) -> bool:
        """True when none of them is on its way. Raises RobotError where one of them is stuck."""
        for name in names:
            target = self._targets.get(name)
            if target is not None and self._arrived(name, abs(target - self.angle(name))):
                self._targets.pop(name, None)
        return not any(name in self._targets for name in names)

    def freeze(self, names: tuple[str, ...] = ()) -> None:
        """Those of them (without names: of all) that are on their way stay where they are."""
        under_way = [name for name in (names or tuple(self._targets)) if self._targets.pop(name, None) is not None]
        try:
            self._tell({name: self.angle(name) for name in under_way}, 0.0)
        except RobotError:
            return  # nobody knows where they are

    def _arrived(self, name: str, left: float) -> bool:
        joint = joint_of(self._body, name)
        if left <= joint.close_enough:
            return True
        nearest, since = self._nearest[name]
        now = AWAKE.now()
        if left < nearest - _PROGRESS * joint.close_enough:
            self._nearest[name] = left, now
        elif now - since > _STALLED:
            far = f"{left:.2f} m" if joint.slides else f"{left:.0f} degrees"
            raise RobotError(f"the {name} doesn't move: it is {far} from where it should be")
        return False

    def _tell(self, targets: Mapping[str, float], seconds: float) -> None:
        if not targets:
            return
        angles = {_on_wire(name): target * joint_of(self._body, name).si for name, target in targets.items()}
        self._publisher.publish(trajectory(angles, ceil(seconds)))


def positions(states: JointState) -> dict[str, float]:
    """The joints that it says a position of, which is finite, in radians or metres."""
    return {name: at for name, at in zip(states.name, states.position, strict=False) if isfinite(at)}


def _on_wire(name: str) -> str:
    return name.replace(" ", "_")
