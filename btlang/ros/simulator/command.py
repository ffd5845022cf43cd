"""What `btc sim-ros` does: the simulated robot over ROS 2, until a signal ends it."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from btlang.run.command import ENDING_SIGNALS
from btlang.run.emergency import emergency_signal

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

    with ending_signals() as came:
        simulator = Simulator(world, namespace=namespace, gives_clock=gives_clock, show=_print)
        with simulator, emergency_signal(simulator.robot.stop):
            came.on_arrival = simulator.wake
            simulator.step(1 / rate)
            if not can_navigate():
                print("btlang sim-ros: no /navigate_to_pose: the package nav2_msgs is not installed", file=sys.stderr)
            where = f"domain {os.environ.get('ROS_DOMAIN_ID') or 0}, namespace /{namespace.strip('/')}"
            _print(f"btlang sim-ros: ready at speed {speed:g} ({where}); Ctrl-C ends it")
            due = monotonic()
            while not came.numbers:
                due = max(due + 1 / (rate * speed), monotonic())  # time after a late step is not caught up with
                simulator.work(due - monotonic())
                simulator.step(1 / rate)
    return 128 + came.numbers[0]


class EndingSignals:
    """Those that have come; `on_arrival` is called by each."""

    def __init__(self) -> None:
        self.numbers: list[int] = []
        self.on_arrival: Callable[[], object] = int

    def __call__(self, number: int, frame: object) -> None:
        self.numbers.append(number)
        self.on_arrival()


@contextmanager
def ending_signals() -> Iterator[EndingSignals]:
    """Ctrl-C and signals to end are kept instead of ending the process at once. One that is ignored stays so."""
    came = EndingSignals()
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, *ENDING_SIGNALS)}
    taken = [number for number, handler in before.items() if handler != signal.SIG_IGN]
    for number in taken:
        signal.signal(number, came)
    try:
        yield came
    finally:
        for number in taken:
            signal.signal(number, before[number])


def _print(line: str) -> None:
    print(line, flush=True)
