"""The verbs `ros-node` and `serve-actions`: missions and actions as ROS 2 nodes, until a signal ends them.

Importing this imports no ROS.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Sequence
from contextlib import ExitStack, closing
from functools import partial
from typing import Any

from btlang.backends.engine import bind_leaf
from btlang.cli.robots import platform_of
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.engine.instance import EngineError
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.robots.preflight import find_missing_parts
from btlang.robots.registry import connector
from btlang.ros.available import require_interfaces, require_ros
from btlang.ros.ending import EndingSignals, keep_ending_signals
from btlang.ros.serving.names import FOLDER, choose_actions, find_servable
from btlang.run.controls import Controls, emergency_signal
from btlang.session import Session
from btlang.text.output import show
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import SEQUENCE
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.connection import Connection
    from btlang.vocabulary.lexicon import Lexicon

_PACKAGES = ("diagnostic_msgs", "lifecycle_msgs", "std_msgs", "std_srvs")  # beside rclpy and btlang_interfaces
_ANSWERS = 1.0  # seconds that the last answers to clients get


def run_mission_node(options: argparse.Namespace) -> int:
    """Spin the node until a signal comes; return the exit code, 128 and the number of the signal.

    Raises MissionError where ROS 2 is not there (BT100, BT110), or where the node cannot be configured at its start.
    """
    if platform_of(options) == "simulated" and options.sim_time:
        options.refuse("--sim-time is for --robot ros and --robot actions")
    with keep_ending_signals() as came:  # before ROS 2 is imported, where an interrupt may get lost
        return _spin_node(options, came)


def _spin_node(options: argparse.Namespace, came: EndingSignals) -> int:
    require_ros()
    require_interfaces()
    require_ros(*_PACKAGES)
    from btlang.cli.robot import layer_options
    from btlang.ros.mission.node import MissionNode, StopNode
    from btlang.ros.mission.setup import Setup, robot_name
    from btlang.ros.node import SpunNode
    from btlang.task.commands.companion import companions
    from btlang.task.commands.socket_server import SocketServer
    from btlang.task.layer import keep_ticks_in_time

    robot = robot_name(options.namespace, options.name)
    setup = Setup(
        options.name, options.robot, options.over, options.sim_time, options.namespace, options.speed,
        options.mission, options.keywords, options.world, options.parser, options.include_root, options.allow_keywords,
        options.language, layer_options(options, robot),
    )  # fmt: skip
    controls = Controls()
    came.on_arrival = controls.wake
    socket_server = SocketServer(
        robot,
        lambda data, person: node.answer(data, person),
        lambda person: node.emergency_stop(person),
        lambda *wanted: node.watch(*wanted),
    )
    with closing(socket_server):  # the name is ours before the store and the robot are touched
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
                socket_server.start()
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


def serve_actions(options: argparse.Namespace) -> int:
    """Serve actions until a signal comes; return the exit code, 128 and the number of the signal.

    Raises MissionError where ROS 2 is not there (BT100, BT110), or where an action cannot run (BT080, BT104 to BT106).
    """
    over = platform_of(options)
    if over == "actions":
        options.refuse("btc serve-actions serves the actions itself: it takes no robot that runs on actions")
    if over != "ros" and options.sim_time:
        options.refuse("--sim-time is for --robot ros")
    vocabulary = world_vocabulary(options.keywords, options.world, options.language)
    try:
        ids = choose_actions(options.only, find_servable(vocabulary, ros=over == "ros"), vocabulary)
    except ValueError as problem:
        options.refuse(str(problem))
    require_ros("std_srvs")
    require_interfaces()
    named = {"sim_time": options.sim_time, "namespace": options.namespace, "name": f"{options.name}_robot"}
    with Session(connector(options.robot, options.over, **named), world=options.world) as session:
        _check_actions(session.connection, ids, vocabulary)
        return _spin_actions(session.connection, ids, vocabulary, options)


def _check_actions(connection: Connection, ids: Sequence[str], vocabulary: Lexicon) -> None:
    """Report what the robot lacks. Raises MissionError where an action cannot be bound."""
    everything = Tree(Node(SEQUENCE, tuple(Node(node_id) for node_id in ids)))
    survey = getattr(connection, "survey", None)  # of a ROS 2 robot
    for interface, (node, reason) in survey(everything, vocabulary).items() if survey is not None else ():
        if reason:
            user = f", which {node.id} needs" if node is not None else ""
            show(f"btlang serve-actions: no {interface.name}{user}: {reason}", stream=sys.stderr)
    body = connection.robot.body
    for part, node in find_missing_parts(body, everything, vocabulary).items():
        show(f"btlang serve-actions: the robot '{body.name}' has no {part}, which {node.id} needs", stream=sys.stderr)
    for node_id in ids:
        try:
            bind_leaf(node_id, vocabulary, connection.bind)
        except EngineError as error:
            span = error.node.span or NOWHERE
            raise MissionError([diagnostic("BT080", span, id=node_id, reason=error.message)]) from None


def _spin_actions(connection: Connection, ids: Sequence[str], vocabulary: Lexicon, options: argparse.Namespace) -> int:
    from btlang.printer.phrase import phrase_of
    from btlang.ros.node import SpunNode
    from btlang.ros.serving import server
    from btlang.ros.serving.goal_executor import GoalExecutor
    from btlang.run.bus import Bus
    from btlang.run.logs import PlainLines
    from btlang.run.runner import Runner
    from btlang.run.terminal import STILL_MOVING, warn_of_motion

    bus = Bus("actions", queued=True)
    bus.add(PlainLines(lambda node: phrase_of(node, vocabulary), lambda node: True, show))
    connection.begin(bus)
    controls = Controls()
    executor = GoalExecutor(connection, vocabulary)
    moves = False
    runner = Runner(
        executor, bus=bus, robot=connection.robot, rate=options.rate,
        speed=1.0 if options.speed == "real" else options.speed, controls=controls, pace=connection.pace,
    )  # fmt: skip
    with keep_ending_signals() as came, emergency_signal(controls.emergency_stop, controls.disable):
        came.on_arrival = controls.stop
        spun = SpunNode(options.name, namespace=options.namespace, use_sim_time=options.sim_time)
        try:
            server.serve_actions(spun.node, ids, vocabulary, executor, controls.emergency_stop)
            spun.start()
            where = f"{spun.node.get_namespace().rstrip('/')}/{FOLDER}"
            show(f"btlang serve-actions: ready with {len(ids)} actions in {where}; Ctrl-C ends it")
            while not came.numbers:
                outcome = runner.run()  # until a signal, or an emergency stop, after which it goes on
                moves = warn_of_motion(outcome.standstill)
                controls.take_emergency()
                executor.answer_all()
            spun.settle(_ANSWERS)
        finally:
            spun.close()
            bus.close()
    return STILL_MOVING if moves else 128 + came.numbers[0]
