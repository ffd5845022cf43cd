"""A simulated robot over ROS 2 that goes step by step with the mission, however slow or busy the machine is.

    python -m tests.ros.lock_step WORLD

is the robot: `btc sim-ros` that is not paced by real time but by the mission. `in_lock_step` makes the missions of this
process pace it. A tick sees all that the step before it told, and a step all that the tick before it commanded.
"""

from __future__ import annotations

import sys
from math import inf
from time import monotonic

import pytest
from std_msgs.msg import Float64

from btlang.robots.worlds.world_file import read_world
from btlang.ros.clocks import RosPace
from btlang.ros.ending import keep_ending_signals
from btlang.ros.robot.connection import RosConnection
from btlang.ros.simulator.simulator import Simulator
from btlang.run.controls import Controls

_ALLOWED, _DONE = "/lock_step/allowed", "/lock_step/done"
"""Until which simulated second the robot may step, and how far it has come. Subscribed to last, so heard last."""
_STEP = 0.1  # simulated seconds, and seconds of real time where no mission has ticked yet
_PATIENCE = 0.5  # real seconds after which the robot takes a step unasked: while a mission ends nothing ticks
_EXACT = 1e-6


class LockStep(RosPace):
    """A period is over when the robot has come as far."""

    def __init__(self, stage: RosConnection, controls: Controls) -> None:
        self._clock = stage.node.get_clock()
        super().__init__(controls, lambda: float(self._clock.now().nanoseconds) * 1e-9)
        self._done = 0.0
        self._allowed = stage.node.create_publisher(Float64, _ALLOWED, 10)
        stage.node.create_subscription(Float64, _DONE, self._stepped, 10)

    def _stepped(self, message: Float64) -> None:
        self._done = message.data
        self._controls.wake()

    def sleep(self, period: float, wait: float = inf) -> float:
        due = self._last + max(_STEP, min(period, wait))
        self._allowed.publish(Float64(data=due))
        while (now := self._done) < due - _EXACT and not self._woken and not self._controls.stopped:
            self._controls.wait(None)
        passed, self._last = max(0.0, now - self._last), max(now, self._last)
        return passed

    def rest(self, seconds: float) -> float:
        """The robot steps unasked when it has waited for long enough."""
        self._allowed.publish(Float64(data=self._done + seconds))
        return super().rest(seconds)


def in_lock_step(patch: pytest.MonkeyPatch) -> None:
    """From now on missions with `--robot ros --sim-time` in this process go in lock step with such a robot."""
    patch.setattr(RosConnection, "pace", lambda stage, speed, controls: LockStep(stage, controls))


def serve(world: str) -> int:
    """Until a signal comes; returns the exit code, as `btc sim-ros` does."""
    allowed = 0.0
    with keep_ending_signals() as came:
        simulator = Simulator(read_world(world), namespace="", gives_clock=True, show=lambda line: None)
        robot = simulator.robot

        def allow(message: Float64) -> None:
            nonlocal allowed
            allowed = message.data
            simulator.wake()

        simulator.node.create_subscription(Float64, _ALLOWED, allow, 10)
        done = simulator.node.create_publisher(Float64, _DONE, 10)
        with simulator:
            came.on_arrival = simulator.wake
            print("ready", flush=True)
            while not came.numbers:
                end = monotonic() + (_PATIENCE if allowed else _STEP)
                while robot.time + _STEP > allowed + _EXACT and monotonic() < end and not came.numbers:
                    simulator.work(end - monotonic())
                simulator.work(0.0)
                simulator.step(_STEP)
                done.publish(Float64(data=robot.time))
    return 128 + came.numbers[0]


if __name__ == "__main__":
    sys.exit(serve(sys.argv[1]))
