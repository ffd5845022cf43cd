"""Pictures of recorded runs: what they ask of the robot at the end of each period comes from the recording."""

from __future__ import annotations

from collections.abc import Callable

from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Point, Pose
from btlang.run.events import Event, PeriodPassed
from btlang.run.robot_state import RobotState

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Sink

_IN_FRONT = 0.4  # metres from its centre at which a robot puts things down, about


class RecordedRobot:
    """What a recording knows of the robot at one moment."""

    def __init__(self, state: RobotState) -> None:
        self._state = state
        self.radius = standard_body().radius

    @property
    def battery(self) -> float:
        """Raises ActionFailed where it was not known."""
        if self._state.battery is None:
            raise ActionFailed("how full the battery was isn't recorded")
        return self._state.battery

    @property
    def pose(self) -> Pose:
        """Raises ActionFailed where it was not known."""
        if self._state.pose is None:
            raise ActionFailed("where the robot was isn't recorded")
        pose: Pose = self._state.pose
        return pose

    def locate(self, name: str) -> Point:
        """Where a thing lies that the robot has just put down: in front of it."""
        return self.pose.ahead(_IN_FRONT)


def drawn(picture: Sink) -> Callable[[Event], object]:
    """The same sink for events of a recording."""

    def take(event: Event) -> None:
        if isinstance(event, PeriodPassed) and event.state is not None:
            event = event.replace(robot=RecordedRobot(event.state))
        picture(event)

    return take
