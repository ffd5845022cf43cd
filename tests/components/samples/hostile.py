"""Components that break the rules, each in its own way."""

import sys
import time

from btlang import Component
from btlang.devices.kinds import WheelSpeeds


class BrokenConstructor(Component):
    def __init__(self):
        raise RuntimeError("no water")


class FailingStep(Component):
    rate = 5.0

    def activate(self):
        self.steps = 0

    def step(self, seconds):
        self.steps += 1
        if self.steps == 2:
            raise OSError("the pump is broken")

    def roll(self, robot):
        robot.drive(0.3, 0.0)
        while True:
            yield


class ExitingStep(FailingStep):
    def step(self, seconds):
        sys.exit(3)


class EndlessHook(Component):
    def activate(self):
        while True:
            self.write("wheels", WheelSpeeds(0.3, 0.3))
            time.sleep(0.01)


class Liar(Component):
    def roll(self, robot):
        robot.drive(float("nan"), 0.0)
        while True:
            yield

    def bend(self, robot):
        robot.move_joints({"head": float("nan")})

    def roll_and_raise(self, robot):
        robot.drive(0.3, 0.0)
        yield
        raise RuntimeError("no water")
