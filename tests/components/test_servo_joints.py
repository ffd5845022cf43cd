"""Planned movements over servos: simulated twins, and the loop of a driver as real ones have it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import pytest

from btlang.components.device_robot import connect_devices
from btlang.components.parts.servo_joints import ServoJoints
from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.kinds import Command, JointState, JointTarget, Reading
from btlang.devices.loop import DeviceLoop
from btlang.robots.bodies.gesture import angle_of
from btlang.robots.geometry import Pose
from btlang.robots.platforms import ALL
from btlang.robots.worlds.world import World
from tests.robots.motion.bodies import BOW, guide

WAVE = [{name: angle_of(value, 0.0) for name, value in step.items()} for step in guide().postures["wave"]]
PATIENCE = 20.0  # seconds, on a busy machine


class Servos:
    """A driver of ideal servos: they are where they were told last, and keep all that they were told."""

    rate = 100.0

    def __init__(self) -> None:
        self.positions = {joint.name: joint.rest for joint in guide().joints}
        self.told: list[Mapping[str, Command]] = []
        self.silent = ""

    def open(self) -> None: ...
    def close(self) -> None: ...

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        self.told.append(commands)
        for name, command in commands.items():
            if isinstance(command, JointTarget) and command.position is not None:
                self.positions[name] = command.position
        found: dict[str, Reading | DeviceError] = {name: JointState(at) for name, at in self.positions.items()}
        if self.silent:
            found[self.silent] = DeviceSilent("no answer")
        return found


@contextmanager
def servos() -> Iterator[tuple[Servos, ServoJoints]]:
    driver = Servos()
    loop = DeviceLoop(driver, tuple(Device(joint.name, "joint", "test") for joint in guide().joints))
    loop.start()
    assert loop.settled.wait(PATIENCE)
    try:
        yield driver, ServoJoints(guide(), dict.fromkeys(loop.devices, loop))
    finally:
        loop.close()


def until(reached: Callable[[], bool], step: Callable[[], object] = lambda: None) -> None:
    end = time.monotonic() + PATIENCE
    while not reached():
        assert time.monotonic() < end
        step()
        time.sleep(0.005)


def test_simulated_servos_follow_what_is_planned() -> None:
    connection = connect_devices(World(start=Pose(0, 0)), body=guide(), simulate=[ALL])
    robot: Any = connection.robot
    bow = robot.gesture("bow", stroke_at=1.5)
    robot.step(1.5)
    assert robot.joint("waist tilt") == pytest.approx(30, abs=0.5)
    while not bow.done:
        robot.step(0.05)
    robot.gesture("wave")
    robot.step(0.4)
    robot.stop()
    robot.step(0.35)
    at = robot.joint("right shoulder lift")
    assert not robot.moving
    robot.step(1.0)
    assert robot.joint("right shoulder lift") == at
    connection.close()


def test_a_loop_writes_to_real_servos_beside_the_tick() -> None:
    with servos() as (driver, joints):
        bow, _ = joints.play(BOW, None)
        until(lambda: bow.done)  # no step: the tick hangs
        tilts = [told["waist tilt"].position for told in driver.told if told["waist tilt"] != JointTarget()]  # type: ignore[attr-defined]
        assert max(tilts) == pytest.approx(30, abs=5)  # it may be told late where the machine is busy
        assert len({round(tilt, 3) for tilt in tilts}) > 5
        until(lambda: joints.at_target(("waist tilt",)))


def test_stopped_real_servos_brake_and_stay() -> None:
    with servos() as (driver, joints):
        wave, _ = joints.play(WAVE, None)
        until(lambda: driver.positions["right shoulder lift"] > 30)
        joints.freeze()
        until(lambda: not joints.moving)
        assert (wave.done, wave.failure) == (True, "the robot was stopped")
        assert driver.positions["right shoulder lift"] < 90
        joints.step(0.05)
        until(lambda: driver.told[-1]["right shoulder lift"] == JointTarget())


def test_a_servo_that_falls_silent_ends_the_gesture() -> None:
    with servos() as (driver, joints):
        wave, _ = joints.play(WAVE, None)
        until(lambda: driver.positions["right shoulder lift"] > 5)
        driver.silent = "right elbow"
        until(lambda: bool(wave.done), lambda: joints.step(0.05))
        assert "the right elbow is silent" in str(wave.failure)
        with pytest.raises(DeviceSilent, match="right elbow"):
            joints.move({"right elbow": 10.0})


def test_servos_rest_where_the_loop_of_the_body_hangs(monkeypatch: pytest.MonkeyPatch) -> None:
    with servos() as (driver, joints):
        joints.play(WAVE, None)
        until(lambda: driver.positions["right shoulder lift"] > 5)
        monkeypatch.setattr(joints._smooth, "step", lambda dt: time.sleep(1.0))
        until(lambda: driver.told[-1]["right shoulder lift"] == JointTarget())
        joints.freeze()
        monkeypatch.undo()
        until(lambda: not joints.moving)
        assert joints._thread is not None
        joints._thread.join(PATIENCE)


def test_a_movement_begins_where_the_servos_are() -> None:
    with servos() as (driver, joints):
        driver.positions["left elbow"] = 50.0  # somebody bent it
        until(lambda: joints.angle("left elbow") == 50.0)
        driver.told.clear()
        joints.move({"left elbow": 60.0})
        until(lambda: joints.at_target(("left elbow",)))
        told = [each["left elbow"].position for each in driver.told if each["left elbow"] != JointTarget()]  # type: ignore[attr-defined]
        assert min(told) >= 50.0 - 1e-6
        assert told[-1] == pytest.approx(60.0, abs=0.1)
