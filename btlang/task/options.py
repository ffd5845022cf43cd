"""The options of `btc robot` and `btc task`, apart from what these do: most commands need no more."""

from __future__ import annotations

import argparse
import re

from btlang.arguments import at_least, between, duration, kept_robot, port, speed
from btlang.diagnostics.errors import MissionError
from btlang.option_parser import add_acts
from btlang.robots.platforms import ROBOTS, add_simulate
from btlang.task.applicable import COMPONENT_ACTS, ROBOT_ACTS, TASK_ACTS, note_given


def add_robot_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc robot`."""
    _add_name(parser)
    parser.add_argument(
        "--robot", type=kept_robot, default="simulated", metavar="ROBOT",
        help="robot file, installed robot, or library:NAME (default: simulated)",
    )  # fmt: skip
    parser.add_argument("--over", choices=ROBOTS, help="what the robot in a file runs on (default: as the file says)")
    add_simulate(parser)
    parser.add_argument("--world", metavar="FILE", help="world file, or library:NAME")
    parser.add_argument("--keywords", action="append", default=[], metavar="FILE", help="keyword file; may be repeated")
    add_layer_options(parser)
    add_companion_options(parser)
    parser.add_argument("--include-root", metavar="DIR", help="let missions include files below this folder")
    parser.add_argument(
        "--speed", type=speed, default="real", metavar="SPEED", help="real, max, or a factor of real time"
    )
    parser.add_argument("--reason", default="", metavar="TEXT", help="reason to show to others")
    parser.add_argument("--since", metavar="TIME", help="start of the report (default: seven days ago)")
    _add_json(parser)
    add_acts(parser, ROBOT_ACTS)
    parser.add_argument("item", nargs="*", default=[], metavar="FILE", help="file, text or robot that the act needs")
    note_given(parser)


def add_layer_options(parser: argparse.ArgumentParser) -> None:
    """Those of any verb that brings a robot up."""
    parser.add_argument("--rules", metavar="FILE", help="file of house rules, which apply during and between missions")
    parser.add_argument("--schedules", metavar="FILE", help="TOML file of schedules")
    parser.add_argument("--store", default="", metavar="PLACE", help="where to keep tasks: a file or postgresql://...")
    parser.add_argument(
        "--durable", action="store_true", help="keep every acknowledged command even through a power failure"
    )
    parser.add_argument(
        "--keep",
        type=between(0.0, 100_000.0),
        metavar="DAYS",
        help="keep tasks that are over for so many days (default: 90)",
    )
    parser.add_argument(
        "--record", metavar="FOLDER", help="folder for recordings of missions (default: beside the store)"
    )
    parser.add_argument("--answers", metavar="FILE", help="TOML file with answers to what the robot asks")
    parser.add_argument("--no-recordings", action="store_true", help="don't record missions")
    parser.add_argument(
        "--allow-keywords",
        action="append",
        default=[],
        metavar="NAME|DIR",
        help="let missions bring this pack, or the keyword files below DIR; these run Python (default: none)",
    )


def add_companion_options(parser: argparse.ArgumentParser) -> None:
    """Those of the programs beside a robot's own."""
    parser.add_argument("--serve", action="store_true", help="also start a server, as btc serve does")
    add_address_options(parser)
    parser.add_argument(
        "--join", type=_server, default="", metavar="ADDRESS", help="join a server on another computer: wss://host:8443"
    )
    parser.add_argument(
        "--code",
        default="",
        metavar="CODE",
        help="with --join, the first time: the code that btc robot invite printed there",
    )


def add_address_options(parser: argparse.ArgumentParser) -> None:
    """Where a server listens."""
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address that the server listens on (default: this computer only)",
    )
    parser.add_argument(
        "--port", type=port, default=8443, metavar="PORT", help="port that the server listens on (default: %(default)s)"
    )


def add_component_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc components`."""
    _add_name(parser)
    _add_json(parser)
    add_acts(parser, COMPONENT_ACTS, nargs="?", default="list")
    parser.add_argument("item", nargs="?", default="", metavar="NAME", help="name of a component")


def add_task_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc task`."""
    _add_name(parser)
    parser.add_argument("-c", dest="code", metavar="TEXT", help="mission as text")
    parser.add_argument(
        "--kind",
        default="mission",
        metavar="KIND",
        help="kind of item in the library: mission (default), world, robot or test",
    )
    parser.add_argument("--priority", type=int, metavar="N", help="from -100 to 100, higher first (default: 0)")
    parser.add_argument("--at", metavar="TIME", help='begin at this time at the earliest: "14:30", "in 10 minutes"')
    parser.add_argument("--by", metavar="TIME", help="skip the task if it hasn't begun by this time")
    parser.add_argument(
        "--label", action="append", default=[], metavar="TEXT", help="label to find the task by; may be repeated"
    )
    parser.add_argument(
        "--restart", default="give up", metavar="WHAT", help="after a crash: 'give up' (default), 'again' or 'resume'"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="initial value of a variable of the mission; may be repeated",
    )
    parser.add_argument(
        "--keywords", action="append", default=[], metavar="FILE", help="keyword file of the mission; may be repeated"
    )
    parser.add_argument("--every", default="", metavar="RULE", help='when a schedule is due: "every day at 9:00"')
    parser.add_argument("--zone", default="", metavar="ZONE", help="time zone of the schedule, such as Europe/Berlin")
    parser.add_argument(
        "--overlap",
        default="skip",
        metavar="WHAT",
        help="if the previous task isn't over: skip (default), queue or replace",
    )
    parser.add_argument(
        "--missed",
        default="skip",
        metavar="WHAT",
        help="what to do about times when the robot couldn't work: skip (default), once or all",
    )
    parser.add_argument(
        "--within", type=duration, metavar="DURATION", help="skip a task that hasn't begun this long after its time"
    )
    parser.add_argument("--before", type=int, default=0, metavar="TASK", help="move the task before this one")
    parser.add_argument("--token", default="", metavar="TOKEN", help="token of the interruption to end")
    parser.add_argument("--reason", default="", metavar="TEXT", help="reason to show to others")
    parser.add_argument("--all", action="store_true", help="list all tasks, including those that are over")
    parser.add_argument("--limit", type=at_least(1), metavar="N", help="list at most N entries")
    parser.add_argument("--live", action="store_true", help="keep the list on screen, and update it")
    _add_json(parser)
    add_acts(parser, TASK_ACTS)
    parser.add_argument(
        "item", nargs="*", default=[], metavar="FILE", help="mission file, name in the library, or number of a task"
    )
    note_given(parser)


def _add_name(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--name", type=_robot_name, default="", metavar="NAME", help="which robot, if several are up (default: robot)"
    )


def _robot_name(text: str) -> str:
    from btlang.task.paths import checked_name

    try:
        return text and checked_name(text)
    except MissionError:
        raise argparse.ArgumentTypeError(f"expected up to 32 letters, digits, '-' and '_', not '{text}'") from None


def _server(text: str) -> str:
    if text and not re.fullmatch(r"wss://[^\s/?#@]+/?", text):
        raise argparse.ArgumentTypeError(f"expected an address such as wss://host:8443, not '{text}'")
    return text.rstrip("/")


def _add_json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print the answer as JSON")
