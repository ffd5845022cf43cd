"""The options and connections of commands that use ROS 2, such as `btc run`. Imports no ROS before it is needed."""

from __future__ import annotations

import signal
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from importlib.util import find_spec

from btlang.arguments import namespace, robot_on
from btlang.diagnostics.render import render
from btlang.passes.lint.allow import not_allowed, not_silenced
from btlang.robots.platforms import ROBOTS, add_simulate
from btlang.robots.registry import connector, runs_in_real_time, runs_on
from btlang.ros.available import require_interfaces, require_ros, unusable
from btlang.ros.serving.names import FOLDER
from btlang.run.command import ENDING_SIGNALS
from btlang.text.output import has_colour, show
from btlang.text.table import Table

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from btlang.robots.bodies.body import Body
    from btlang.robots.registry import Connector
    from btlang.robots.worlds.world import World
    from btlang.ros.components.host import ComponentNodes
    from btlang.ros.robot.connection import RosConnection
    from btlang.tree.node import Tree
    from btlang.vocabulary.lexicon import Lexicon

_PACKAGES = ("geometry_msgs", "nav_msgs", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs", "trajectory_msgs")
_COMPILE = "Compile it: python -m btlang.ros.interfaces tests/ros/composition_interfaces, in a clone of btlang"


class EndingSignals:
    """The signals that have come; each calls `on_arrival`."""

    def __init__(self) -> None:
        self.numbers: list[int] = []
        self.on_arrival: Callable[[], object] = int

    def __call__(self, number: int, frame: object) -> None:
        self.numbers.append(number)
        self.on_arrival()


@contextmanager
def keep_ending_signals() -> Iterator[EndingSignals]:
    """Keep Ctrl-C and other ending signals, instead of ending the process at once. Ignored ones stay ignored."""
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


def connect_ros(world: World, **options: Any) -> RosConnection:
    """Connect to a ROS 2 robot, with the options of RosConnection. Raises MissionError (BT100) without ROS 2."""
    require_ros(*_PACKAGES)
    from btlang.ros.robot.connection import RosConnection

    return RosConnection(world, **options)


def connect_actions(world: World, *, namespace: str = "", servers: str = "", **options: Any) -> RosConnection:
    """Connect like connect_ros, but let servers do the actions, by default those of the same namespace.

    Raises MissionError (BT100, BT110).
    """
    require_ros(*_PACKAGES)
    require_interfaces()
    servers = servers or f"/{namespace.strip('/')}/{FOLDER}".replace("//", "/")
    return connect_ros(world, namespace=namespace, servers=servers, **options)


def component_nodes(robot: Any, body: Body) -> ComponentNodes:
    """Return the node that leads the components that are ROS 2 nodes. Raises MissionError (BT100) without ROS 2."""
    containers = any(part.node is not None and part.node.container for part in body.components)
    require_ros("lifecycle_msgs", "rcl_interfaces", "std_msgs")
    if containers and find_spec("composition_interfaces") is None:
        raise unusable("there is no Python package composition_interfaces", _COMPILE)
    from btlang.ros.components.host import ComponentNodes

    return ComponentNodes(robot)


def add_robot_options(parser: ArgumentParser) -> None:
    """Add the options of `btc run` that choose a robot."""
    add_body_options(parser)
    add_simulate(parser)
    parser.add_argument(
        "--sim-time", action="store_true", help="with --robot ros or actions: use the time of the topic /clock"
    )
    add_namespace(parser, "with --robot ros or actions: namespace of the robot (default: none)")
    parser.add_argument(
        "--servers",
        metavar="NS",
        help=f"with --robot actions: where the servers are (default: /{FOLDER} in the namespace)",
    )
    parser.add_argument(
        "--preflight", action="store_true", help="with --robot ros or actions: only list what the mission needs"
    )


def add_body_options(parser: ArgumentParser, platforms: Sequence[str] = tuple(ROBOTS)) -> None:
    """Add the options --robot and --over, for a verb whose robot runs on these."""
    parser.add_argument(
        "--robot",
        type=robot_on(platforms),
        default="simulated",
        metavar="ROBOT",
        help=f"{', '.join(platforms)}, a robot file or the name of a robot (default: %(default)s)",
    )
    parser.add_argument(
        "--over", choices=platforms, help="what the robot in a file runs on (default: as the file says)"
    )


def add_namespace(parser: ArgumentParser, what: str) -> None:
    """Add the option --namespace."""
    parser.add_argument("--namespace", type=namespace, default="", metavar="NS", help=what)


def chosen_robot(options: Namespace) -> Connector:
    """Return the chosen robot as `btlang.Session` takes it.

    Exits with a usage error if options exclude each other. Raises MissionError.
    """
    if options.simulate:
        if options.over not in (None, "devices"):
            options.refuse("--simulate is for robots that run over devices")
        options.over = "devices"
    over = platform_of(options)
    if options.servers is not None and over != "actions":
        options.refuse("--servers is for --robot actions")
    if over in ("simulated", "devices") and (options.sim_time or options.preflight or options.namespace):
        options.refuse("--sim-time, --namespace and --preflight are for --robot ros and --robot actions")
    servers = {} if options.servers is None else {"servers": f"/{options.servers.strip('/')}"}
    if over == "devices":
        return connector(options.robot, options.over, simulate=options.simulate)
    named = {"sim_time": options.sim_time, "namespace": options.namespace, **servers}
    return connector(options.robot, options.over, **named)


def platform_of(options: Namespace) -> str:
    """Return what the chosen robot runs on.

    Exits with a usage error if that takes no --speed. Raises MissionError.
    """
    body, over = runs_on(options.robot, options.over)
    if options.speed != "real" and runs_in_real_time(body, over, getattr(options, "simulate", ())):
        how = f"--robot {over}" if options.robot == over else f"--robot {options.robot} over {over}"
        options.refuse(f"{how} runs in real time, so it takes no --speed")
    return over


def print_preflight(tree: Tree, vocabulary: Lexicon, world: World, robot: Any) -> bool:
    """Print what a tree needs of the robot, one line each; return whether all of it is there.

    `robot` is what `chosen_robot` returns for a ROS 2 robot. Raises MissionError.
    """
    with closing(robot(world)) as connection:
        found = connection.survey(tree, vocabulary)
        lacks = connection.lacking_parts(tree, vocabulary)
        warnings = connection.warnings(found)
        blind = not_allowed(connection.blind(found))
    rows = [
        (needed.sort, needed.name, needed.type, f"missing: {reason}" if reason else "found")
        for needed, (_, reason) in found.items()
    ]
    rows += [("part", part, "", "missing: it is not in the robot file") for part in lacks]
    if rows:
        show(Table(tuple(rows), widths=(7, 20, 36), gap=1))
    for warning in warnings:
        show(f"warning: {warning}")
    for problem in blind:
        if not_silenced([problem], problem.span.source, vocabulary):
            show(render(problem, has_colour(sys.stderr)), sys.stderr)
    missing = sum(bool(reason) for _, reason in found.values()) + len(lacks)
    show(
        f"Missing: {missing} of {len(found) + len(lacks)}."
        if missing
        else "The robot has everything that the mission needs."
    )
    return not missing
