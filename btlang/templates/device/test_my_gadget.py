"""Tests of the driver in the loop that reads it on a robot."""

from math import inf

import pytest
from btlang.devices.driver import DeviceSilent

from my_gadget import GadgetDriver


@pytest.fixture
def sensor(device):
    made = device(GadgetDriver, "range", port="loopback")  # closed after the test
    made.wait()  # until it has answered
    return made


def test_it_tells_metres(sensor):
    sensor.driver.line.answer = b"1234\n"
    assert sensor.wait(lambda reading: reading.distance == 1.234)


def test_nothing_in_range(sensor):
    sensor.driver.line.answer = b"-\n"
    assert sensor.wait(lambda reading: reading.distance == inf)


def test_what_it_cannot_mean_is_not_used(sensor):
    sensor.driver.line.answer = b"12q4\n"
    assert sensor.wait_for_silence() == "it says b'12q4'"
    with pytest.raises(DeviceSilent):
        sensor.read()
    sensor.driver.line.answer = b"500\n"
    assert sensor.wait(lambda reading: reading.distance == 0.5)


def test_one_that_says_nothing_is_silent(sensor):
    sensor.driver.line.answer = b""
    assert sensor.wait_for_silence() == "it reports nothing new"
