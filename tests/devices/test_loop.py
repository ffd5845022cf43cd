"""The loop of devices, with a driver that does what a test says."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.devices.device_set import DeviceSet
from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.kinds import (
    Charge,
    Colour,
    Command,
    Distance,
    Image,
    JointState,
    JointTarget,
    Measured,
    Motion,
    Reading,
    Scan,
    Wheels,
    WheelSpeeds,
)
from btlang.devices.loop import DeviceLoop, _calibrate, _inverse
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world_file import load_world
from tests.profiles import searches

SILENCE = 0.06
BASE, FRONT, LAMP = Device("base", "drive", "test"), Device("front", "range", "test"), Device("lamp", "light", "test")
DRIVES = Wheels(0.0, 0.0, 0.0, 0.0)


class TestDriver:
    """Tells `told`, or does `acts`; keeps what it was told."""

    __test__ = False
    rate = 200.0

    def __init__(self) -> None:
        self.told: dict[str, Reading | DeviceError] = {"base": DRIVES, "front": Distance(1.0), "lamp": Reading()}
        self.acts: Callable[[], object] = lambda: None
        self.commands: list[Mapping[str, Command]] = []
        self.calls: list[str] = []

    def open(self) -> None:
        self.calls.append("open")

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        self.commands.append(commands)
        self.acts()
        return dict(self.told)

    def close(self) -> None:
        self.calls.append("close")


@contextmanager
def looped(driver: TestDriver, silence: float = SILENCE) -> Iterator[tuple[DeviceLoop, list[tuple[str, str | None]]]]:
    changes: list[tuple[str, str | None]] = []
    loop = DeviceLoop(driver, (BASE, FRONT, LAMP), lambda *change: changes.append(change), silence)
    loop.start()
    try:
        yield loop, changes
    finally:
        loop.close()


def until(reached: Callable[[], object]) -> None:
    end = time.monotonic() + 10.0
    while not reached():
        assert time.monotonic() < end
        time.sleep(0.002)


def served(loop: DeviceLoop) -> bool:
    return not any(map(loop.silent, loop.devices))


def speeds(driver: TestDriver) -> Command:
    return driver.commands[-1]["base"]


def test_what_devices_tell_is_read() -> None:
    with looped(TestDriver(), 5.0) as (loop, changes):
        until(lambda: served(loop))
        assert loop.read("front") == Distance(1.0)
        assert loop.read("lamp") == Reading()
        assert changes == [("base", None), ("front", None), ("lamp", None)]


def test_commands_that_cease() -> None:
    driver = TestDriver()
    with looped(driver) as (loop, _):
        loop.write("lamp", Colour(1.0))
        loop.write("base", WheelSpeeds(0.5, 0.5))
        until(lambda: len(driver.commands) > 1 and speeds(driver) == WheelSpeeds())
        lamps = [command["lamp"] for command in driver.commands if "lamp" in command]
        assert lamps
        assert all(lamp == Colour(1.0) for lamp in lamps)  # it moves nothing


def test_a_command_ends_before_its_time_is_over() -> None:
    """It is told for the last time when the next cycle, at which it's replaced, still comes in time."""
    loop = DeviceLoop(TestDriver(), (BASE,), silence=1.0)
    loop.write("base", WheelSpeeds(0.5, 0.5))
    written = loop._commands["base"][1]
    loop._take_reading("base", DRIVES, written + 5.0)
    assert loop._due_commands(written + 0.99) == {"base": WheelSpeeds(0.5, 0.5)}
    assert loop._due_commands(written + 1.01) == {"base": WheelSpeeds()}


def test_what_moves_and_is_silent_is_brought_to_rest() -> None:
    driver = TestDriver()
    with looped(driver, 0.3) as (loop, _):

        def drives() -> bool:
            loop.write("base", WheelSpeeds(0.5, 0.5))
            return bool(driver.commands) and speeds(driver) == WheelSpeeds(0.5, 0.5)

        until(drives)
        wheels = driver.told.pop("base")
        until(lambda: not drives())
        assert loop.silent("front") is None
        driver.told["base"] = wheels
        until(drives)
        driver.told["base"] = DeviceSilent("its encoder is broken")
        until(lambda: not drives())


def test_rest_forgets_all_commands() -> None:
    driver = TestDriver()
    with looped(driver, 60.0) as (loop, _):
        loop.write("base", WheelSpeeds(0.5, 0.5))
        until(lambda: driver.commands and speeds(driver) == WheelSpeeds(0.5, 0.5))
        loop.rest()
        until(lambda: speeds(driver) == WheelSpeeds())


