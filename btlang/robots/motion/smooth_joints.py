"""Joints that move within all their limits and never touch each other: movements are planned before they begin."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture, joints_of
from btlang.robots.motion.course import JointLimits, brake
from btlang.robots.motion.kinematics import Kinematics
from btlang.robots.motion.movements import KeyFrames, Movement, Steps, frames_of
from btlang.robots.motion.timeline import JointTimeline, PlannedMotion
from btlang.robots.robot import clip_targets, joint_of


class SmoothJoints:
    """Joints with planned movements, as a JointsPart. All begin at rest."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._names = [joint.name for joint in body.joints]
        self._limits = JointLimits.of(body.joints)
        self.timeline = JointTimeline(body, Kinematics(body))

    @property
    def moving(self) -> bool:
        """Whether any joint moves, or will; idle motion doesn't count."""
        return not self.timeline.is_free()

    @property
    def planned(self) -> SmoothJoints:
        return self

    def angle(self, name: str) -> float:
        """Return the angle of a joint. Raises RobotError for an unknown one."""
        return float(self.timeline.state.position[self._names.index(joint_of(self._body, name).name)])

    @property
    def angles(self) -> Mapping[str, float]:
        """The angles of all joints."""
        return dict(zip(self._names, self.timeline.state.position.tolist(), strict=True))

    def move(self, targets: Mapping[str, float]) -> None:
        """Move towards targets, clipped to the joints' limits.

        Raises RobotError, also if the body would touch itself.
        """
        wanted = clip_targets(self._body, targets)
        if wanted:
            self._play(self._steps([wanted]), None)

    def at_target(self, names: tuple[str, ...]) -> bool:
        """Return whether none of these joints is on its way; idle motion doesn't count."""
        return self.timeline.is_free([self._names.index(name) for name in names])

    def rests(self, names: Iterable[str]) -> bool:
        """Return whether none of these joints moves."""
        return self.timeline.rests([self._names.index(name) for name in names])

    def freeze(self, names: tuple[str, ...] | None = None) -> None:
        """Brake these joints to rest; with None all of them, from the next step on."""
        if names is None:
            self.timeline.halt()
        else:
            self.timeline.freeze(self._names.index(joint_of(self._body, name).name) for name in names)

    def step(self, dt: float) -> None:
        """Move on by `dt` seconds."""
        self.timeline.step(dt)

    def idle(self, targets: Mapping[str, float], least: float) -> bool:
        """Move to targets in at least so many seconds; return whether it does.

        It doesn't if the body would touch itself, or if one of these joints moves. `moving` ignores it, and anything
        else takes over.
        """
        wanted = clip_targets(self._body, targets)
        joints = [self._names.index(name) for name in wanted]
        here, goal = self.timeline.state.position[joints], np.array(list(wanted.values()))
        ways = zip(joints, np.abs(goal - here).tolist(), strict=True)
        seconds = max(least, *(self._body.joints[k].rest_to_rest_seconds(way) for k, way in ways))
        return self.timeline.idle(joints, goal, seconds)

    def play(self, wanted: Gesture | Sequence[Mapping[str, float]], room: float | None) -> tuple[PlannedMotion, float]:
        """Do a gesture or the steps of a posture, with its stroke in `room` seconds or as soon as possible.

        All of its angles are numbers. Also returns how many times as long it takes as it should. Raises RobotError if
        the body would touch itself.
        """
        made = self._play(self._movement(wanted), room)
        return made, made.slower

    def lead(self, wanted: Gesture | Sequence[Mapping[str, float]]) -> float:
        """Return the least seconds to the stroke."""
        movement = self._movement(wanted)
        return self.timeline.soonest(lambda planner, state: planner.soonest(movement, state))

    def _play(self, movement: Movement, room: float | None) -> PlannedMotion:
        return self.timeline.play(
            lambda planner, state, wait: planner.courses(movement, state, None if room is None else room - wait)
        )

    def _movement(self, wanted: Gesture | Sequence[Mapping[str, float]]) -> Movement:
        if not isinstance(wanted, Gesture):
            return self._steps(wanted)
        joints = self._joints(wanted)
        limits = self._limits.some(joints)
        settled = brake(self.timeline.state.of(joints), limits).end.position
        return KeyFrames(joints, frames_of(wanted, [self._names[index] for index in joints], settled), wanted, limits)

    def _joints(self, wanted: Gesture | Sequence[Mapping[str, float]]) -> list[int]:
        return sorted(self._names.index(joint_of(self._body, name).name) for name in joints_of(wanted))

    def _steps(self, steps: Sequence[Mapping[str, float]]) -> Steps:
        joints = self._joints(steps)
        row, rows = self.timeline.state.position[joints], []
        for step in steps:
            row = row.copy()
            row[[joints.index(self._names.index(name)) for name in step]] = list(step.values())
            rows.append(row)
        low, high = self._limits.low[joints], self._limits.high[joints]
        return Steps(joints, [np.clip(row, low, high) for row in rows], self._limits.some(joints))
