"""Runs leaves by hand: tick, then let 0.05 s pass, as a runner at 20 Hz does."""

from inspect import isgenerator

import pytest

from btlang.engine.clock import Clock
from btlang.robots.geometry import Pose
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import Person, World, WorldObject

TICK = 0.05


class Bench:
    """A robot, a clock and the events that the robot told."""

    def __init__(self, world, body=None):
        self.events = []
        self.clock = Clock()
        self.robot = SimulatedRobot(world, lambda kind, data: self.events.append((kind, dict(data))), body)

    def tick(self, times=1):
        for _ in range(times):
            self.robot.step(TICK)
            self.clock.advance(TICK)

    def run(self, leaf, seconds=120.0, **ports):
        """Ticks the leaf to its end and returns its value and the seconds it took."""
        begin = self.clock.now
        result = leaf(self.robot, **ports)
        if not isgenerator(result):
            return result, 0.0
        while self.clock.now - begin < seconds:
            try:
                next(result)
            except StopIteration as end:
                return end.value, self.clock.now - begin
            self.tick()
        raise AssertionError(f"still running after {seconds} s")

    def begin(self, leaf, seconds, **ports):
        """Ticks the leaf for some seconds and returns it in the middle of its work."""
        running = leaf(self.robot, **ports)
        for _ in range(round(seconds / TICK)):
            next(running)
            self.tick()
        return running


@pytest.fixture
def bench():
    """Makes a bench in a world, by default a large empty one."""

    def make(world=None, body=None, **changes):
        return Bench((world or World(start=Pose(0.0, 0.0))).replace(**changes), body)

    return make


@pytest.fixture
def table():
    """Things and people around the origin."""
    return World(
        start=Pose(0.0, 0.0, 0.0),
        objects=(WorldObject("cup", 0.42, 0.0, 0.04), WorldObject("ball", 3.0, 1.0, 0.1)),
        people=(Person("Alice", 0.0, 2.0, 0.25),),
    )
