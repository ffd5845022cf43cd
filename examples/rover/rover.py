"""What only the campus rover does: postures of its arm, reports of its state, and feeling that it is carried."""

from __future__ import annotations

from math import hypot, inf

from btlang import Component, Parameter
from btlang.actions.motion import turn_left

_POSTURES = {"upper": "raised", "cobra": "cobra", "init": "tucked"}


def set_arm(robot, posture):
    """In simulation: the gesture that looks like what the driver of the arm does."""
    moving = robot.gesture(_POSTURES[posture])
    try:
        while not moving.done:
            yield
    finally:
        moving.cancel()
    return moving.failure is None


def report(robot, state):
    """In simulation: the screen shows it."""
    robot.print(state)


def twist(robot, degrees):
    """By so many degrees to the left."""
    yield from turn_left(robot, degrees)


class Rover(Component):
    """Compares where the rover is with where its tracks can have taken it."""

    version = "1.0"
    slack = Parameter(0.3, low=0.05, high=2.0, unit="m", help="how far off the pose may be without being carried")
    moment = Parameter(2.0, low=0.0, high=60.0, unit="s", help="how long it counts as carried afterwards")

    def configure(self):
        """Knows nothing of where it was."""
        self._last, self._until = None, -inf

    def is_carried(self, robot):
        """Whether it is farther from its last pose than it can drive, or was a moment ago."""
        pose, now = robot.pose, robot.time
        if self._last is not None:
            x, y, then = self._last
            way = robot.max_speed * max(0.0, now - then) + self.slack
            if hypot(pose.x - x, pose.y - y) > way:
                self._until = now + self.moment
        self._last = pose.x, pose.y, now
        return now < self._until
