"""What `btc ros-node` does: missions as a ROS 2 node, until a signal ends it. Imports no ROS before it is asked for."""

from __future__ import annotations

import argparse
import os
import signal
from contextlib import ExitStack, closing
from functools import partial
from typing import Any

from btlang.arguments import node_name
from btlang.ros.available import require_interfaces, require_ros
from btlang.ros.command import EndingSignals, add_body_options, add_namespace, keep_ending_signals, platform_of
from btlang.task.options import add_companion_options, add_layer_options
from btlang.text.output import show

PACKAGES = ("diagnostic_msgs", "lifecycle_msgs", "std_msgs", "std_srvs")
"""The packages of messages that it needs beside rclpy and btlang_interfaces."""
_ANSWERS = 1.0  # seconds that the last answers to clients get


def add_node_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `btc ros-node` that are about the node."""
    parser.add_argument("--mission", default="", metavar="FILE", help="mission to run when the node is activated")
    add_body_options(parser)
    parser.add_argument(
        "--sim-time", action="store_true", help="with --robot ros or actions: use the time of the topic /clock"
    )
    add_namespace(parser, "namespace of the node, and with --robot ros or actions of the robot (default: none)")
    parser.add_argument("--name", default="btlang", type=node_name, help="name of the node (default: %(default)s)")
    parser.add_argument(
        "--autostart",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="configure and activate the node at once (default), or leave that to a lifecycle manager",
    )
    add_layer_options(parser)
    add_companion_options(parser)
    parser.add_argument("--ros-args", nargs=argparse.REMAINDER, help="all further arguments are for ROS 2")


def serve(options: argparse.Namespace) -> int:
    """Spin the node until a signal comes; return the exit code, 128 plus the number of the signal.

    Raises MissionError without ROS 2 (BT100, BT110), or if the node can't be configured at its start.
    """
    if platform_of(options) == "simulated" and options.sim_time:
        options.refuse("--sim-time is for --robot ros and --robot actions")
    with keep_ending_signals() as came:  # before ROS 2 is imported, where an interrupt may get lost
        return _serve(options, came)


def _serve(options: argparse.Namespace, came: EndingSignals) -> int:
    require_ros()
    require_interfaces()
    require_ros(*PACKAGES)
    from btlang.ros.mission.node import MissionNode, Setup, StopNode, robot_name
    from btlang.ros.node import SpunNode
    from btlang.run.controls import Controls
    from btlang.run.emergency import emergency_signal
    from btlang.task.companion import companions
    from btlang.task.robot_command import layer_options
    from btlang.task.socket_server import SocketServer
    from btlang.task.timeliness import keep_ticks_in_time

    robot = robot_name(options.namespace, options.name)
    setup = Setup(
        options.name, options.robot, options.over, options.sim_time, options.namespace, options.speed,
        options.mission, options.keywords, options.world, options.parser, options.include_root, options.allow_keywords,
        options.language, layer_options(options, robot),
    )  # fmt: skip
    controls = Controls()
    came.on_arrival = controls.wake
    door = SocketServer(
        robot,
        lambda data, person: node.answer(data, person),
        lambda person: node.emergency_stop(person),
        lambda *wanted: node.watch(*wanted),
    )
    with closing(door):  # the name is ours before the store and the robot are touched
        spun = SpunNode(
            options.name,
            namespace=options.namespace,
            use_sim_time=options.sim_time,
            make=partial(MissionNode, setup, show, partial(os.kill, os.getpid(), signal.SIGTERM)),
        )
        node: Any = spun.node
        stop = partial(StopNode, node.resolve_service_name("~/stop"), node.emergency_stop)
        stopping = SpunNode(f"{options.name}_stop", namespace=options.namespace, make=stop)
        ending = ExitStack()
        try:
            if options.autostart:
                node.trigger_configure()
                if node.error is not None:
                    raise node.error
                node.trigger_activate()
            ending.enter_context(emergency_signal(partial(node.emergency_stop, "the keyboard"), node.disable))
            with stopping, companions(options, robot, show) as code:
                spun.start()
                door.start()
                keep_ticks_in_time()
                show(f"btlang ros-node: ready as {node.get_fully_qualified_name()}; Ctrl-C ends it")
                while not code and not came.numbers:
                    controls.wait(None)
                node.halt()
                spun.settle(_ANSWERS)
        finally:
            with ending:
                try:
                    node.halt()
                    stopping.close()
                    spun.close()
                finally:
                    node.release()
    return 128 + came.numbers[0] if came.numbers else code
