"""`btc gesture record`: poses that somebody moves the robot to by hand, or types, become a gesture."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator

from btlang.backends.files import write_file
from btlang.devices.driver import DeviceError
from btlang.gestures.loose_joints import loose, servos_of
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture_file import GestureError, load_gestures
from btlang.robots.files import as_mission_error
from btlang.text.output import show
from btlang.text.source import Source
from btlang.text.toml_writing import toml_key, toml_value

Pose = dict[str, float]
_LEAST = 0.5  # seconds between two poses
_SMOOTH = 2.2  # times as long as at top speed, for a smooth start and end
_HELP = "Enter takes the pose, 'end' writes the file."
_TYPED = "Type joints with their angles, such as: head tilt = -15, head turn = 20. 'end' writes the file."


def record(name: str, path: str, body: Body, over: str) -> int:
    """Takes poses from standard input until it ends, and writes the gesture; returns the exit code.

    Where the robot has servos, they are loose meanwhile. Ctrl-C writes nothing. Raises MissionError (BT071 for devices
    that can't be used, BT076 for poses that can't make a gesture).
    """
    if over != "devices" or not servos_of(body):
        show(f"The robot runs {over}, so nobody can move it by hand. {_TYPED}", sys.stderr)
        return _write(name, path, body, poses_of(sys.stdin, body, None))
    with loose(body) as read:
        show(f"The joints are loose: hold the robot, then move it. {_HELP}", sys.stderr)
        poses = list(poses_of(sys.stdin, body, read))
    return _write(name, path, body, poses)


def poses_of(lines: Iterable[str], body: Body, read: Callable[[], Pose] | None) -> Iterator[Pose]:
    """The pose of each line that has one; what is wrong with a line is said."""
    for line in lines:
        if line.strip() == "end":
            return
        try:
            if line.strip():
                pose = _typed(line, body)
            elif read is None:
                raise ValueError(_TYPED)
            else:
                pose = read()
        except (ValueError, DeviceError) as problem:
            show(str(problem), sys.stderr)
            continue
        show(", ".join(f"{joint} = {angle:g}" for joint, angle in pose.items()), sys.stderr)
        yield pose


def text_of(name: str, body: Body, poses: Iterable[Pose]) -> str:
    """The file of a gesture: one key frame for each pose, as far apart as the joints need."""
    at, last = 0.0, {joint.name: joint.rest for joint in body.joints}
    text = f"name = {toml_value(name)}\n"
    for pose in poses:
        needs = [
            _SMOOTH * abs(pose[joint.name] - last[joint.name]) / joint.speed
            for joint in body.joints
            if joint.name in pose
        ]
        at = round(at + max(_LEAST, *needs), 2)
        last |= pose
        text += f"\n[[frame]]\nat = {at:g}\n"
        text += "".join(f"{toml_key(joint)} = {toml_value(round(angle, 3))}\n" for joint, angle in pose.items())
    return text


def _write(name: str, path: str, body: Body, poses: Iterable[Pose]) -> int:
    found = list(poses)
    if not found:
        show("There is no pose, so nothing was written.", sys.stderr)
        return 1
    text = text_of(name, body, found)
    try:
        load_gestures(Source(text, path), body.joints)
    except GestureError as error:
        raise as_mission_error(error) from None
    write_file(path, text)
    show(f"Wrote {path}: {len(found)} key frames.")
    return 0


def _typed(line: str, body: Body) -> Pose:
    pose: Pose = {}
    for part in line.split(","):
        name, equals, text = (piece.strip() for piece in part.partition("="))
        joint = body.joint(name)
        if joint is None:
            listed = ", ".join(each.name for each in body.joints)
            raise ValueError(f'the robot has no joint "{name}"; its joints are {listed}')
        try:
            angle = float(text) if equals else float("nan")
        except ValueError:
            angle = float("nan")
        if not joint.low <= angle <= joint.high:
            raise ValueError(f'"{name}" must be a number from {joint.low:g} to {joint.high:g}')
        pose[name] = angle
    return pose