@pytest.mark.parametrize("simulated", [False, True])
def test_commands_that_a_device_does_not_take(simulated: bool) -> None:
    real = DeviceLoop(TestDriver(), (BASE, FRONT, LAMP))
    write: Callable[[str, Command], None] = real.write
    if simulated:
        robot = SimulatedRobot(load_world())
        devices = tuple(Device(each.name, each.kind, "simulated") for each in (BASE, FRONT, LAMP))
        readers = DeviceSet(robot.body.replace(devices=devices), robot, lambda kind, data: None).readers
        write = lambda name, command: readers[name].write(name, command)  # noqa: E731
    with pytest.raises(DeviceError, match="the front doesn't take a WheelSpeeds"):
        write("front", WheelSpeeds())
    with pytest.raises(DeviceError, match="the base doesn't take a Colour"):
        write("base", Colour())
    with pytest.raises(DeviceError, match="the base doesn't take a right that is not a number"):
        write("base", WheelSpeeds(0.0, math.nan))
    with pytest.raises(DeviceError, match="the base doesn't take a left that is not a number"):
        write("base", WheelSpeeds(10**400, 0.0))
    with pytest.raises(DeviceError, match="the base doesn't take a left that is not a number"):
        write("base", WheelSpeeds("fast", 0.0))  # type: ignore[arg-type]
    with pytest.raises(DeviceError, match="the base doesn't take a left that is not finite"):
        write("base", WheelSpeeds(math.inf, 0.0))


def test_readings_that_cease_and_come_back() -> None:
    driver = TestDriver()
    with looped(driver, 0.5) as (loop, changes):
        until(lambda: served(loop))
        del driver.told["front"]
        until(lambda: loop.silent("front"))
        with pytest.raises(DeviceSilent, match="the front is silent: it reports nothing new"):
            loop.read("front")
        until(lambda: ("front", "it reports nothing new") in changes)
        assert loop.silent("base") is None  # one device of a port is silent, the others go on
        driver.told["front"] = Distance(2.0)
        until(lambda: loop.silent("front") is None)
        assert loop.read("front") == Distance(2.0)


@pytest.mark.parametrize("told", [DeviceSilent("its cable is broken"), Distance(math.nan), DRIVES])
def test_readings_that_cannot_be_used(told: Reading | DeviceError) -> None:
    driver = TestDriver()
    with looped(driver, 5.0) as (loop, _):
        until(lambda: served(loop))
        driver.told["front"] = told
        until(lambda: loop.silent("front"))
        with pytest.raises(DeviceSilent, match=r"its cable is broken|its distance is not a number|gives Wheels"):
            loop.read("front")
        assert loop.silent("base") is None


@pytest.mark.parametrize(
    ("kind", "reading", "reason"),
    [
        ("range", Distance("far"), "its distance is not a number"),
        ("range", Distance(None), "its distance is not a number"),
        ("drive", Wheels(math.inf, 0.0, 0.0, 0.0), "its left is not finite"),
        ("lidar", Scan([math.nan, math.nan]), "its scan has no valid beam"),
        ("lidar", Scan([1.0, "far"]), "its ranges have what is not a number"),
        ("lidar", Scan(5), "its ranges have what is not a number"),
        ("battery", Charge(50.0, volts="12"), "its volts is not a number"),
        ("camera", Image(4, 1, b"123"), "its picture has 3 bytes, not 12"),
        ("camera", Image(-4, -1, bytes(12)), "its picture has 12 bytes"),
    ],
)
def test_readings_that_cannot_be_true(kind: str, reading: Reading, reason: str) -> None:
    device = Device("thing", kind, "test", scale=2.0)
    loop = DeviceLoop(TestDriver(), (device,))
    loop._take_reading("thing", reading, time.monotonic())
    assert reason in str(loop.silent("thing"))
    with pytest.raises(DeviceSilent):
        loop.read("thing")


def test_readings_that_can_be_true() -> None:
    for kind, reading in (
        ("range", Distance(math.inf)),
        ("lidar", Scan([1.0, math.inf])),
        ("lidar", Scan([1.0, math.nan])),
        ("lidar", Scan(np.array([1.0, math.inf], dtype=np.float32))),
        ("gauge", Measured(np.float32(1.5))),
        ("battery", Charge(50)),
        ("camera", Image(2, 1, bytes(6))),
        ("imu", Motion(1.0)),
    ):
        loop = DeviceLoop(TestDriver(), (Device("thing", kind, "test"),))
        loop._take_reading("thing", reading, time.monotonic())
        assert loop.read("thing") is reading


@pytest.mark.parametrize(
    "problem", [DeviceError("the port is gone"), KeyError("x"), SystemExit(1), KeyboardInterrupt()]
)
def test_a_driver_that_raises(problem: BaseException) -> None:
    driver = TestDriver()

    def fail() -> None:
        raise problem

    with looped(driver, 5.0) as (loop, _):
        until(lambda: served(loop))
        driver.acts = fail
        until(lambda: all(map(loop.silent, loop.devices)))
        assert str(problem) in str(loop.silent("base"))
        assert loop.rate == 0.0
        driver.acts = lambda: None
        until(lambda: served(loop))
        assert driver.calls[:3] == ["open", "close", "open"]
    assert driver.calls[-1] == "close"
    assert loop.silent("base") == "its loop is closed"


