"""Tests of the gadget alone: no robot, no world, and the test is its devices."""

import pytest
from btlang import ActionFailed
from btlang.devices.kinds import Colour, Pressed

from my_gadget import Gadget


@pytest.fixture
def machine(component):
    component.readings["gadget lid"] = Pressed(False)
    return component(Gadget, speed=50)  # configured and active; brought down after the test


def test_it_works_until_it_is_finished(component, machine):
    work = machine.run()
    next(work)
    for _ in range(19):
        machine.step(0.1)
        next(work)
    assert component.commands["gadget lamp"] == Colour(green=1.0)
    assert not machine.is_finished()
    machine.step(0.2)
    with pytest.raises(StopIteration):
        next(work)
    assert machine.is_finished()
    machine.step(0.1)
    assert component.commands["gadget lamp"] == Colour()


def test_it_refuses_while_the_lid_is_open(component, machine):
    component.readings["gadget lid"] = Pressed(True)
    with pytest.raises(ActionFailed, match="the lid is open"):
        next(machine.run())


def test_a_stop_ends_its_work(machine):
    work = machine.run()
    next(work)
    work.close()
    assert not machine.works
