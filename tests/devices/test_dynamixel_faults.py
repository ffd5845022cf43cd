"""Faults of servos and their line: no wrong value is used, who fails is named, and service comes back by itself."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.fake_bus import FakeBus, FakeServo
from btlang.devices.kinds import JointState, JointTarget
from tests.devices.dynamixel_rig import PATIENCE, Rig, degrees, device, rig
from tests.profiles import amount, only_long

COUNT = 6
GOALS = {f"j{id}": JointTarget(10.0 * id, 60.0) for id in range(1, COUNT + 1)}


def servos() -> list[FakeServo]:
    """Each at a position of its own, 20 degrees from the next."""
    made = [FakeServo(id) for id in range(1, COUNT + 1)]
    for servo in made:
        servo.turn_to(2048 + 20 * servo.id * 4096 / 360)
    return made


def hold(r: Rig) -> dict[str, JointTarget]:
    """Goals where the servos are now."""
    return {f"j{servo.id}": JointTarget(degrees(servo)) for servo in r.bus.servos.values()}


def no_wrong_value(r: Rig, tolerance: float = 0.3) -> None:
    """All that was ever read of servos that hold still was theirs."""
    for name, states in r.seen.items():
        servo = r.bus.servos[int(name[1:])]
        assert states
        assert {
            round(state.position, 1) for state in states if abs(state.position - degrees(servo)) > tolerance
        } == set()


def test_a_silent_servo_is_named_and_the_others_go_on() -> None:
    with rig(*servos(), silence=5.0) as r:  # else a busy computer is taken for a silent servo
        r.loop.start()
        goals = hold(r)
        r.until(r.is_back, goals)
        r.events.clear()
        r.bus.servos[2].silent = True
        r.until(lambda: not r.is_back("j2"), goals)
        r.until(lambda: r.loop.silent("j2") == f"servo 2 on {r.bus.port} doesn't answer", goals)
        r.for_a_while(0.5, goals)
        assert {name for name, _ in r.events} == {"j2"}, "the others were never silent"
        others = {f"j{id}": JointTarget(degrees(s) + 5) for id, s in r.bus.servos.items() if id != 2}
        r.until(lambda: all(abs(r.seen[n][-1].position - (t.position or 0)) < 0.2 for n, t in others.items()), others)
        r.bus.servos[2].silent = False
        r.until(r.is_back, others)
        assert {name for name, _ in r.events} == {"j2"}


@pytest.mark.parametrize("count", [1, COUNT])
def test_a_servo_that_only_hears_is_told_to_stop(count: int) -> None:
    with rig(*servos()[1 : 1 + count]) as r:
        r.loop.start()
        goals = {"j2": JointTarget(-90.0, 20.0)}
        servo = r.bus.servos[2]
        r.until(lambda: degrees(servo) < 35, goals)
        servo.silent = True
        r.until(lambda: not r.is_back("j2"), goals)
        r.until(lambda: servo.goal > 2048, goals)
        assert degrees(servo) > 0


def test_a_silent_servo_is_asked_less_often() -> None:
    with rig(*servos()) as r:
        r.bus.servos[2].silent = True
        r.loop.start()
        r.until(lambda: r.is_back("j1", "j3"))
        r.for_a_while(1.5)
        pings = r.bus.heard[1]
        cycles = sum(r.bus.heard.get(kind, 0) for kind in (0x82, 0x8A))
        assert COUNT < pings < COUNT + 8
        assert cycles > 5 * pings


def test_several_may_fall_silent_at_once() -> None:
    with rig(*servos()) as r:
        r.loop.start()
        goals = hold(r)
        r.until(r.is_back, goals)
        for id in (1, 3, 4):
            r.bus.servos[id].silent = True
        r.until(lambda: all("doesn't answer" in (r.loop.silent(f"j{id}") or "") for id in (1, 3, 4)), goals)
        r.until(lambda: r.is_back("j2", "j5", "j6"), goals)
        for id in (1, 3, 4):
            r.bus.servos[id].silent = False
        r.until(r.is_back, goals)
        no_wrong_value(r)


def test_a_servo_that_answers_with_the_id_of_another_is_not_believed() -> None:
    with rig(*servos()) as r:
        r.loop.start()
        goals = hold(r)
        r.until(r.is_back, goals)
        r.bus.servos[3].answers_as = 5
        r.until(lambda: r.loop.silent("j3") == f"servo 3 on {r.bus.port} doesn't answer", goals)
        r.until(lambda: r.is_back("j1", "j2", "j4", "j5", "j6"), goals)
        r.for_a_while(0.3, goals)
        r.bus.servos[3].answers_as = 3
        r.until(r.is_back, goals)
        no_wrong_value(r)


def moved_and_asked(r: Rig, servo: FakeServo, number: int) -> bool:
    """Whether a servo that was just turned tells its new position. The one before would be that of a late answer."""
    servo.turn_to(2048 + number % 1000)
    told = r.driver.exchange({}).get(f"j{servo.id}")
    if isinstance(told, JointState):
        assert told.position == pytest.approx(number % 1000 * 360 / 4096)
    return isinstance(told, JointState)


@pytest.mark.parametrize("late", [0.012, 0.02, 0.04])
def test_a_late_answer_is_none_to_the_next_question(late: float) -> None:
    with rig(FakeServo(1), FakeServo(2)) as r:
        r.driver.open()
        servo = r.bus.servos[2]
        for number in range(20):
            servo.late = late
            moved_and_asked(r, servo, number)
            if number % 3 == 0:
                time.sleep(late)
        servo.late = 0.0
        end = time.monotonic() + PATIENCE
        while not moved_and_asked(r, servo, number := number + 1):
            assert time.monotonic() < end
        r.driver.close()


@pytest.mark.long
def test_of_damaged_packets_nothing_is_used() -> None:
    with rig(*servos()) as r:
        r.bus.damage = 0.01
        r.loop.start()
        goals = hold(r)
        r.until(lambda: all(r.seen.values()), goals)
        r.for_a_while(amount(1, 60), goals)
        r.bus.damage = 0.0
        r.until(r.is_back, goals)
        no_wrong_value(r)
        assert all(abs(degrees(s) - (goals[f"j{s.id}"].position or 0)) < 0.2 for s in r.bus.servos.values())


def test_echo_on_the_line_is_ignored() -> None:
    with rig(*servos(), silence=PATIENCE) as r:  # else a busy computer is taken for a silent servo
        r.bus.echo = True
        r.loop.start()
        r.until(lambda: all(abs(degrees(servo) - 10 * servo.id) < 0.2 for servo in r.bus.servos.values()), GOALS)
        assert all(reason is None for _, reason in r.events)


def test_a_slow_line_slows_down_the_cycle() -> None:
    with rig(*servos(), baud=57_600) as r:
        r.bus.baud = 57_600
        r.loop.start()
        r.until(r.is_back)
        assert 15 < r.driver.rate < 30
        r.until(lambda: 0 < r.loop.rate <= 31)
        r.until(lambda: all(abs(degrees(servo) - 10 * servo.id) < 0.2 for servo in r.bus.servos.values()), GOALS)


def test_a_hot_servo_loses_its_torque_until_it_has_cooled() -> None:
    servo, other = FakeServo(1), FakeServo(2)
    goals = {"j1": JointTarget(5.0), "j2": JointTarget(5.0)}
    with rig(servo, other, hottest=60) as r:
        r.loop.start()
        r.until(lambda: servo.has_torque and other.has_torque, goals)
        servo.temperature = 61
        r.until(lambda: not servo.has_torque, goals)
        assert r.loop.silent("j1") == (
            f"servo 1 on {r.bus.port} has no torque: it has 61 degrees Celsius, at most 60 are allowed. "
            "It can be used again when it has cooled"
        )
        servo.temperature = 58
        r.for_a_while(0.1, goals)
        assert not servo.has_torque
        servo.temperature = 50
        r.until(lambda: servo.has_torque and r.is_back(), goals)
        assert other.has_torque


@pytest.mark.parametrize(
    ("bits", "text"),
    [
        (0x04, "it is overheating"),
        (0x21, "its input voltage is out of range and it is overloaded"),
        (0x80, "hardware error 128"),
    ],
)
def test_a_hardware_error_is_said_by_name(bits: int, text: str) -> None:
    servo, other = FakeServo(1), FakeServo(2)
    goals = {"j1": JointTarget(5.0), "j2": JointTarget(5.0)}
    with rig(servo, other) as r:
        r.loop.start()
        r.until(r.is_back, goals)
        servo.fail(bits)
        r.until(lambda: f"servo 1 on {r.bus.port} has no torque: {text}." in str(r.loop.silent("j1")), goals)
        r.for_a_while(0.1, goals)
        assert not servo.has_torque
        assert r.is_back("j2")
        servo.reboot()
        r.until(lambda: servo.has_torque and r.is_back(), goals)


def test_a_servo_that_was_without_power_is_made_ready_again_and_does_not_jump() -> None:
    with rig(*servos()) as r:
        r.loop.start()
        goals = hold(r)
        r.until(r.is_back, goals)
        r.until(lambda: r.bus.servos[2].has_torque, goals)
        r.bus.servos[2].reboot()
        assert not r.bus.servos[2].has_torque
        r.until(lambda: r.bus.servos[2].has_torque and r.is_back(), goals)
        assert r.bus.servos[2].memory[table.WATCHDOG] == 10
        no_wrong_value(r)


def test_a_cable_that_was_pulled_and_plugged_in_again(tmp_path: Path) -> None:
    port = tmp_path / "servos"
    first = FakeBus([FakeServo(1)]).start()
    port.symlink_to(first.port)
    r = Rig(first, (device(1, str(port)),))
    try:
        r.loop.start()
        r.until(r.is_back)
        first.unplug()
        r.until(lambda: not r.is_back())
        r.until(lambda: "can't be opened" in str(r.loop.silent("j1")))
        with FakeBus([FakeServo(1)]) as second:
            port.unlink()
            port.symlink_to(second.port)
            r.until(lambda: second.servos[1].has_torque and r.is_back(), {"j1": JointTarget(5.0)})
            r.loop.close()
    finally:
        r.loop.close()
        first.close()
    assert not any("Error" in str(reason) for _, reason in r.events), "a sentence, not an exception"


@only_long
def test_all_faults_in_turn() -> None:
    """A minute of them: the servos hold where they are, and nothing else is ever read."""
    with rig(*servos()) as r:
        r.loop.start()
        goals = hold(r)
        r.until(r.is_back, goals)
        for round in range(20):
            servo = r.bus.servos[1 + round % COUNT]
            servo.silent = True
            r.for_a_while(0.5, goals)
            servo.silent, servo.late, r.bus.damage = False, 0.02, 0.02
            r.for_a_while(0.5, goals)
            servo.late, servo.answers_as = 0.0, 1 + (round + 1) % COUNT
            r.for_a_while(0.5, goals)
            servo.answers_as, r.bus.damage, r.bus.echo = servo.id, 0.0, bool(round % 2)
            servo.reboot()
            r.until(lambda servo=servo: servo.has_torque and r.is_back(), goals)  # type: ignore[misc]
        no_wrong_value(r)
