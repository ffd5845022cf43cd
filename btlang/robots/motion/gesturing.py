"""Gestures of any body, turned to what they are about, and what a robot does with joints that nothing else moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import cos, radians, sin
from typing import Protocol

from btlang.robots.bodies.body import Body, Breathing, Vector
from btlang.robots.bodies.gesture import BEARINGS, Gesture, KeyFrame, Step, angle_of
from btlang.robots.bodies.joint_tables import LOOK_AT
from btlang.robots.geometry import Point, Pose
from btlang.robots.parts import IdlePart, SmoothPart
from btlang.robots.robot import Operation, RobotError, clip_targets, joint_of

HEIGHT = 1.0
"""Metres above the floor of a gesture's target."""
_FAR = 90.0  # degrees to the side beyond which something is behind

Angles = Mapping[str, float]
_LOOKS = 4.0  # seconds at somebody who has spoken
_TURNS = 0.5  # seconds at least until the head has turned
_OFF = 5.0  # degrees from where it should look
_SAME = 1e-3  # degrees
_AGAIN = 0.5  # seconds until something that can't be done is tried again
_COARSE = 1.0  # seconds between two steps from which on nobody watches


def turn_to_point(
    body: Body,
    wanted: Gesture | Sequence[Step],
    pose: Callable[[], Pose],
    aim: Point | None,
    angle: Callable[[str], float],
) -> Gesture | Sequence[Angles]:
    """Return a gesture, or the steps of a posture, turned to a point of the map.

    `pose` is where the robot is, `angle` returns the angle of a joint. Raises RobotError if the point is out of reach.
    """
    here = pose() if aim is not None else Pose(0.0, 0.0)
    bearing = here.bearing_to(aim) if aim is not None else 0.0
    if not isinstance(wanted, Gesture):
        return [_angles(body, step, bearing) for step in wanted]
    wanted = wanted.towards(bearing)
    frames = [KeyFrame(frame.at, _angles(body, frame.joints, bearing), frame.hold) for frame in wanted.frames]
    if wanted.aim and aim is not None:
        at = wanted.stroke_frame
        begun = {name: float(value) for frame in frames[: at + 1] for name, value in frame.joints.items()}
        metres, around = here.distance_to(aim), radians(bearing)
        point = (metres * cos(around), metres * sin(around), HEIGHT)
        found = _aim(body, wanted.aim, begun, point, angle)
        if found is None:
            raise _out_of_reach(wanted.aim, bearing)
        frames[at] = frames[at].replace(joints={**frames[at].joints, **found})
    made: Gesture = wanted.replace(frames=tuple(frames))
    return made


def _angles(body: Body, step: Step, bearing: float) -> Angles:
    for name, value in step.items():
        joint = joint_of(body, name)
        if value in BEARINGS and not joint.low <= angle_of(value, bearing) <= joint.high:
            raise _out_of_reach(joint.part, bearing)
    return clip_targets(body, {name: angle_of(value, bearing) for name, value in step.items()})


def _aim(body: Body, part: str, begun: Angles, aim: Vector, angle: Callable[[str], float]) -> Angles | None:
    import numpy as np

    from btlang.robots.motion.kinematics import AimSolver, Kinematics

    at = np.array([begun[joint.name] if joint.name in begun else angle(joint.name) for joint in body.joints])
    return AimSolver(body, Kinematics(body)).angles(part, at, aim)


def _out_of_reach(part: str, bearing: float) -> RobotError:
    where = "behind the robot" if abs(bearing) > _FAR else "out of reach"
    return RobotError(f"that is {where}; the {part} can't turn that far")


class TurnableJoints(Protocol):
    """Joints of any robot; see SimulatedJoints."""

    def angle(self, name: str) -> float: ...
    def move(self, targets: Angles) -> None: ...
    def at_target(self, names: tuple[str, ...]) -> bool: ...
    def freeze(self, names: tuple[str, ...] = ...) -> None: ...


