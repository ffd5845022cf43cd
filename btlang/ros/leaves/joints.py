"""Joints moved by a trajectory of one point, until the states of the joints say that they are there."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping

from sensor_msgs.msg import JointState

from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere
from btlang.ros.clients import Clients
from btlang.ros.commands import trajectory
from btlang.ros.graph import no_listener
from btlang.ros.latest import AGE
from btlang.ros.word import Word, type_name
from btlang.vocabulary.ros_table import SLOT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_DURATION = 2.0  # seconds for the way
_CLOSE = 0.05  # radians or metres
_OTHERS = 0.5  # seconds in which the messages with other joints come
_PATIENCE = 5.0  # seconds beyond the duration


def joints_leaf(word: Word, clients: Clients) -> Callable[..., Any]:
    """A generator leaf. FAILURE where a joint does not get there; when it is halted, joints stay where they are."""
    cls, name = word.interface(), word.ros.name
    if type_name(cls) != "trajectory_msgs/msg/JointTrajectory":
        raise word.misfit(cls, word.ros.interface, "joints takes trajectory_msgs/msg/JointTrajectory")
    targets = {joint: _target(word, joint, given) for joint, given in word.ros.get("positions").given}
    publisher = clients.publisher(cls, name)
    states: Any = clients.latest(JointState, word.ros.get("states", "joint_states"))
    seconds, close = word.amount("duration", _DURATION), word.ros.get("tolerance", _CLOSE)
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


def _target(word: Word, joint: str, given: Any) -> Callable[[Mapping[str, Any]], float]:
    """The position of a joint in radians or metres."""
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
    """Where some joints are. Raises ActionFailed."""
    states.take(AGE)
    return {joint: states.position(joint, AGE)[0] for joint in joints}
