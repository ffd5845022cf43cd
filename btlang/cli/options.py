"""What a verb of the command line consists of, and the options that several verbs share, in the order of help."""

from __future__ import annotations

from btlang.cli.values import (
    between,
    latitude_longitude,
    namespace,
    picture,
    port,
    pose,
    real_speed,
    robot_name,
    robot_on,
    server_address,
    speed,
)
from btlang.frontends.mission.reader import DEFAULT_PARSER
from btlang.robots.platforms import ALL, ROBOTS
from btlang.run.limits import RATES
from btlang.support.record import Record
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any


class Option:
    """An option or an argument: what argparse's `add_argument` takes.

    `choices` may be a string "module:NAME", which is imported when the verb is parsed; in the help, {choices} lists
    them. An option costs next to nothing before that: most commands need those of one verb.
    """

    __slots__ = ("names", "settings")

    def __init__(self, *names: str, **settings: Any) -> None:
        self.names = names
        self.settings = settings


class OneOf:
    """A group of options of which a command line may have one, or must have one."""

    __slots__ = ("options", "required")

    def __init__(self, *options: Option, required: bool = True) -> None:
        self.options = options
        self.required = required


class VerbAct(Record):
    """One of the things that a verb does: `add` of `btc task`.

    `options` are the destinations of the options that it takes, beside `name`, and `words` the most arguments. Where
    `options` is None, the handler checks both. `also` are words that people type instead: they get a hint.
    """

    about: str
    options: tuple[str, ...] | None = None
    words: float = 1
    also: tuple[str, ...] = ()

    def explain(self, verb: str, name: str) -> tuple[str, str]:
        """Return what it does, and its examples with commas between; without any, it is typed as it is called."""
        about, _, examples = self.about.partition(": btc ")
        return about, f"btc {examples or f'{verb} {name}'}"


class Verb(Record):
    """A verb of the command line: its line in `btc help`, its options, and the handler "module:function".

    A handler gets the options that argparse read, and returns the exit code. `usual_act` is the act of a command line
    that names none. With `mixed`, options may stand between the arguments. `examples` are commands, each with what it
    does. `also` is as in VerbAct.
    """

    name: str
    group: str
    about: str
    handler: str
    options: tuple[Option | OneOf, ...] = ()
    examples: tuple[tuple[str, str], ...] = ()
    acts: Mapping[str, VerbAct] = {}  # never changed
    usual_act: str = ""
    mixed: bool = False
    usage: str | None = None
    also: tuple[str, ...] = ()


PLATFORMS = tuple(ROBOTS)
GROOT_PORT = 1667
"""The port at which Groot2 looks for a run; it listens to the next one, too."""

WORLD = Option("--world", metavar="FILE", help="world file (default: the world that ships)")
WORDS = (
    Option(
        "--keywords", action="append", default=[], metavar="FILE",
        help="another keyword file, an XML file whose nodes become words, or the name of a pack; may be repeated",
    ),
    Option(
        "--language", default=ENGLISH, metavar="LANG", help="language of missions: en, es, or a folder (default: en)"
    ),
    WORLD,
)  # fmt: skip
"""The options that say which words there are, and which places."""
READING = (
    *WORDS,
    Option(
        "--parser", choices="btlang.frontends.mission.reader:PARSERS", default=DEFAULT_PARSER,
        help="which parser to use; both give the same tree (default: %(default)s)",
    ),
    Option("--include-root", metavar="DIR", help="missions may also include files below DIR"),
)  # fmt: skip
"""The options that say how missions are read."""
MAIN = Option("--main", default="", metavar="ID", help="which tree to use if the file holds several")
FORMAT = Option(
    "--format", choices="btlang.diagnostics.report:FORMATS", default="text",
    help="format of messages: text, or json for programs (default: text)",
)  # fmt: skip
TEXT = Option("-c", dest="text", metavar="TEXT", help="mission as text")
MISSION = (
    *READING, FORMAT, MAIN,
    OneOf(Option("file", nargs="?", metavar="FILE", help="mission, or - for standard input"), TEXT),
)  # fmt: skip
FILES = OneOf(Option("file", nargs="*", default=[], metavar="FILE", help="mission, or - for standard input"), TEXT)
MISSIONS = (*READING, FORMAT, MAIN, FILES)
ROBOT_WORDS = Option(
    "--robot", default="", metavar="ROBOT",
    help="read missions with the words and the world of this robot: a robot file or a name",
)  # fmt: skip
"""An option for verbs that read missions and run nothing."""