def test_a_driver_whose_open_and_close_raise(monkeypatch: pytest.MonkeyPatch) -> None:
    driver = TestDriver()

    def fail() -> None:
        driver.calls.append("failed")
        raise RuntimeError("nothing works")

    monkeypatch.setattr(driver, "close", fail)
    monkeypatch.setattr(driver, "open", fail)
    with looped(driver) as (loop, _):
        until(lambda: loop.silent("base") == "RuntimeError: nothing works")
        monkeypatch.undo()
        until(lambda: served(loop))


def test_a_listener_that_raises() -> None:
    def listen(name: str, reason: str | None) -> None:
        raise ValueError(name)

    loop = DeviceLoop(TestDriver(), (BASE, FRONT, LAMP), listen, 5.0)
    loop.start()
    until(lambda: served(loop))
    loop.close()


def test_a_driver_that_hangs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.devices.loop._JOIN", 0.1)
    driver, freed = TestDriver(), threading.Event()
    with looped(driver, 0.3) as (loop, _):
        until(lambda: served(loop))
        driver.acts = lambda: freed.wait(30.0)
        until(lambda: all(map(loop.silent, loop.devices)))
        with pytest.raises(DeviceSilent, match="the base is silent: it reports nothing new"):
            loop.read("base")
        began = time.monotonic()
        loop.close()
        assert time.monotonic() - began < 5.0
        freed.set()
        until(lambda: driver.calls[-1] == "close")


def test_closed_twice_or_never_started() -> None:
    driver = TestDriver()
    never = DeviceLoop(driver, (BASE,))
    never.close()
    never.close()
    assert driver.calls == []
    with looped(driver) as (loop, _):
        until(lambda: served(loop))
        loop.close()
    assert driver.calls == ["open", "close"]


def test_the_rate_that_is_reached() -> None:
    driver = TestDriver()
    driver.rate = 50.0
    with looped(driver) as (loop, _):
        until(lambda: loop.rate)
        assert 1.0 < loop.rate <= 55.0


numbers = st.floats(-1000, 1000, allow_nan=False)
scales = st.floats(0.01, 100) | st.floats(-100, -0.01)


@searches(100, 5_000)
@given(numbers, numbers, scales, numbers)
def test_calibration_there_and_back(position: float, speed: float, scale: float, offset: float) -> None:
    """What a device is told in true units it tells in true units."""
    joint = Device("arm", "joint", "test", scale=scale, offset=offset)
    told = _inverse(JointTarget(position, abs(speed)), joint)
    assert isinstance(told, JointTarget)
    assert told.speed == pytest.approx(abs(speed / scale))  # at most that fast, either way
    found = _calibrate(JointState(told.position or 0.0, speed / scale), joint)
    assert (found.position, found.speed) == (pytest.approx(position, abs=1e-6), pytest.approx(speed, abs=1e-6))
    base = Device("base", "drive", "test", scale=scale, offset=offset)
    wheels = _inverse(WheelSpeeds(position, speed), base)
    assert isinstance(wheels, WheelSpeeds)
    found = _calibrate(Wheels(1.0, 2.0, wheels.left, wheels.right), base)
    assert (found.left, found.left_speed, found.right_speed) == pytest.approx((scale, position, speed))


def test_calibration_leaves_what_is_unknown_and_rest() -> None:
    device = Device("arm", "joint", "test", scale=2.0, offset=3.0)
    assert _inverse(JointTarget(), device) == JointTarget()
    assert _inverse(WheelSpeeds(), Device("base", "drive", "test", scale=-2.0, offset=3.0)) == WheelSpeeds()
    assert _calibrate(Motion(1.0), Device("imu", "imu", "test", scale=2.0)) == Motion(2.0)
    assert _calibrate(Distance(math.inf), Device("front", "range", "test", scale=2.0)) == Distance(math.inf)


def test_a_battery_that_jumps_needs_a_second_sample() -> None:
    """One that holds for a second: drivers may repeat a sample."""
    loop = DeviceLoop(TestDriver(), (Device("battery", "battery", "test"),))
    begun = time.monotonic()

    def told(percent: float, after: float) -> float:
        loop._take_reading("battery", Charge(percent), begun + after)
        reading = loop.read("battery")
        assert isinstance(reading, Charge)
        return reading.percent

    assert [told(80.0, 0.0), told(0.0, 0.1), told(80.0, 0.2), told(78.0, 0.3)] == [80.0, 80.0, 80.0, 78.0]
    assert [told(0.0, 0.4), told(0.0, 0.8), told(0.5, 1.2), told(0.2, 1.4)] == [78.0, 78.0, 78.0, 0.2]
    assert told(100.0, 60.0) == 0.2  # it fills up by a percent a second at most
    assert told(100.0, 61.0) == 100.0
