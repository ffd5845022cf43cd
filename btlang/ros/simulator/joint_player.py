"""Plays trajectories on smooth joints exactly, as joint trajectory controllers do."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import monotonic

import numpy as np
from trajectory_msgs.msg import JointTrajectory

from btlang.robots.bodies.body import Body
from btlang.robots.motion.course import PERIOD, CourseSegment, JointLimits, MotionState, on_quintic, to_state
from btlang.robots.motion.kinematics import Array
from btlang.robots.motion.movements import stay_at
from btlang.robots.motion.smooth_joints import SmoothJoints
from btlang.robots.motion.timeline import JointTimeline
from btlang.robots.robot import RobotError
from btlang.ros.messages import seconds_of
from btlang.ros.robot.joints import on_wire

_SILENCE = 0.5  # simulated and real seconds without a trajectory after which the joints brake
_FAR_OFF = 10.0  # seconds before its beginning and after its end in which a trajectory may come
_SAME, _SAME_SPEED = 0.001, 0.05  # seconds at the speed of a joint, and a share of that speed
_CATCHES_UP = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2)  # seconds in which it may join what has begun already
_TOLERANCE = 1.05  # of a limit


class JointPlayer:
    """A player of trajectories. A new one replaces the rest of the old one.

    One with a stamp has to be sent again while it is played, as velocities have to be: if its sender is silent, the
    joints brake. `clocks` returns the second of each clock that a stamp may be of, at the simulated second `now` of the
    joints.
    """

    def __init__(self, body: Body, joints: SmoothJoints, clocks: Callable[[], list[float]]) -> None:
        self._body, self._clocks = body, clocks
        self._timeline: JointTimeline = joints.timeline
        self._names = [on_wire(joint.name) for joint in body.joints]
        self._limits = JointLimits.of(body.joints)
        self._si = np.array([joint.si for joint in body.joints])
        self._playing: list[int] = []
        self._received = self._received_real = inf  # simulated and real second of the latest one to be sent again

    def play(self, message: JointTrajectory) -> None:
        """Play a trajectory. Raises RobotError if it can't be played; the joints then go on."""
        joints, times, way = self._read(message)
        stamp = seconds_of(message.header.stamp)
        now = self._timeline.seconds
        wait = min((stamp - each for each in self._clocks()), key=abs) if stamp else 0.0
        if not -_FAR_OFF - times[-1] < wait < _FAR_OFF:
            raise RobotError(f"its stamp is {abs(wait):.0f} s from now")
        times = times + now + wait
        self._received, self._received_real = (now, monotonic()) if stamp else (inf, inf)
        if others := set(self._playing) - set(joints):
            self._timeline.freeze(others)
        self._playing = joints
        begins = max(now, float(times[0]))
        if begins >= times[-1] and self._timeline.rests(joints):
            return
        at = self._join(joints, lambda seconds: _on(times, way, seconds), begins)
        self._timeline.follow(joints, at, begins, float(times[-1]))

    def watch(self) -> None:
        """Brake if the sender has fallen silent. Call this before each step."""
        quiet = self._timeline.seconds - self._received, monotonic() - self._received_real
        if min(quiet) > _SILENCE:
            self._timeline.freeze(self._playing)
            self._received = self._received_real = inf

    def _read(self, message: JointTrajectory) -> tuple[list[int], Array, MotionState]:
        """Return its joints, the seconds of its points and their states. Raises RobotError."""
        unknown = [name for name in message.joint_names if name not in self._names]
        if unknown or len(set(message.joint_names)) != len(message.joint_names):
            raise RobotError(f"it has no joint {unknown[0]}" if unknown else "it names a joint twice")
        joints = [self._names.index(name) for name in message.joint_names]
        points = message.points
        if any({len(point.positions), len(point.velocities)} != {len(joints)} for point in points):
            raise RobotError("a point needs a position and a velocity for each joint")
        times = np.array([seconds_of(point.time_from_start) for point in points])
        position, velocity = (
            np.array([getattr(point, name) for point in points]) / self._si[joints]
            for name in ("positions", "velocities")
        )
        limits = self._limits.some(joints)
        if (np.diff(times) <= 0.0).any() or times[0] < 0.0:
            raise RobotError("its times don't rise")
        if not (np.isfinite(position).all() and (np.abs(velocity) <= limits.speed * _TOLERANCE).all()):
            raise RobotError("a joint would be too fast, or nowhere")
        acceleration = np.gradient(velocity, times, axis=0) if len(times) > 1 else 0.0 * velocity
        return joints, times, MotionState(np.clip(position, limits.low, limits.high), velocity, acceleration)

    def _join(
        self, joints: list[int], at: Callable[[Array], MotionState], begins: float
    ) -> Callable[[Array], MotionState]:
        """Return how the joints get to a movement that has begun already. Raises RobotError if they can't."""
        tick = PERIOD * np.ceil(begins / PERIOD - 1e-6)
        now, wanted = self._timeline.at(tick).of(joints), at(np.array([tick]))
        off, faster = np.abs(wanted.position[0] - now.position), np.abs(wanted.velocity[0] - now.velocity)
        limits = self._limits.some(joints)
        if (off <= _SAME * limits.speed).all() and (faster <= _SAME_SPEED * limits.speed).all():
            return at
        for within in _CATCHES_UP:
            goal = at(np.array([tick + within])).rows(0)
            piece = to_state(now, goal, limits, within)
            if piece is not None and piece.seconds <= within + 1e-6:
                return _first(piece, tick, at)
        self._timeline.freeze(joints)
        raise RobotError("the joints are too far from where it begins")


def _first(piece: CourseSegment, begins: float, at: Callable[[Array], MotionState]) -> Callable[[Array], MotionState]:
    def joined(seconds: Array) -> MotionState:
        early, late = piece.at(np.clip(seconds - begins, 0.0, piece.seconds)), at(seconds)
        joins = (seconds < begins + piece.seconds)[:, None]
        return MotionState(*(np.where(joins, getattr(early, name), getattr(late, name)) for name in MotionState.fields))

    return joined


def _on(times: Array, way: MotionState, seconds: Array) -> MotionState:
    """Return the states at some seconds; before and after the points the joints rest."""
    if len(times) == 1:
        return stay_at(way.position[0])(seconds)
    before = np.clip(np.searchsorted(times, seconds, side="right") - 1, 0, len(times) - 2)
    start, end = way.rows(before), way.rows(before + 1)
    return on_quintic(start, end, (times[before + 1] - times[before])[:, None], seconds - times[before])
