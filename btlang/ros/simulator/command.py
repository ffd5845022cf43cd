"""What `btc sim-ros` does: the simulated robot over ROS 2, until a signal ends it."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from btlang.run.command import ENDING_SIGNALS
from btlang.run.controls import Controls
from btlang.run.emergency import emergency_signal
from btlang.run.pace import Pace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.world import World

PACKAGES = (
    "builtin_interfaces", "geometry_msgs", "nav_msgs", "rosgraph_msgs",
    "sensor_msgs", "std_msgs", "std_srvs", "trajectory_msgs",
)  # fmt: skip
"""The packages of messages that it needs beside rclpy."""


def serve(world: World, *, speed: float, rate: float, gives_clock: bool, namespace: str) -> int:
    """Steps the simulation `rate` times a simulated second, `speed` simulated seconds a second, until a signal comes.

    Returns the exit code, 128 and the number of the signal. Raises MissionError (BT100).
    """
    from btlang.ros.available import require_ros

    require_ros(*PACKAGES)
    from btlang.ros.simulator.simulator import Simulator, can_navigate

    controls = Controls()
    with ended_by_signals(controls) as signals:
        simulator = Simulator(world, namespace=namespace, gives_clock=gives_clock, show=_print)
        with simulator, emergency_signal(simulator.robot.stop):
            if not can_navigate():
                print("btlang sim-ros: no /navigate_to_pose: the package nav2_msgs is not installed", file=sys.stderr)
            simulator.step(1 / rate)
            where = f"domain {os.environ.get('ROS_DOMAIN_ID') or 0}, namespace /{namespace.strip('/')}"
            _print(f"btlang sim-ros: ready at speed {speed:g} ({where}); Ctrl-C ends it")
            pace = Pace(speed, controls)
            pace.begin()
            while not controls.stopped:
                pace.sleep(1 / rate)
                simulator.step(1 / rate)
    return 128 + signals[0]


@contextmanager
def ended_by_signals(controls: Controls) -> Iterator[list[int]]:
    """Signals to end do so between two steps; the list has those that came. One that is ignored stays so."""
    came: list[int] = []

    def end(number: int, frame: object) -> None:
        came.append(number)
        controls.stop()

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, *ENDING_SIGNALS)}
    taken = [number for number, handler in before.items() if handler != signal.SIG_IGN]
    for number in taken:
        signal.signal(number, end)
    try:
        yield came
    finally:
        for number in taken:
            signal.signal(number, before[number])


def _print(line: str) -> None:
    print(line, flush=True)
