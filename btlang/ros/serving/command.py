"""What `btc serve-actions` does, until a signal ends it. Imports no ROS before it is asked for."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from btlang.arguments import between, node_name, real_speed
from btlang.backends.engine import bind_leaf
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.engine.instance import EngineError
from btlang.mission_vocabulary import world_vocabulary
from btlang.robots.preflight import find_missing_parts
from btlang.robots.registry import connector
from btlang.ros.available import require_interfaces, require_ros
from btlang.ros.command import add_body_options, add_namespace, platform_of
from btlang.ros.serving.names import FOLDER, choose_actions, find_servable
from btlang.run.limits import RATES
from btlang.session import Session
from btlang.text.output import show
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import SEQUENCE
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.connection import Connection
    from btlang.vocabulary.lexicon import Lexicon

_ANSWERS = 1.0  # seconds that the last answers to clients get


def add_serving_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `btc serve-actions`, apart from those of words and worlds."""
    add_body_options(parser, ("simulated", "ros"))
    parser.add_argument("--sim-time", action="store_true", help="with --robot ros: use the time of the topic /clock")
    parser.add_argument("--speed", type=real_speed, default="real", help="real, or a factor of real time")
    parser.add_argument(
        "--rate", type=between(*RATES), default=20.0, metavar="HZ", help="ticks per second (default: 20)"
    )
    parser.add_argument(
        "--only",
        nargs="+",
        action="extend",
        default=[],
        metavar="ID",
        help="serve only these actions, or topics of `btc words`",
    )
    parser.add_argument(
        "--name", default="btlang_actions", type=node_name, help="name of the node (default: %(default)s)"
    )
    add_namespace(parser, "namespace of the actions, and with --robot ros of the robot (default: none)")
    parser.add_argument("--ros-args", nargs=argparse.REMAINDER, help="all further arguments are for ROS 2")


def serve(options: argparse.Namespace) -> int:
    """Serve actions until a signal comes; return the exit code, 128 plus the number of the signal.

    Raises MissionError without ROS 2 (BT100, BT110), or if an action can't run (BT080, BT104 to BT106).
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
        _check(session.connection, ids, vocabulary)
        return _spin(session.connection, ids, vocabulary, options)


def _check(connection: Connection, ids: Sequence[str], vocabulary: Lexicon) -> None:
    """Report what the robot lacks. Raises MissionError if an action can't be bound."""
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


def _spin(connection: Connection, ids: Sequence[str], vocabulary: Lexicon, options: argparse.Namespace) -> int:
    from btlang.printer.phrase import phrase_of
    from btlang.ros.command import keep_ending_signals
    from btlang.ros.node import SpunNode
    from btlang.ros.serving.goal_executor import GoalExecutor
    from btlang.ros.serving.server import serve_actions
    from btlang.run.bus import Bus
    from btlang.run.command import STILL_MOVING, warn_of_motion
    from btlang.run.controls import Controls
    from btlang.run.emergency import emergency_signal
    from btlang.run.lines import Lines
    from btlang.run.runner import Runner

    bus = Bus("actions", queued=True)
    bus.add(Lines(lambda node: phrase_of(node, vocabulary), lambda node: True, show))
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
            serve_actions(spun.node, ids, vocabulary, executor, controls.emergency_stop)
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
