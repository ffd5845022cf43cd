"""Joints that move within all their limits and never touch each other: movements are planned before they begin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from btlang.robots.body import Body, Vector
from btlang.robots.gesture import BEARINGS, Gesture, Step, angle_of
from btlang.robots.joints import clipped, joint_of
from btlang.robots.motion.aiming import Aiming
from btlang.robots.motion.braking import brake
from btlang.robots.motion.course import Limits
from btlang.robots.motion.kinematics import Kinematics
from btlang.robots.motion.movements import KeyFrames, Movement, Steps, frames_of, stroke_frame
from btlang.robots.motion.timeline import Play, Timeline
from btlang.robots.robot import RobotError

_FAR = 90.0  # degrees to the side beyond which something is behind


class SmoothJoints:
    """See btlang.robots.parts.JointsPart. All joints begin at rest."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._names = [joint.name for joint in body.joints]
        self._limits = Limits.of(body.joints)
        kinematics = Kinematics(body)
        self._aiming = Aiming(body, kinematics)
        self.timeline = Timeline(body, kinematics)

    @property
    def moving(self) -> bool:
        """True while any joint is on its way, or will be."""
        return not self.timeline.rests()

    def angle(self, name: str) -> float:
        """Raises RobotError for an unknown joint."""
        return float(self.timeline.state.position[self._names.index(joint_of(self._body, name).name)])

    @property
    def angles(self) -> Mapping[str, float]:
        """Of all joints."""
        return dict(zip(self._names, self.timeline.state.position.tolist(), strict=True))

    def move(self, targets: Mapping[str, float]) -> None:
        """Sets off towards the targets, clipped to the joints' limits. Raises RobotError, also where the body would
        touch itself.
        """
        wanted = clipped(self._body, targets)
        if wanted:
            self._play(self._steps([wanted]), None)

    def at_target(self, names: tuple[str, ...]) -> bool:
        """True when none of them is on its way."""
        return self.timeline.rests([self._names.index(name) for name in names])

    def freeze(self, names: tuple[str, ...] | None = None) -> None:
        """They come to rest; None: all of them, from the next step on."""
        if names is None:
            self.timeline.halt()
        else:
            self.timeline.freeze(self._names.index(joint_of(self._body, name).name) for name in names)

    def step(self, dt: float) -> None:
        """Moves on by `dt` seconds."""
        self.timeline.step(dt)

    def play(
        self, wanted: Gesture | Sequence[Step], bearing: float, aim: Vector | None, room: float | None
    ) -> tuple[Play, float]:
        """Sets off to do a gesture or the steps of a posture, with its stroke in `room` seconds or as soon as it can.

        What it is turned to is `bearing` degrees to the left, at the point `aim` of the frame of the base. Raises
        RobotError where that is out of reach, and where the body would touch itself. Gives how many times as long it
        takes as it should, too.
        """
        made = self._play(self._movement(wanted, bearing, aim), room)
        return made, made.slower

    def lead(self, wanted: Gesture | Sequence[Step], bearing: float, aim: Vector | None) -> float:
        """Seconds to the stroke at least. Raises RobotError as `play` does for what is out of reach."""
        movement = self._movement(wanted, bearing, aim)
        return self.timeline.soonest(lambda planner, state: planner.soonest(movement, state))

    def _play(self, movement: Movement, room: float | None) -> Play:
        return self.timeline.play(
            lambda planner, state, wait: planner.courses(movement, state, None if room is None else room - wait)
        )

    def _movement(self, wanted: Gesture | Sequence[Step], bearing: float, aim: Vector | None) -> Movement:
        steps = [frame.joints for frame in wanted.frames] if isinstance(wanted, Gesture) else wanted
        for step in steps:
            for name, value in step.items():
                joint = joint_of(self._body, name)
                if value in BEARINGS and not joint.low <= angle_of(value, bearing) <= joint.high:
                    raise _out_of_reach(joint.part, bearing)
        if not isinstance(wanted, Gesture):
            turned = [{name: angle_of(value, bearing) for name, value in step.items()} for step in steps]
            return self._steps([clipped(self._body, step) for step in turned])
        names = {name for step in steps for name in step}
        aimed: Mapping[str, float] = {}
        if wanted.aim and aim is not None:
            at = self.timeline.state.position.copy()
            for frame in wanted.frames[: stroke_frame(wanted) + 1]:
                for name, value in frame.joints.items():
                    at[self._names.index(name)] = angle_of(value, bearing)
            found = self._aiming.angles(wanted.aim, at, aim)
            if found is None:
                raise _out_of_reach(wanted.aim, bearing)
            aimed = found
        joints = [index for index, name in enumerate(self._names) if name in names or name in aimed]
        ordered = [self._names[index] for index in joints]
        limits = self._limits.some(joints)
        settled = brake(self.timeline.state.of(joints), limits).end.position
        frames = frames_of(wanted, ordered, settled, bearing, aimed)
        return KeyFrames(joints, frames, wanted, limits)

    def _steps(self, steps: Sequence[Mapping[str, float]]) -> Steps:
        names = {name for step in steps for name in step}
        joints = [index for index, name in enumerate(self._names) if name in names]
        row, rows = self.timeline.state.position[joints], []
        for step in steps:
            row = row.copy()
            row[[joints.index(self._names.index(name)) for name in step]] = list(step.values())
            rows.append(row)
        low, high = self._limits.low[joints], self._limits.high[joints]
        return Steps(joints, [np.clip(row, low, high) for row in rows], self._limits.some(joints))


def _out_of_reach(part: str, bearing: float) -> RobotError:
    where = "behind the robot" if abs(bearing) > _FAR else "out of reach"
    return RobotError(f"that is {where}; the {part} can't turn that far")
