"""The options of `btc world`."""

from __future__ import annotations

import argparse

from btlang.arguments import between, picture, robot_on
from btlang.diagnostics.report import FORMATS
from btlang.robots.geometry import Pose
from btlang.robots.platforms import ROBOTS
from btlang.text.toml_table import is_coordinate

ACTS = ("check", "import", "export")
TARGETS = ("nav2", "json", "yaml")
USUAL_RESOLUTION = 0.05
"""The default width of a cell of an exported map, in metres."""


def add_world_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `btc world`."""
    parser.usage = (
        "btc world [FILE] [--picture OUT]\n       btc world check FILE ...\n"
        "       btc world import FILE ... -o OUT [--start X,Y[,FACING]]\n"
        "       btc world export FILE --to nav2|json|yaml -o OUT"
    )
    about = "world file; check, import or export may come first (default: the world that ships)"
    parser.add_argument("words", nargs="*", default=[], metavar="FILE", help=about)
    parser.add_argument("--picture", type=picture(".svg", ".png"), metavar="OUT", help="draw the world: .svg or .png")
    parser.add_argument("-o", dest="out", metavar="OUT", help="file to write, or a folder for nav2")
    parser.add_argument("--to", choices=TARGETS, help="what to export to")
    parser.add_argument(
        "--start", type=_start, metavar="X,Y[,FACING]", help="where the robot starts (default: the first way point)"
    )
    parser.add_argument(
        "--resolution",
        type=between(0.005, 10.0),
        metavar="M",
        help="size of a cell of an exported map, in metres (default: 0.05)",
    )
    parser.add_argument(
        "--robot", type=robot_on(tuple(ROBOTS)), default="simulated", metavar="ROBOT",
        help="robot file, for the robot's size and speed (default: simulated)",
    )  # fmt: skip
    parser.add_argument(
        "--format", choices=FORMATS, default="text", help="format of messages: text, or json (default: text)"
    )


def _start(text: str) -> Pose:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not all(map(is_coordinate, numbers)):
        raise argparse.ArgumentTypeError(f"expected X,Y or X,Y,FACING, such as 1.5,2,90, not '{text}'")
    return Pose(*numbers)
