"""Readings and commands as integers: they come back as they were, or as near as the unit allows."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.devices.driver import DeviceError
from btlang.devices.kinds import (
    KINDS,
    Charge,
    Colour,
    Distance,
    JointState,
    JointTarget,
    Motion,
    Pressed,
    Shown,
    Wheels,
    WheelSpeeds,
)
from btlang.devices.serial_board.messages import COMMANDS, KIND_NUMBERS, READINGS, UnwrappedCounter
from tests.profiles import searches


def floats(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


accelerations, maybe = floats(-300, 300), st.none()
READ = {
    "range": st.builds(Distance, floats(0, 65) | st.just(math.inf)),
    "imu": st.builds(Motion, floats(-1e4, 1e4), accelerations | maybe, maybe, accelerations, maybe),
    "battery": st.builds(
        Charge, floats(0, 100), floats(0, 60) | maybe, floats(-300, 300) | maybe, floats(-40, 90), st.booleans() | maybe
    ),
    "button": st.builds(Pressed, st.booleans()),
    "joint": st.builds(
        JointState, floats(-1e5, 1e5), floats(-3000, 3000), floats(-100, 100) | maybe, maybe, st.booleans()
    ),
    "drive": st.builds(Wheels, *[st.just(0.0)] * 2, floats(-30, 30), floats(-30, 30)),
}
TOLD = {
    "drive": st.builds(WheelSpeeds, floats(-32, 32), floats(-32, 32)),
    "joint": st.builds(JointTarget, floats(-1e5, 1e5) | maybe, floats(0, 6000) | maybe, st.booleans()),
    "light": st.builds(Colour, floats(0, 1), floats(0, 1), floats(0, 1)),
    "display": st.builds(Shown, st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=8)),
}


def near(found: Any, meant: Any) -> bool:
    """Whether each field is the same, numbers to the unit."""
    pairs = [(getattr(found, name), getattr(meant, name)) for name in meant.fields]
    return all(a == b if not isinstance(b, float) else a == pytest.approx(b, abs=0.51) for a, b in pairs)


def test_every_kind_has_its_format() -> None:
    assert {kind for kind in KIND_NUMBERS if KINDS[kind].reading} == set(READINGS) == set(READ)
    assert {kind for kind in KIND_NUMBERS if KINDS[kind].command} == set(COMMANDS) == set(TOLD)


@pytest.mark.parametrize("kind", READ)
@searches(50, 2_000)
@given(data=st.data())
def test_readings_come_back(kind: str, data: st.DataObject) -> None:
    reading, made = data.draw(READ[kind]), READINGS[kind]
    packed = made.layout.pack(*made.integers(reading))
    assert near(made.reading(made.layout.unpack(packed), (UnwrappedCounter(), UnwrappedCounter())), reading)


@pytest.mark.parametrize("kind", TOLD)
@searches(50, 2_000)
@given(data=st.data())
def test_commands_come_back(kind: str, data: st.DataObject) -> None:
    command, made = data.draw(TOLD[kind]), COMMANDS[kind]
    packed = made.pack(command)
    assert len(packed) == made.layout.size
    assert near(made.unpack(packed), command)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_not_sent(value: float) -> None:
    for kind, command in (("drive", WheelSpeeds(0.0, value)), ("joint", JointTarget(value)), ("light", Colour(value))):
        with pytest.raises(DeviceError, match="not a number that a board understands"):
            COMMANDS[kind].pack(command)


def test_too_much_is_the_most() -> None:
    speeds = COMMANDS["drive"].unpack(COMMANDS["drive"].pack(WheelSpeeds(99.0, -99.0)))
    assert speeds == WheelSpeeds(32.767, -32.768)
    text = COMMANDS["display"].unpack(COMMANDS["display"].pack(Shown("x" + "ü" * 40)))
    assert text == Shown("x" + "ü" * 15)


@pytest.mark.parametrize(
    ("kind", "integers"),
    [("battery", (10_001, 0, 0, 0, 0)), ("battery", (5, 0, 0, 0, 3)), ("button", (2,)), ("joint", (0, 0, 0, 0, 2))],
)
def test_what_cannot_be_true_is_refused(kind: str, integers: tuple[int, ...]) -> None:
    with pytest.raises(DeviceError):
        READINGS[kind].reading(integers, (UnwrappedCounter(), UnwrappedCounter()))


def test_a_tally_goes_on_past_its_bits_and_past_a_restart() -> None:
    tally = UnwrappedCounter()
    assert [tally.count(value) for value in (2**31 - 10, 2**31 - 1, -(2**31) + 5)] == [0, 9, 15]
    tally.restart()
    assert [tally.count(value) for value in (0, 4, 1)] == [15, 19, 16]
