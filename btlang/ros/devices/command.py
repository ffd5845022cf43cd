"""What `btc ros-devices` does: the devices of a robot as topics, until a signal ends it. Imports no ROS before that."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Mapping
from contextlib import closing

from btlang.arguments import robot_on
from btlang.components.device_robot import simulate_devices
from btlang.devices.device_set import DeviceSet
from btlang.devices.driver import DeviceError
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.platforms import add_simulate, add_world
from btlang.robots.registry import runs_on
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import read_world
from btlang.ros.available import require_ros
from btlang.ros.command import EndingSignals, add_namespace, keep_ending_signals
from btlang.ros.devices.driver import PACKAGES
from btlang.run.controls import Controls
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_RATE = 30.0  # looks a second at the devices


def add_device_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `btc ros-devices`."""
    add_world(parser)
    parser.add_argument(
        "--robot", type=robot_on(()), required=True, metavar="ROBOT", help="a robot file or the name of one that ships"
    )
    add_simulate(parser)
    add_namespace(parser, "namespace of all topics (default: none)")


def serve(options: argparse.Namespace) -> int:
    """Publish the devices until a signal comes; return the exit code, 128 plus the number of the signal.

    Raises MissionError (BT070, BT071, BT100).
    """
    body = runs_on(options.robot, "devices")[0]
    world = read_world(options.world, body)
    try:
        body = body.replace(devices=simulate_devices(body, options.simulate))
    except DeviceError as problem:
        raise unusable_robot(problem) from None
    if not body.devices:
        options.refuse("the robot file has no [[device]]; --simulate shows simulated ones")
    with keep_ending_signals() as came:  # before ROS 2 is imported, where an interrupt may get lost
        return _show_devices(options, body, world, came)


def _show_devices(options: argparse.Namespace, body: Body, world: World, came: EndingSignals) -> int:
    require_ros(*PACKAGES)
    from btlang.ros.devices.nodes import DeviceTopics
    from btlang.ros.node import SpunNode

    controls = Controls()
    came.on_arrival = controls.wake
    twin = SimulatedRobot(world, None, body)
    try:
        devices = DeviceSet(body, twin, _report)
    except DeviceError as problem:
        raise unusable_robot(problem) from None
    with closing(devices):
        devices.start()
        spun = SpunNode("btlang_device_topics", namespace=options.namespace)
        with closing(spun):
            topics = DeviceTopics(spun.node, devices.devices, devices.readers, body)
            spun.start()
            where = f"domain {os.environ.get('ROS_DOMAIN_ID') or 0}, namespace /{options.namespace.strip('/')}"
            show(f"btlang ros-devices: ready with {len(devices.devices)} devices ({where}); Ctrl-C ends it")
            last = time.monotonic()
            while not came.numbers:
                controls.wait(1 / _RATE)
                now = time.monotonic()
                devices.step()
                twin.step(now - last)
                last = now
                topics.publish()
    return 128 + came.numbers[0]


def _report(kind: str, data: Mapping[str, Any]) -> None:
    """Print that a device has fallen silent, or is back."""
    show(str(data["text"]))
