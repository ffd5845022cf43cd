"""The gadget: a component that works for a while, shows that with a lamp, and refuses while its lid is open."""

from btlang import ActionFailed, Component, Parameter
from btlang.devices.kinds import Colour


class Gadget(Component):
    version = "0.1.0"
    needs = ("gadget lamp", "gadget lid")  # devices of the robot file
    rate = 10.0  # steps a second

    speed = Parameter(25.0, low=1.0, high=100.0, unit="percent a second", help="how fast it works")

    # Its life: before missions, between them and after them.

    def activate(self):
        self.percent = 0.0
        self.works = False

    def deactivate(self):
        self.works = False

    def step(self, seconds):
        if self.works:
            self.percent = min(100.0, self.percent + self.speed * seconds)
        self.write("gadget lamp", Colour(green=1.0) if self.works else Colour())

    # The words of my_gadget.toml.

    def run(self):
        if self.read("gadget lid").pressed:
            raise ActionFailed("the lid is open")
        self.percent, self.works = 0.0, True
        try:
            while self.percent < 100.0:
                yield  # lets time pass
        finally:
            self.works = False  # also when the mission stops it half-way

    def is_finished(self):
        return self.percent >= 100.0

    def progress(self):
        return self.percent
