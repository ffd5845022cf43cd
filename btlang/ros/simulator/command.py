"""What `btc sim-ros` does: the simulated robot over ROS 2, until a signal ends it."""

from __future__ import annotations

import argparse
import os
import sys
from time import monotonic

from btlang.ros.command import add_namespace
from btlang.ros.ending import ending_signals
from btlang.run.emergency import emergency_signal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.world import World

PACKAGES = (
    "builtin_interfaces", "geometry_msgs", "nav_msgs", "rosgraph_msgs",
    "sensor_msgs", "std_msgs", "std_srvs", "trajectory_msgs",
)  # fmt: skip
"""The packages of messages that it needs beside rclpy."""


def add_sim_options(parser: argparse.ArgumentParser) -> None:
    """The options of `btc sim-ros` that are about ROS 2."""
    parser.add_argument(
        "--clock", action=argparse.BooleanOptionalAction, default=True, help="give the simulated time on /clock"
    )
    add_namespace(parser, "of all topics (default: none)")


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


def _print(line: str) -> None:
    print(line, flush=True)
