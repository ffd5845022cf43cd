"""What `btc run` does with a ROS 2 robot. Imports no ROS before it is asked for."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Callable
from contextlib import closing
from functools import partial

from btlang.robots.stages import ROBOTS
from btlang.ros.available import require_ros

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.world import World
    from btlang.ros.stage import RosStage
    from btlang.run.stage import Stage
    from btlang.tree.node import Tree
    from btlang.vocabulary.vocabulary import Vocabulary

_PACKAGES = ("geometry_msgs", "nav_msgs", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs", "trajectory_msgs")


def ros_stage(world: World, *, sim_time: bool = False, namespace: str = "", name: str = "btlang") -> RosStage:
    """The stage of a mission on the ROS 2 robot of a namespace. Raises MissionError (BT100) without ROS 2."""
    require_ros(*_PACKAGES)
    from btlang.ros.stage import RosStage

    return RosStage(world, sim_time=sim_time, namespace=namespace, name=name)


def add_robot_options(parser: ArgumentParser) -> None:
    """The options of `btc run` that choose a robot."""
    parser.add_argument(
        "--robot", choices=list(ROBOTS), default="simulated", help="what runs the mission (default: %(default)s)"
    )
    parser.add_argument("--sim-time", action="store_true", help="with --robot ros: time is that of the topic /clock")
    add_namespace(parser, "with --robot ros: that of the robot (default: none)")
    parser.add_argument(
        "--preflight", action="store_true", help="with --robot ros: only list what the mission needs of the robot"
    )
    parser.set_defaults(refuse=parser.error)


def add_namespace(parser: ArgumentParser, what: str) -> None:
    """The option --namespace."""
    parser.add_argument("--namespace", type=_namespace, default="", metavar="NS", help=what)


def _namespace(text: str) -> str:
    """Of ROS 2: "" or names with slashes between, and perhaps before them."""
    if text and not all(part.isidentifier() and part.isascii() for part in text.removeprefix("/").split("/")):
        raise ArgumentTypeError(f"names of letters, digits and _ with / between are needed, not '{text}'")
    return text


def chosen_robot(options: Namespace) -> str | Callable[[World], Stage]:
    """As `RunnableTree.run` takes it. Ends with a usage error where options do not go together."""
    if options.robot != "ros":
        if options.sim_time or options.preflight or options.namespace:
            options.refuse("--sim-time, --namespace and --preflight are for --robot ros")
        return str(options.robot)
    if options.speed != "real":
        options.refuse("--robot ros runs in real time, so it takes no --speed")
    return partial(ros_stage, sim_time=options.sim_time, namespace=options.namespace)


def print_preflight(tree: Tree, vocabulary: Vocabulary, world: World, options: Namespace) -> bool:
    """Prints what a tree needs of the robot, a line each; returns whether all of it is there. Raises MissionError."""
    with closing(ros_stage(world, sim_time=options.sim_time, namespace=options.namespace)) as stage:
        found = stage.survey(tree, vocabulary)
    for interface, (_, reason) in found.items():
        state = f"missing: {reason}" if reason else "found"
        print(f"{interface.sort:<7} {interface.name:<20} {interface.type:<36} {state}")
    missing = sum(bool(reason) for _, reason in found.values())
    print(f"The robot lacks {missing} of {len(found)}." if missing else "The robot has all that the mission needs.")
    return not missing