SPEED = Option("--speed", type=speed, default="real", help="real, max, or a factor of real time")
REPLAY_SPEED = Option("--speed", type=speed, default=0.0, help="real, max, or a factor of real time")  # 0: not given
ROBOT_SPEED = Option("--speed", type=speed, default="real", metavar="SPEED", help="real, max, or a factor of real time")
REAL_SPEED = Option("--speed", type=real_speed, default="real", help="real, or a factor of real time")
RATE = Option("--rate", type=between(*RATES), default=20.0, metavar="HZ", help="ticks per second (default: 20)")
START = Option(
    "--start", type=pose, metavar="X,Y[,FACING]",
    help="where the robot starts (default: the first way point, or where a map has room)",
)  # fmt: skip
ORIGIN = Option(
    "--origin", type=latitude_longitude, metavar="LAT,LON",
    help="latitude and longitude of the origin, for way points in degrees",
)  # fmt: skip
SIMULATE = Option(
    "--simulate", action="append", nargs="?", const=ALL, default=[], metavar="DEVICE",
    help="simulate all devices of the robot file, or only those of this name or kind",
)  # fmt: skip
SIM_TIME = Option(
    "--sim-time", action="store_true", help="with --robot ros or actions: use the time of the topic /clock"
)
JSON = Option("--json", action="store_true", help="print the answer as JSON")
ANSWERS = Option("--answers", metavar="FILE", help="TOML file with answers to what the robot asks")
REASON = Option("--reason", default="", metavar="TEXT", help="reason to show to others")
LINES = Option("--lines", action="store_true", help="print plain lines, even on a terminal")
BROWSER = Option(
    "--no-browser", action="store_false", dest="browser", help="print the address without opening the browser"
)
PICTURES = (
    Option(
        "--picture", type=picture(".svg", ".png", ".gif"), metavar="FILE", help="draw the run: .svg, .png or .gif"
    ),
    Option(
        "--tree-picture", type=picture(".svg", ".png"), metavar="FILE",
        help="draw the tree with the final status of every node: .svg or .png",
    ),
)  # fmt: skip
GROOT = Option(
    "--groot", nargs="?", type=port, const=GROOT_PORT, metavar="PORT",
    help=f"show the run in Groot2, which connects to this port (default: {GROOT_PORT})",
)  # fmt: skip
NAME = Option(
    "--name", type=robot_name, default="", metavar="NAME", help="which robot, if several are up (default: robot)"
)
RECORDING = (
    NAME,
    Option(
        "file",
        nargs="?",
        metavar="FILE|NUMBER",
        help="recording, or the number of a task (see btc task list --all); without one, the latest run",
    ),
)
ROS_ARGS = Option("--ros-args", nargs="...", help="all further arguments are for ROS 2")

ADDRESS = (
    Option(
        "--host", default="127.0.0.1", metavar="ADDRESS",
        help="address that the server listens on (default: this computer only)",
    ),
    Option(
        "--port", type=port, default=8443, metavar="PORT", help="port that the server listens on (default: %(default)s)"
    ),
)  # fmt: skip
"""The options that say where a server listens."""
COMPANIONS = (
    Option("--serve", action="store_true", help="also start a server, as btc serve does"),
    *ADDRESS,
    Option(
        "--join", type=server_address, default="", metavar="ADDRESS",
        help="join a server on another computer: wss://host:8443",
    ),
    Option(
        "--code", default="", metavar="CODE",
        help="with --join, the first time: the code that btc robot invite printed there",
    ),
)  # fmt: skip
"""The options that start programs beside a robot's own."""
TASK_LAYER = (
    Option("--rules", metavar="FILE", help="file of house rules, which apply during and between missions"),
    Option("--schedules", metavar="FILE", help="TOML file of schedules"),
    Option("--store", default="", metavar="PLACE", help="where to keep tasks: a file or postgresql://..."),
    Option("--durable", action="store_true", help="keep every acknowledged command even through a power failure"),
    Option(
        "--keep", type=between(0.0, 100_000.0), metavar="DAYS",
        help="keep tasks that are over for so many days (default: 90)",
    ),
    Option("--record", metavar="FOLDER", help="folder for recordings of missions (default: beside the store)"),
    ANSWERS,
    Option("--no-recordings", action="store_true", help="don't record missions"),
    Option(
        "--allow-keywords", action="append", default=[], metavar="NAME|DIR",
        help="let missions bring this pack, or the keyword files below DIR; these run Python (default: none)",
    ),
)  # fmt: skip
"""The options of any verb that brings a robot up."""


def body_options(*platforms: str) -> tuple[Option, Option]:
    """Make --robot and --over for a verb whose robot runs on one of `platforms`."""
    return (
        Option(
            "--robot", type=robot_on(platforms), default="simulated", metavar="ROBOT",
            help=f"{', '.join(platforms)}, a robot file or the name of a robot (default: %(default)s)",
        ),
        Option("--over", choices=platforms, help="what the robot in a file runs on (default: as the file says)"),
    )  # fmt: skip


def namespace_option(about: str) -> Option:
    """Make --namespace with a help text."""
    return Option("--namespace", type=namespace, default="", metavar="NS", help=about)
