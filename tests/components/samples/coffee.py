"""A coffee machine, as somebody else might write one, with hooks that go wrong on demand."""

import os
import time

import btlang
from btlang import Component, Parameter
from btlang.devices.kinds import WheelSpeeds


class Machine(Component):
    version = "1.0"
    rate = 10
    heat = Parameter(90.0, low=60, high=95, unit="°C")
    wrong = Parameter("")  # what goes wrong

    def configure(self):
        self.cups = 0
        self._go_wrong("configure")

    def activate(self):
        self._go_wrong("activate")

    def step(self, seconds):
        self._go_wrong("step")

    def brew(self, drink, robot):
        self._go_wrong("brew")
        self.report("say", cups=self.cups)  # with the name of an event of robots, but other fields
        robot.print(f"brewing {drink} at {self.heat:g}")
        yield
        self.cups += 1

    def bring(self, place, robot):
        going = robot.navigate_to(place)
        while not going.done:
            yield
        return going.failure is None

    def roll(self, robot):
        robot.drive(0.3, 0.0)
        while True:
            yield

    def push(self):
        while True:
            self.write("wheels", WheelSpeeds(0.3, 0.3))
            yield

    def has_brewed(self):
        return self.cups > 0

    def is_full(self):
        if self.wrong == "forget it":
            return None
        if self.wrong == "slip":
            return self.cups > self.capacity
        return btlang.Failed(lambda: f"it has brewed {self.cups} of 3")

    def serve(self):
        return btlang.Failed("the tray is empty")

    def count(self):
        return self.cups

    def _go_wrong(self, where):
        what, _, when = self.wrong.partition(" in ")
        if when != where:
            return
        if what == "raise":
            raise RuntimeError("no water")
        if what == "hang":
            time.sleep(1000)
        if what == "exit":
            os._exit(7)


class Broken:
    """No component."""
