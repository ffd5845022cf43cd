"""Gestures and postures turned to what they are about: all of their angles become numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import cos, radians, sin

from btlang.robots.body import Body, Vector
from btlang.robots.geometry import Point, Pose
from btlang.robots.gesture import BEARINGS, Gesture, KeyFrame, Step, angle_of
from btlang.robots.joints import clipped, joint_of
from btlang.robots.robot import RobotError

HEIGHT = 1.0
"""Metres above the floor of what a gesture points at."""
_FAR = 90.0  # degrees to the side beyond which something is behind

Angles = Mapping[str, float]


def turned(
    body: Body,
    wanted: Gesture | Sequence[Step],
    pose: Callable[[], Pose],
    aim: Point | None,
    angle: Callable[[str], float],
) -> Gesture | Sequence[Angles]:
    """A gesture, or the steps of a posture, for a point of the map: `pose` says where the robot is, `angle` its joints.

    Raises RobotError where that is out of reach.
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
        found = _aimed(body, wanted.aim, begun, point, angle)
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
    return clipped(body, {name: angle_of(value, bearing) for name, value in step.items()})


def _aimed(body: Body, part: str, begun: Angles, aim: Vector, angle: Callable[[str], float]) -> Angles | None:
    import numpy as np

    from btlang.robots.motion.aiming import Aiming
    from btlang.robots.motion.kinematics import Kinematics

    at = np.array([begun[joint.name] if joint.name in begun else angle(joint.name) for joint in body.joints])
    return Aiming(body, Kinematics(body)).angles(part, at, aim)


def _out_of_reach(part: str, bearing: float) -> RobotError:
    where = "behind the robot" if abs(bearing) > _FAR else "out of reach"
    return RobotError(f"that is {where}; the {part} can't turn that far")
