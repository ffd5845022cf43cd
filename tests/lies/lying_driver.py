"""The form of the liar that is a device driver, in real time. Ports are the names of scenes."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from math import cos, radians, sin

from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import Command, Distance, JointState, JointTarget, Pressed, Reading, Scan, Wheels, WheelSpeeds
from btlang.robots.geometry import Pose, wrap
from tests.lies.lies import OdometrySaid
from tests.lies.scene import Scene

GAP = 0.3
"""Metres between the wheels."""
SCENES: dict[str, Scene] = {}
"""The scenes that run, by the port of their driver."""


class WheelsOf:
    """How far wheels have rolled if a pose moves so."""

    def __init__(self) -> None:
        self._pose: Pose | None = None
        self._left = self._right = 0.0

    def reading(self, said: OdometrySaid) -> Wheels:
        """The encoders for what an odometry says next."""
        pose = Pose(said.x, said.y, said.heading)
        before, self._pose = self._pose or pose, pose
        turned = wrap(pose.heading - before.heading)
        middle = radians(before.heading + turned / 2)
        way = (pose.x - before.x) * cos(middle) + (pose.y - before.y) * sin(middle)
        side, spin = radians(turned) * GAP / 2, radians(said.spin) * GAP / 2
        self._left, self._right = self._left + way - side, self._right + way + side
        return Wheels(self._left, self._right, said.speed - spin, said.speed + spin)


def commanded(scene: Scene, command: Command | None) -> None:
    """The robot of a scene gets a command of its wheels or its joint."""
    if isinstance(command, WheelSpeeds):
        turn = (command.right - command.left) / GAP
        scene.drive((command.left + command.right) / 2, turn / radians(1.0))
    elif isinstance(command, JointTarget) and command.position is not None:
        scene.robot.joint_target = command.position


class LyingDriver:
    """A lidar, wheels, a sonar, a bumper and a joint, whose names are those of the sensors in tests.lies.lies."""

    kinds, needs_port = ("drive", "lidar", "range", "button", "joint"), True
    rate = 50.0

    def __init__(self, port: str, devices: Sequence[Device]) -> None:
        self._scene, self._devices = SCENES[port], devices
        self._last = 0.0
        self._wheels = WheelsOf()
        self._scanned = -1.0

    def open(self) -> None:
        """See Driver."""
        self._last = time.monotonic()

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        """See Driver."""
        now = time.monotonic()
        for name, command in commands.items():
            if name != "head tilt":
                commanded(self._scene, command)
        self._scene.step(now - self._last)
        self._last = now
        found = {device.name: self._reading(device.name, device.kind) for device in self._devices}
        return {name: reading for name, reading in found.items() if reading is not None}

    def close(self) -> None:
        """See Driver."""
        self._scene.drive(0.0, 0.0)

    def _reading(self, name: str, kind: str) -> Reading | None:
        scene = self._scene
        if name == "head tilt":
            return JointState(0.0)
        if kind == "drive":
            odometry = scene.odometry(0.0)
            return None if odometry is None else self._wheels.reading(odometry)
        if kind == "lidar":
            if scene.robot.time - self._scanned < 0.1:
                return None
            self._scanned = scene.robot.time
            scan = scene.scan(0.0)
            return None if scan is None else Scan(scan.ranges, scan.start, scan.step)
        if kind == "range":
            distance = scene.sonar()
            return None if distance is None else Distance(distance)
        if kind == "button":
            pressed = scene.bumper()
            return None if pressed is None else Pressed(pressed)
        joint = scene.joint()
        return None if joint is None else JointState(joint)