class SteppedGesture:
    """Steps of joints without planned movements, as an Operation; the first begins after so many seconds."""

    def __init__(self, joints: TurnableJoints, steps: Sequence[tuple[float, Angles]], after: float) -> None:
        self._joints, self._steps = joints, list(steps)
        self._passed, self._names = -after, tuple({name for _, step in steps for name in step})
        self._going: tuple[str, ...] = ()
        self.done = False
        self.failure: str | None = None
        self.step(0.0)

    def cancel(self) -> None:
        """Hold its joints where they are."""
        if not self.done:
            self.end(None)
            self._joints.freeze(self._names)

    def end(self, failure: str | None) -> None:
        """End the steps, unless they have ended."""
        if not self.done:
            self.done, self.failure = True, failure

    def step(self, dt: float) -> None:
        """Go on to the next step once one is done and the second of the next has come."""
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
    """The gestures of one robot."""

    def __init__(self, body: Body, joints: TurnableJoints) -> None:
        self._body, self._joints = body, joints
        self._stepped: list[SteppedGesture] = []

    def start(
        self, name: str, pose: Callable[[], Pose], aim: Point | None, room: float | None
    ) -> tuple[Operation, float]:
        """Start a gesture, as Gesturing does; `room` is the seconds to the stroke, `pose` returns where the robot is.

        Also returns how many times as long it takes as it should: limits of the joints may slow it.
        """
        wanted = self._turn(name, pose, aim)
        if isinstance(self._joints, SmoothPart):
            return self._joints.play(wanted, room)
        made = SteppedGesture(self._joints, _steps(wanted), max(0.0, (room or 0.0) - self._lead(wanted)))
        self._stepped.append(made)
        return made, 1.0

    def lead(self, name: str, pose: Callable[[], Pose], aim: Point | None) -> float:
        wanted = self._turn(name, pose, aim)
        return self._joints.lead(wanted) if isinstance(self._joints, SmoothPart) else self._lead(wanted)

    def stop(self) -> None:
        """Take no further step; the caller holds the joints. For any thread."""
        for stepped in tuple(self._stepped):
            stepped.end("the robot was stopped")

    def step(self, dt: float) -> None:
        """Go on after so many seconds, in which the joints have moved."""
        for stepped in self._stepped:
            stepped.step(dt)
        self._stepped = [stepped for stepped in self._stepped if not stepped.done]

    def _turn(self, name: str, pose: Callable[[], Pose], aim: Point | None) -> Gesture | Sequence[Angles]:
        found = self._body.gestures.get(name) or self._body.postures.get(name)
        if not found:
            raise RobotError(f'the robot has no gesture "{name}"')
        return turn_to_point(self._body, found, pose, aim, self._joints.angle)

    def _lead(self, wanted: Gesture | Sequence[Angles]) -> float:
        if isinstance(wanted, Gesture):
            return wanted.stroke
        speeds = {joint.name: joint.speed for joint in self._body.joints}
        return max((abs(to - self._joints.angle(name)) / speeds[name] for name, to in wanted[0].items()), default=0.0)


def _steps(wanted: Gesture | Sequence[Angles]) -> list[tuple[float, Angles]]:
    """Return the steps, each with the second from which it may begin."""
    if not isinstance(wanted, Gesture):
        return [(0.0, step) for step in wanted]
    begins = [0.0, *(frame.at + frame.hold for frame in wanted.frames)]
    angles = [{name: float(value) for name, value in frame.joints.items()} for frame in wanted.frames]
    return list(zip(begins, angles, strict=False))


class Idling:
    """The idle motion of a robot; `place` returns where somebody is, `pose` where the robot is.

    Nothing begins before it is `on`.
    """

    def __init__(
        self, body: Body, joints: IdlePart, place: Callable[[str], Point | None], pose: Callable[[], Pose]
    ) -> None:
        self._body, self._joints, self._place, self._pose = body, joints, place, pose
        self.on = False
        self._tries_in = 0.0
        self._middle, self._side = float("nan"), 1.0
        self._who, self._left = "", 0.0
        self._home: Mapping[str, float] = {}
        self._turned: Mapping[str, float] = {}

    def halt(self) -> None:
        """Begin nothing until it is `on` again; the caller halts the joints. For any thread."""
        self.on, self._who, self._turned = False, "", {}

    def attend(self, who: str) -> None:
        """Look at somebody who speaks with the robot; "" if nobody knows who."""
        if who and self._body.idle.look_at_speaker:
            self._who, self._left = who, _LOOKS

    def step(self, dt: float) -> None:
        """Go on after so many seconds."""
        self._left -= dt
        self._tries_in -= dt
        if not self.on or dt >= _COARSE or self._tries_in > 0.0:
            return
        if self._body.idle.breathing is not None:
            self._breathe(self._body.idle.breathing)
        if self._who or self._home:
            self._look()

    def _breathe(self, breathing: Breathing) -> None:
        planned = self._joints.planned
        if not planned.rests((breathing.joint,)):
            return
        joint, at = self._body.joint(breathing.joint), planned.angle(breathing.joint)
        assert joint is not None
        if not abs(at - self._middle) <= breathing.by + _SAME:
            self._middle = min(joint.high - breathing.by, max(joint.low + breathing.by, at))
        if self._begin({joint.name: self._middle + self._side * breathing.by}, breathing.every / 2):
            self._side = -self._side

    def _look(self) -> None:
        """Look at who speaks, then back to where the head was, unless something else has moved it since."""
        names = list(self._body.postures[LOOK_AT][0])
        planned = self._joints.planned
        if not planned.rests(names):
            if not planned.at_target(tuple(names)):
                self._home = self._turned = {}
            return
        at = {name: planned.angle(name) for name in names}
        if any(abs(at[name] - angle) > _SAME for name, angle in self._turned.items()):
            self._home = self._turned = {}
        if self._left > 0.0 and self._who:
            wanted = self._aim()
            if any(abs(at[name] - angle) > _OFF for name, angle in wanted.items()) and self._begin(wanted, _TURNS):
                self._home, self._turned = self._home or at, wanted
            return
        self._who = ""
        if self._home and self._begin(self._home, _TURNS):
            self._home = self._turned = {}

    def _aim(self) -> Mapping[str, float]:
        """Return the joint angles to look at who speaks; empty if the head can't, or nobody knows where they are."""
        try:
            place = self._place(self._who)
            steps = turn_to_point(
                self._body, self._body.postures[LOOK_AT], self._pose, place, self._joints.planned.angle
            )
        except RobotError:
            return {}
        return steps[0] if place is not None and not isinstance(steps, Gesture) else {}

    def _begin(self, targets: Mapping[str, float], least: float) -> bool:
        found = self._joints.idle(targets, least)
        if not found:
            self._tries_in = _AGAIN
        return found
