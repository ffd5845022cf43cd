"""Where the joints of a ROS 2 robot are: JointState."""

from __future__ import annotations

from sensor_msgs.msg import JointState

from btlang.robots.body import Body
from btlang.robots.joints import joint_of
from btlang.ros.subscription_cache import SubscriptionCache

STATES, TRAJECTORY = "joint_states", "joint_trajectory"
_SILENT = 2.0  # seconds without joint states


class JointStates:
    """Degrees here, radians on the wire, metres in both of a joint that slides; names have `_` for blanks there."""

    def __init__(self, subscriptions: SubscriptionCache, body: Body) -> None:
        self._subscriptions, self._body = subscriptions, body
        subscriptions.listen(STATES, JointState, "joint states")

    def awaited(self) -> list[str]:
        """The joints of the body that haven't been reported yet, although others have."""
        states = self._subscriptions.latest_joints(STATES)
        return states.missing(on_wire(joint.name) for joint in self._body.joints) if states.has_come else []

    def angle(self, name: str) -> float:
        """Raises RobotError for an unknown joint, and where the joint states are silent."""
        return self.stamped(name)[0]

    def stamped(self, name: str) -> tuple[float, float]:
        """As `angle`, with the time stamp of the message."""
        joint = joint_of(self._body, name)
        self._subscriptions.get(STATES, _SILENT)
        position, stamp = self._subscriptions.latest_joints(STATES).position(on_wire(name), _SILENT)
        return position / joint.si, stamp


def on_wire(name: str) -> str:
    """The name of a joint in messages."""
    return name.replace(" ", "_")
