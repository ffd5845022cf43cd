"""Gestures of any body: planned where its joints are smooth, else step by step."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, radians, sin

from btlang.robots.body import Body, Vector
from btlang.robots.capabilities import Operation
from btlang.robots.geometry import Point, Pose
from btlang.robots.gesture import Gesture, Step, angle_of
from btlang.robots.joints import clipped
from btlang.robots.parts import JointsPart, SmoothPart
from btlang.robots.robot import RobotError

HEIGHT = 1.0
"""Metres above the floor of what a gesture points at."""


class Stepped:
    """See Operation: steps of joints that have no acceleration, the first after so many seconds."""

    def __init__(self, joints: JointsPart, steps: Sequence[tuple[float, dict[str, float]]], after: float) -> None:
        self._joints, self._steps = joints, list(steps)
        self._passed, self._names = -after, tuple({name for _, step in steps for name in step})
        self._going: tuple[str, ...] = ()
        self.done = False
        self.failure: str | None = None
        self.step(0.0)

    def cancel(self) -> None:
        """Its joints stay where they are."""
        if not self.done:
            self.done = True
            self._joints.freeze(self._names)

    def step(self, dt: float) -> None:
        """Goes on to the next step once one is done and its second has come."""
        self._passed += dt
        if self.done or self._passed < 0.0 or not self._joints.at_target(self._going):
            return
        if not self._steps:
            self.done = True
        elif self._passed >= self._steps[0][0]:
            _, targets = self._steps.pop(0)
            self._going = tuple(targets)
            self._joints.move(targets)


class Gestures:
    """Those of a robot."""

    def __init__(self, body: Body, joints: JointsPart) -> None:
        self._body, self._joints = body, joints
        self._stepped: list[Stepped] = []

    def start(self, name: str, pose: Pose, aim: Point | None, room: float | None) -> tuple[Operation, float]:
        """See btlang.robots.capabilities.Gesturing.gesture; `room` is the time to the stroke in seconds.

        Gives how many times as long it takes as it should, too: limits of the joints may slow it.
        """
        wanted = self._known(name)
        bearing, point = _seen_from(pose, aim)
        if isinstance(self._joints, SmoothPart):
            return self._joints.play(wanted, bearing, point, room)
        steps = self._steps(wanted, bearing)
        made = Stepped(self._joints, steps, max(0.0, (room or 0.0) - self._lead(wanted, bearing)))
        self._stepped.append(made)
        return made, 1.0

    def lead(self, name: str, pose: Pose, aim: Point | None) -> float:
        """See btlang.robots.capabilities.Gesturing."""
        wanted = self._known(name)
        bearing, point = _seen_from(pose, aim)
        if isinstance(self._joints, SmoothPart):
            return self._joints.lead(wanted, bearing, point)
        return self._lead(wanted, bearing)

    def stop(self) -> None:
        """All joints come to rest. For any thread."""
        for stepped in tuple(self._stepped):
            if not stepped.done:
                stepped.done, stepped.failure = True, "the robot was stopped"
        self._joints.freeze()

    def step(self, dt: float) -> None:
        """So many seconds have passed, in which the joints have moved."""
        for stepped in self._stepped:
            stepped.step(dt)
        self._stepped = [stepped for stepped in self._stepped if not stepped.done]

    def _known(self, name: str) -> Gesture | Sequence[Step]:
        found = self._body.gestures.get(name) or self._body.postures.get(name)
        if not found:
            raise RobotError(f'the robot has no gesture "{name}"')
        return found

    def _steps(self, wanted: Gesture | Sequence[Step], bearing: float) -> list[tuple[float, dict[str, float]]]:
        frames = [(frame.at, frame.hold, frame.joints) for frame in wanted.frames] if isinstance(wanted, Gesture) else [
            (0.0, 0.0, step) for step in wanted
        ]  # fmt: skip
        steps, begin = [], 0.0
        for at, hold, joints in frames:
            turned = {name: angle_of(value, bearing) for name, value in joints.items()}
            steps.append((begin, clipped(self._body, turned)))
            begin = at + hold
        return steps

    def _lead(self, wanted: Gesture | Sequence[Step], bearing: float) -> float:
        if isinstance(wanted, Gesture):
            return wanted.stroke
        _, first = self._steps(wanted, bearing)[0]
        return max((abs(to - self._joints.angle(name)) / self._speed(name) for name, to in first.items()), default=0.0)

    def _speed(self, name: str) -> float:
        joint = self._body.joint(name)
        return joint.speed if joint is not None else 1.0


def _seen_from(pose: Pose, aim: Point | None) -> tuple[float, Vector | None]:
    if aim is None:
        return 0.0, None
    bearing, distance = pose.bearing_to(aim), pose.distance_to(aim)
    return bearing, (distance * cos(radians(bearing)), distance * sin(radians(bearing)), HEIGHT)
