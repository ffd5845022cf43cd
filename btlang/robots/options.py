"""Options of the command line that are about robots."""

from __future__ import annotations

from argparse import ArgumentParser

from btlang.robots.platforms import ALL


def add_simulate(parser: ArgumentParser) -> None:
    """The option --simulate."""
    parser.add_argument(
        "--simulate", action="append", nargs="?", const=ALL, default=[], metavar="DEVICE",
        help="simulate all devices of the robot file, or only those of this name or kind",
    )  # fmt: skip


def add_robot_words(parser: ArgumentParser) -> None:
    """The option --robot of a verb that only reads missions."""
    parser.add_argument(
        "--robot",
        default="",
        metavar="ROBOT",
        help="read missions with the words and the world of this robot: a robot file or a name",
    )


def add_world(parser: ArgumentParser) -> None:
    """The option --world."""
    parser.add_argument("--world", metavar="FILE", help="world file (default: the world that ships)")
