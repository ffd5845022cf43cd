"""The verbs `sim-ros` and `ros-devices`: topics of a simulated robot and of devices, until a signal ends them.

Importing this imports no ROS.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Mapping
from contextlib import closing

from btlang.components.device_robot import simulate_devices
from btlang.devices.device_set import DeviceSet
from btlang.devices.driver import DeviceError
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.registry import runs_on
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import read_world
from btlang.ros.available import require_ros
from btlang.ros.devices.driver import PACKAGES
from btlang.ros.ending import EndingSignals, keep_ending_signals
from btlang.run.controls import Controls, emergency_signal
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_SIMULATOR_PACKAGES = (
    "builtin_interfaces", "geometry_msgs", "nav_msgs", "rosgraph_msgs",
    "sensor_msgs", "std_msgs", "std_srvs", "trajectory_msgs",
)  # fmt: skip
_RATE, _SMOOTH_RATE = 20.0, 50.0  # steps a simulated second
_DEVICE_RATE = 30.0  # looks a second at the devices
_LATE = 0.1  # seconds of real time that are caught up with after a late step
_UNCOMPILED = (
    "no /heard, /asking, /sightings, /follow and /hand_over: btlang's interfaces are not compiled"
    " (python -m btlang.ros.interfaces --own)"
)


def simulate_robot(options: argparse.Namespace) -> int:
    """Step the simulation `rate` times a simulated second, `speed` simulated seconds a second, until a signal comes.

    Return the exit code, 128 and the number of the signal. Raises MissionError (BT070, BT071, BT100).
    """
    body = runs_on(options.robot, "simulated")[0]
    world = read_world(options.world, body)
    with keep_ending_signals() as came:  # before ROS 2 is imported, where an interrupt may get lost
        return _simulate(options, body, world, came)


def _simulate(options: argparse.Namespace, body: Body, world: World, came: EndingSignals) -> int:
    speed = 1.0 if options.speed == "real" else options.speed
    rate = options.rate or (_SMOOTH_RATE if body.is_smooth else _RATE)
    require_ros(*_SIMULATOR_PACKAGES)
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
        due = time.monotonic()
        while not came.numbers:
            due = max(due + 1 / (rate * speed), time.monotonic() - _LATE)
            simulator.work(due - time.monotonic())
            simulator.step(1 / rate)
    return 128 + came.numbers[0]


def show_devices(options: argparse.Namespace) -> int:
    """Show the devices of a robot until a signal comes; return the exit code, 128 and the number of the signal.

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
                controls.wait(1 / _DEVICE_RATE)
                now = time.monotonic()
                devices.step()
                twin.step(now - last)
                last = now
                topics.publish()
    return 128 + came.numbers[0]


def _report(kind: str, data: Mapping[str, Any]) -> None:
    """Print that a device has fallen silent, or is back."""
    show(str(data["text"]))
