"""What `btc sim-ros` does: the simulated robot over ROS 2, until a signal ends it."""

from __future__ import annotations

import argparse
import os
import sys
from time import monotonic

from btlang.arguments import between, real_speed
from btlang.robots.bodies.body import Body
from btlang.robots.platforms import add_world
from btlang.robots.registry import runs_on
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import read_world
from btlang.ros.command import EndingSignals, add_body_options, add_namespace, keep_ending_signals
from btlang.run.emergency import emergency_signal
from btlang.run.limits import RATES
from btlang.text.output import show

PACKAGES = (
    "builtin_interfaces", "geometry_msgs", "nav_msgs", "rosgraph_msgs",
    "sensor_msgs", "std_msgs", "std_srvs", "trajectory_msgs",
)  # fmt: skip
"""The packages of messages that it needs beside rclpy."""
_RATE, _SMOOTH_RATE = 20.0, 50.0
_LATE = 0.1  # seconds of real time that are caught up with after a late step
_UNCOMPILED = (
    "no /heard, /asking, /sightings, /follow and /hand_over: btlang's interfaces are not compiled"
    " (python -m btlang.ros.interfaces --own)"
)


def add_simulator_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `btc sim-ros`."""
    add_world(parser)
    add_body_options(parser, ("simulated",))
    parser.add_argument("--speed", type=real_speed, default="real", help="real, or a factor of real time")
    parser.add_argument(
        "--rate", type=between(*RATES), metavar="HZ",
        help="steps per simulated second (default: 20, or 50 for a body whose joints have accelerations)",
    )  # fmt: skip
    parser.add_argument(
        "--clock", action=argparse.BooleanOptionalAction, default=True, help="publish simulated time on /clock"
    )
    parser.add_argument(
        "--seed", type=int, metavar="N", help="what people do by chance (default: the seed of the world, or 0)"
    )
    add_namespace(parser, "namespace of all topics (default: none)")


def serve(options: argparse.Namespace) -> int:
    """Step the simulation `rate` times a simulated second, `speed` simulated seconds a second, until a signal comes.

    Returns the exit code, 128 plus the number of the signal. Raises MissionError (BT070, BT071, BT100).
    """
    body = runs_on(options.robot, "simulated")[0]
    world = read_world(options.world, body)
    with keep_ending_signals() as came:  # before ROS 2 is imported, where an interrupt may get lost
        return _simulate(options, body, world, came)


def _simulate(options: argparse.Namespace, body: Body, world: World, came: EndingSignals) -> int:
    speed = 1.0 if options.speed == "real" else options.speed
    rate = options.rate or (_SMOOTH_RATE if body.is_smooth else _RATE)
    from btlang.ros.available import require_ros

    require_ros(*PACKAGES)
    from btlang.ros.simulator.simulator import Simulator, can_meet_people, can_navigate

    simulator = Simulator(
        world, namespace=options.namespace, gives_clock=options.clock, show=show, body=body, seed=options.seed
    )
    with simulator, emergency_signal(simulator.robot.stop, simulator.robot.stop):
        came.on_arrival = simulator.wake
        simulator.step(1 / rate)
        if not can_navigate():
            show("btlang sim-ros: no /navigate_to_pose: the package nav2_msgs is not installed", stream=sys.stderr)
        if not can_meet_people():
            show(f"btlang sim-ros: {_UNCOMPILED}", stream=sys.stderr)
        where = f"domain {os.environ.get('ROS_DOMAIN_ID') or 0}, namespace /{options.namespace.strip('/')}"
        show(f"btlang sim-ros: ready at speed {speed:g} ({where}); Ctrl-C ends it")
        due = monotonic()
        while not came.numbers:
            due = max(due + 1 / (rate * speed), monotonic() - _LATE)
            simulator.work(due - monotonic())
            simulator.step(1 / rate)
    return 128 + came.numbers[0]
