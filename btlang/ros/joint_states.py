"""Where the joints of a ROS 2 robot are: JointState."""

from __future__ import annotations

from math import isfinite

from sensor_msgs.msg import JointState

from btlang.robots.body import Body
from btlang.robots.joints import joint_of
from btlang.robots.robot import SensorSilent
from btlang.ros.subscription_cache import SubscriptionCache

STATES, TRAJECTORY = "joint_states", "joint_trajectory"
_SILENT = 2.0  # seconds without joint states


class JointStates:
    """Degrees here, radians on the wire, metres in both of a joint that slides; names have `_` for blanks there."""

    def __init__(self, subscriptions: SubscriptionCache, body: Body) -> None:
        self._subscriptions, self._body = subscriptions, body
        subscriptions.listen(STATES, JointState, "joint states")

    @property
    def message(self) -> JointState:
        """The latest one. Raises SensorSilent."""
        return self._subscriptions.get(STATES, _SILENT)

    def angle(self, name: str) -> float:
        """Raises RobotError for an unknown joint, and where the joint states are silent."""
        joint = joint_of(self._body, name)
        position = positions(self.message).get(on_wire(name))
        if position is None:
            raise SensorSilent(f'{self._subscriptions.shown(STATES)} doesn\'t report the joint "{on_wire(name)}"')
        return position / joint.si


def positions(states: JointState) -> dict[str, float]:
    """The joints that it says a position of, which is finite, in radians or metres."""
    return {name: at for name, at in zip(states.name, states.position, strict=False) if isfinite(at)}


def on_wire(name: str) -> str:
    """The name of a joint in messages."""
    return name.replace(" ", "_")
