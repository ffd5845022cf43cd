"""Joints made of Dynamixel servos: what they are sent, and what they say."""

from __future__ import annotations

import math
import sys
from typing import Any

import pytest

from btlang.devices.driver import DeviceError
from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.driver import DynamixelDriver
from btlang.devices.dynamixel.fake_bus import FakeBus, FakeServo
from btlang.devices.dynamixel.protocol import FAST_SYNC_READ, SYNC_READ
from btlang.devices.dynamixel.servo import WATCHDOG_SET
from btlang.devices.kinds import JointState, JointTarget
from tests.devices.dynamixel_rig import degrees, device, rig

REST = {"j1": JointTarget()}


def test_a_joint_goes_to_its_goal_and_says_where_it_is() -> None:
    servo = FakeServo(1)
    with rig(servo) as r:
        r.loop.start()
        r.until(lambda: abs(degrees(servo) - 30) < 0.1, {"j1": JointTarget(30.0)})
        r.for_a_while(0.1, {"j1": JointTarget(30.0)})
        state = r.loop.read("j1")
    assert state == JointState(pytest.approx(30, abs=0.1), 0.0, 0.0, 30.0, False)
    assert any(state.speed > 300 for state in r.seen["j1"]), "as fast as the servo goes"


def test_a_goal_has_a_speed() -> None:
    servo = FakeServo(1)
    with rig(servo) as r:
        r.loop.start()
        r.until(lambda: degrees(servo) > 2, {"j1": JointTarget(90.0, 20.0)})
    assert {round(state.speed) for state in r.seen["j1"]} <= {0, 21}, "15 units of 1.37 degrees a second"


def test_nothing_moves_until_the_first_goal_and_then_without_a_jump() -> None:
    servo = FakeServo(1)
    servo.turn_to(1000)
    servo.write(table.GOAL_POSITION, (3000).to_bytes(4, "little"))
    with rig(servo) as r:
        r.loop.start()
        r.until(r.is_back)
        r.for_a_while(0.1)
        assert r.loop.read("j1").loose  # type: ignore[attr-defined]
        r.until(lambda: servo.has_torque, {"j1": JointTarget(degrees(servo) + 1)})
        assert servo.goal in (1000, 1011)
        assert all(abs(state.speed) < 400 and state.position < 0 for state in r.seen["j1"])


def test_torque_that_is_on_at_the_start_holds_the_joint_where_it_is() -> None:
    servo = FakeServo(1)
    servo.write(table.GOAL_POSITION, (3000).to_bytes(4, "little"))
    servo.write(table.PROFILE_VELOCITY, b"\1\0\0\0")
    servo.write(table.TORQUE, b"\1")
    with rig(servo) as r:
        r.loop.start()
        r.until(r.is_back)
        assert servo.has_torque
        assert servo.goal < 2100


def test_without_a_goal_the_joint_stays_where_it_is() -> None:
    servo = FakeServo(1)
    with rig(servo) as r:
        r.loop.start()
        r.until(lambda: degrees(servo) > 10, {"j1": JointTarget(90.0, 30.0)})
        r.until(lambda: r.seen["j1"][-1].speed == 0)  # not told again: after a moment the loop lets it rest
        held = servo.goal
        servo.turn_to(servo.position + 50)
        r.for_a_while(0.1)
        assert servo.has_torque
        assert servo.goal == held, "where it rests is chosen once"
        assert degrees(servo) < 60


def test_a_loose_joint_has_no_torque() -> None:
    servo = FakeServo(1)
    with rig(servo) as r:
        r.loop.start()
        r.until(lambda: servo.has_torque, {"j1": JointTarget(10.0)})
        r.until(lambda: not servo.has_torque, {"j1": JointTarget(loose=True)})
        r.until(lambda: r.seen["j1"][-1].loose, {"j1": JointTarget(loose=True)})
        r.for_a_while(0.3)
        assert not servo.has_torque, "rest gives it no torque"


@pytest.mark.parametrize(("at_end", "torque"), [("hold", True), ("loose", False)])
def test_at_the_end_a_joint_holds_or_lets_go(at_end: str, torque: bool) -> None:
    servo = FakeServo(1)
    with rig(servo, at_end=at_end) as r:
        r.loop.start()
        r.until(lambda: degrees(servo) > 5, {"j1": JointTarget(90.0, 30.0)})
        r.loop.close()
        assert servo.has_torque is torque
        assert degrees(servo) < 60
        assert servo.memory[table.WATCHDOG] == 0, "it doesn't stop whoever uses it next"


def test_goals_end_at_the_limits() -> None:
    servo = FakeServo(1)
    servo.write(table.MAX_POSITION, (3072).to_bytes(4, "little"))
    with rig(servo, low=-45) as r:
        r.loop.start()
        r.until(lambda: servo.goal == 3072, {"j1": JointTarget(1e9)})
        r.until(lambda: servo.goal == 1536, {"j1": JointTarget(-1e9)})


def test_a_goal_without_end_is_refused() -> None:
    servo = FakeServo(1)
    with rig(servo) as r:
        r.loop.start()
        r.until(lambda: degrees(servo) > 5, {"j1": JointTarget(90.0, 30.0)})
        with pytest.raises(DeviceError, match="the j1 doesn't take a position that is not finite"):
            r.loop.write("j1", JointTarget(math.inf))
        assert r.is_back()
        assert degrees(servo) < 60


def test_a_joint_may_be_reversed_and_calibrated() -> None:
    servo = FakeServo(1)
    with rig(servo, reverse=True, offset=10.0, low=-20, high=30) as r:
        r.loop.start()
        r.until(lambda: servo.goal == 2048 - round(20 * 4096 / 360), {"j1": JointTarget(100.0)})
        r.until(lambda: abs(r.seen["j1"][-1].position - 30) < 0.2, {"j1": JointTarget(100.0)})
        r.until(lambda: servo.goal == 2048 + round(30 * 4096 / 360), {"j1": JointTarget(-100.0)})


