"""`btc gesture record`: poses that somebody moves the robot to by hand, or types, become a gesture."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager

from btlang.devices.device_set import DeviceSet
from btlang.devices.driver import SIMULATED, Device, DeviceError
from btlang.devices.kinds import JointState, JointTarget
from btlang.diagnostics.files import write_file
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.bodies.gesture_file import GestureError, load_gestures
from btlang.robots.files import as_mission_error
from btlang.robots.robot import joint_of
from btlang.support.interrupts import interrupts_later
from btlang.text.output import show
from btlang.text.source import Source
from btlang.text.toml import toml_key, toml_value

_EACH = 0.1  # seconds between two commands that keep servos loose
_WAITS = 2.0  # seconds until servos must have let go, or hold again
_LOOKS = 0.02  # seconds between two looks at them meanwhile
_SLOW = 5.0  # degrees a second at most until a servo holds
Pose = dict[str, float]
_LEAST = 0.5  # seconds between two poses
_SMOOTH = 2.2  # times as long as at top speed, for a smooth start and end
_HELP = "Enter takes the pose, 'end' writes the file."
_TYPED = "Type joints with their angles, such as: head tilt = -15, head turn = 20. 'end' writes the file."


def servos_of(body: Body) -> tuple[Device, ...]:
    """Return the real servos of a robot's joints."""
    return tuple(each for each in body.devices if each.driver != SIMULATED and body.joint(each.name) is not None)


@contextmanager
def loose(body: Body) -> Iterator[Callable[[], dict[str, float]]]:
    """Yield a body's servos without torque, and a reader of their positions; at the end they hold there.

    Raises MissionError (BT071) if one can't be used. The reader raises DeviceError for a silent servo, and ValueError
    for one that was moved beyond the limits of its joint.
    """
    servos = _Servos(body)
    try:
        try:
            servos.release()
        except DeviceError as problem:
            raise unusable_robot(problem) from None
        yield servos.pose
    finally:
        with interrupts_later():
            servos.hold()
            servos.devices.close()


class _Servos:
    """Servos, and a thread that repeats their commands, as their loop requires."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._names = [servo.name for servo in servos_of(body)]
        try:
            self.devices = DeviceSet(body.replace(devices=servos_of(body)), None, _ignore)
        except DeviceError as problem:
            raise unusable_robot(problem) from None
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._keep, name="loose joints", daemon=True)

    def release(self) -> None:
        """Take their torque away. Raises DeviceError if one is silent."""
        self.devices.start()
        self._thread.start()
        for name in self._until(lambda name: self._state(name).loose):
            self._state(name)
            raise DeviceError(f"the {name} doesn't let go")

    def hold(self) -> None:
        """Hold the servos where they are; report the silent ones, which stay as they are."""
        self._done.set()
        if self._thread.ident is not None:
            self._thread.join()
        for name in self._until(self._holds):
            show(f"The {name} can't be told to hold its place.", sys.stderr)
        for name in self._names:
            self.devices.readers[name].write(name, JointTarget())

    def pose(self) -> dict[str, float]:
        """Return the positions of the servos; see `loose`."""
        self._until(lambda name: bool(self._state(name)))  # one may be silent for a moment
        return {name: self._angle(name) for name in self._names}

    def _angle(self, name: str) -> float:
        joint, at = joint_of(self._body, name), self._state(name).position
        within = min(joint.high, max(joint.low, at))
        if abs(at - within) > joint.close_enough:
            says = f"it goes from {joint.low:g} to {joint.high:g}"
            raise ValueError(f"the {name} is at {at:.4g}, but {says}; move it back, then press Enter again")
        return round(within, 3 if joint.slides else 1)

    def _state(self, name: str) -> JointState:
        state = self.devices.readers[name].read(name)
        assert isinstance(state, JointState)
        return state

    def _keep(self) -> None:
        while not self._done.wait(_EACH):
            for name in self._names:
                self.devices.readers[name].write(name, JointTarget(loose=True))

    def _holds(self, name: str) -> bool:
        state = self._state(name)
        self.devices.readers[name].write(name, JointTarget(state.position, _SLOW))
        return not state.loose

    def _until(self, reached: Callable[[str], bool]) -> list[str]:
        """Ask again and again for servos that haven't reached something; return those that don't."""
        left, end = self._names, time.monotonic() + _WAITS
        while left and time.monotonic() < end:
            left = [name for name in left if not _is_so(reached, name)]
            if left:
                time.sleep(_LOOKS)
        return left


def _is_so(reached: Callable[[str], bool], name: str) -> bool:
    try:
        return reached(name)
    except DeviceError:  # silent; it may come back
        return False


def _ignore(kind: str, data: Mapping[str, object]) -> None:
    """Ignore that devices fall silent: reading reports it."""


def record(name: str, path: str, body: Body, over: str) -> int:
    """Take poses from standard input until it ends, and write the gesture; return the exit code.

    Servos of the robot are loose meanwhile. Ctrl-C writes nothing. Raises MissionError (BT071 for devices that can't be
    used, BT076 for poses that can't make a gesture).
    """
    if over != "devices" or not servos_of(body):
        show(f"The robot runs {over}, so nobody can move it by hand. {_TYPED}", sys.stderr)
        return _write(name, path, body, poses_of(sys.stdin, body, None))
    with loose(body) as read:
        show(f"The joints are loose: hold the robot, then move it. {_HELP}", sys.stderr)
        poses = list(poses_of(sys.stdin, body, read))
    return _write(name, path, body, poses)


def poses_of(lines: Iterable[str], body: Body, read: Callable[[], Pose] | None) -> Iterator[Pose]:
    """Yield the pose of each line that has one; report what is wrong with a line."""
    for line in lines:
        if line.strip() == "end":
            return
        try:
            if line.strip():
                pose = _read_typed(line, body)
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
    """Return the file of a gesture: one key frame for each pose, as far apart as the joints need."""
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


def _read_typed(line: str, body: Body) -> Pose:
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
