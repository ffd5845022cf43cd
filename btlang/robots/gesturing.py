"""Gestures of any body: planned where its joints are smooth, else step by step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from btlang.robots.body import Body
from btlang.robots.capabilities import Operation
from btlang.robots.geometry import Point, Pose
from btlang.robots.gesture import Gesture
from btlang.robots.parts import SmoothPart
from btlang.robots.robot import RobotError
from btlang.robots.turning import Angles, turned


class Turnable(Protocol):
    """Joints of any robot; see btlang.robots.joints.Joints."""

    def angle(self, name: str) -> float: ...
    def move(self, targets: Angles) -> None: ...
    def at_target(self, names: tuple[str, ...]) -> bool: ...
    def freeze(self, names: tuple[str, ...]) -> None: ...


class Stepped:
    """See Operation: steps of joints whose movements aren't planned, the first after so many seconds."""

    def __init__(self, joints: Turnable, steps: Sequence[tuple[float, Angles]], after: float) -> None:
        self._joints, self._steps = joints, list(steps)
        self._passed, self._names = -after, tuple({name for _, step in steps for name in step})
        self._going: tuple[str, ...] = ()
        self.done = False
        self.failure: str | None = None
        self.step(0.0)

    def cancel(self) -> None:
        """Its joints stay where they are."""
        if not self.done:
            self.end(None)
            self._joints.freeze(self._names)

    def end(self, failure: str | None) -> None:
        """It is over, if it wasn't before."""
        if not self.done:
            self.done, self.failure = True, failure

    def step(self, dt: float) -> None:
        """Goes on to the next step once one is done and its second has come."""
        self._passed += dt
        try:
            if self.done or self._passed < 0.0 or not self._joints.at_target(self._going):
                return
            if not self._steps:
                self.end(None)
            elif self._passed >= self._steps[0][0]:
                _, targets = self._steps.pop(0)
                self._going = tuple(targets)
                self._joints.move(targets)
        except RobotError as problem:
            self.end(str(problem))


class Gestures:
    """Those of a robot."""

    def __init__(self, body: Body, joints: Turnable) -> None:
        self._body, self._joints = body, joints
        self._stepped: list[Stepped] = []

    def start(
        self, name: str, pose: Callable[[], Pose], aim: Point | None, room: float | None
    ) -> tuple[Operation, float]:
        """See btlang.robots.capabilities.Gesturing.gesture; `room` is the time to the stroke in seconds, `pose` says
        where the robot is.

        Gives how many times as long it takes as it should, too: limits of the joints may slow it.
        """
        wanted = self._turned(name, pose, aim)
        if isinstance(self._joints, SmoothPart):
            return self._joints.play(wanted, room)
        made = Stepped(self._joints, _steps(wanted), max(0.0, (room or 0.0) - self._lead(wanted)))
        self._stepped.append(made)
        return made, 1.0

    def lead(self, name: str, pose: Callable[[], Pose], aim: Point | None) -> float:
        """See btlang.robots.capabilities.Gesturing."""
        wanted = self._turned(name, pose, aim)
        return self._joints.lead(wanted) if isinstance(self._joints, SmoothPart) else self._lead(wanted)

    def stop(self) -> None:
        """No further step is taken; whoever calls it freezes the joints. For any thread."""
        for stepped in tuple(self._stepped):
            stepped.end("the robot was stopped")

    def step(self, dt: float) -> None:
        """So many seconds have passed, in which the joints have moved."""
        for stepped in self._stepped:
            stepped.step(dt)
        self._stepped = [stepped for stepped in self._stepped if not stepped.done]

    def _turned(self, name: str, pose: Callable[[], Pose], aim: Point | None) -> Gesture | Sequence[Angles]:
        found = self._body.gestures.get(name) or self._body.postures.get(name)
        if not found:
            raise RobotError(f'the robot has no gesture "{name}"')
        return turned(self._body, found, pose, aim, self._joints.angle)

    def _lead(self, wanted: Gesture | Sequence[Angles]) -> float:
        if isinstance(wanted, Gesture):
            return wanted.stroke
        speeds = {joint.name: joint.speed for joint in self._body.joints}
        return max((abs(to - self._joints.angle(name)) / speeds[name] for name, to in wanted[0].items()), default=0.0)


def _steps(wanted: Gesture | Sequence[Angles]) -> list[tuple[float, Angles]]:
    """With the second from which each may be taken."""
    if not isinstance(wanted, Gesture):
        return [(0.0, step) for step in wanted]
    begins = [0.0, *(frame.at + frame.hold for frame in wanted.frames)]
    angles = [{name: float(value) for name, value in frame.joints.items()} for frame in wanted.frames]
    return list(zip(begins, angles, strict=False))