def test_old_and_new_servos_share_a_line() -> None:
    servos = [FakeServo(1), FakeServo(2, model=1020, is_fast=False), FakeServo(3, model=1220), FakeServo(4, 1090)]
    with rig(*servos) as r:
        r.loop.start()
        r.until(lambda: r.is_back() and r.bus.heard.get(FAST_SYNC_READ, 0) > 50)
        assert r.bus.heard[SYNC_READ] > 10
        for servo in servos:
            name, goal = f"j{servo.id}", 5.0 * servo.id
            r.until(lambda servo=servo, goal=goal: abs(degrees(servo) - goal) < 0.1, {name: JointTarget(goal)})  # type: ignore[misc]


def test_the_watchdog_of_a_servo_stops_it_when_nothing_is_said() -> None:
    servo = FakeServo(1)
    with rig(servo) as r:
        r.driver.open()
        for _ in range(10):
            r.driver.exchange({"j1": JointTarget(90.0, 20.0)})
        assert servo.memory[table.WATCHDOG] == WATCHDOG_SET
        heard = servo._heard
        servo.hear(heard + 5.0)
        stopped = degrees(servo)
        assert stopped < 20 * 0.3
        assert servo.memory[table.WATCHDOG] == table.WATCHDOG_TRIPPED
        r.driver.exchange({"j1": JointTarget(90.0, 20.0)})
        told = r.driver.exchange({"j1": JointTarget(90.0, 20.0)})
        assert isinstance(told["j1"], JointState)
        assert servo.memory[table.WATCHDOG] == WATCHDOG_SET
        assert servo.goal < 2048 + 100, "it doesn't leap on to where it was going"
        r.driver.exchange({"j1": JointTarget(90.0, 20.0)})
        assert servo.goal == 3072
        r.driver.close()
        r.driver.close()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"id": 300}, "the j1: id is 300; it has to be a whole number from 0 to 252"),
        ({"id": True}, "the j1: id is True"),
        ({"speed": 3}, "the j1: a Dynamixel servo has no option 'speed', but id, reverse"),
        ({"at_end": "drop"}, "the j1: at_end is 'drop'; it has to be 'hold' or 'loose'"),
        ({"reverse": 1}, "the j1: reverse is 1; it has to be true or false"),
        ({"hottest": math.nan}, "the j1: hottest is nan"),
        ({"low": "0"}, "the j1: low is '0'"),
        ({"low": 10, "high": -10}, "the j1: low is 10; it has to be less than high, -10"),
        ({"baud": 3}, "the j1: baud is 3"),
    ],
)
def test_options_that_are_wrong(options: dict[str, Any], message: str) -> None:
    with pytest.raises(DeviceError) as caught:
        DynamixelDriver("/dev/null", [device(1, "/dev/null", **options)])
    assert str(caught.value).startswith(message)


def test_options_that_contradict() -> None:
    first = device(1, "p")
    with pytest.raises(DeviceError, match="the j1 and the j2 have the same id 1 on p"):
        DynamixelDriver("p", [first, device(2, "p").replace(options={"id": 1})])
    with pytest.raises(DeviceError, match="has one baud, but the options say 1000000 for the j1 and 57600 for the j2"):
        DynamixelDriver("p", [first, device(2, "p", baud=57_600)])
    with pytest.raises(DeviceError, match="the j1: the option 'id' is missing"):
        DynamixelDriver("p", [first.replace(options={})])


def opened(servo: FakeServo, **options: Any) -> str:
    """Why a servo can't be used."""
    with FakeBus([servo]) as bus:
        driver = DynamixelDriver(bus.port, [device(servo.id, bus.port, **options)])
        with pytest.raises(DeviceError) as caught:
            driver.open()
        driver.close()
        return str(caught.value).replace(bus.port, "PORT")


def test_servos_that_cannot_be_used() -> None:
    assert opened(FakeServo(1, model=350)).startswith(
        "servo 1 on PORT is of a model that isn't known, number 350; known: XL430-W250"
    )
    assert "has the firmware 30, but it needs 38 or later" in opened(FakeServo(1, firmware=30))
    assert opened(FakeServo(1), low=-200) == (
        "servo 1 on PORT goes from -180.0 to 179.9 degrees only; low or high of the j1 is beyond"
    )
    wheel, timed, dumb = FakeServo(1), FakeServo(1), FakeServo(1)
    wheel.memory[table.OPERATING_MODE] = 1
    assert opened(wheel) == "servo 1 on PORT is in operating mode 1; set it to 3, position control"
    timed.memory[10] = table.TIME_PROFILE
    assert "is in drive mode 4" in opened(timed)
    dumb.silent = True
    assert opened(dumb) == "servo 1 on PORT doesn't answer"


def test_ports_that_cannot_be_used(tmp_path: Any) -> None:
    for path in (tmp_path / "none", tmp_path):
        with pytest.raises(DeviceError, match=f"the port {path} can't be opened"):
            DynamixelDriver(str(path), [device(1, str(path))]).open()
    with FakeBus([FakeServo(1)]) as bus:
        first, second = (DynamixelDriver(bus.port, [device(1, bus.port)]) for _ in range(2))
        first.open()
        with pytest.raises(DeviceError, match="can't be opened"):
            second.open()
        first.close()
        second.open()
        second.close()


def test_without_pyserial(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(DeviceError, match=r"need the package pyserial: pip install 'btlang\[serial\]'"):
        DynamixelDriver("/dev/null", [device(1, "/dev/null")]).open()
