"""The options of `btc gesture`."""

from __future__ import annotations

import argparse

from btlang.arguments import speed
from btlang.option_parser import add_acts
from btlang.robots.platforms import ROBOTS

ACTS = {
    "play": "plays a gesture: btc gesture play wave --robot museum.toml",
    "check": "checks gesture files: btc gesture check wave.toml",
    "picture": "draws a gesture: btc gesture picture wave -o wave.gif --robot museum.toml",
    "record": "records a gesture, pose by pose, moved by hand or typed: "
    "btc gesture record wave -o wave.toml --robot museum.toml",
}


def add_gesture_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `btc gesture`."""
    parser.usage = (
        "btc gesture play NAME --robot FILE [--at TARGET] [--over PLATFORM] [--speed SPEED]\n"
        "       btc gesture check FILE ... [--robot FILE]\n"
        "       btc gesture picture NAME -o OUT --robot FILE\n"
        "       btc gesture record NAME -o OUT --robot FILE"
    )
    add_acts(parser, ACTS)
    parser.add_argument("items", nargs="+", metavar="NAME", help="gesture of the robot; for check: files")
    parser.add_argument("--robot", default="", metavar="FILE", help="robot file, or the name of a robot")
    parser.add_argument("--at", metavar="TARGET", help="place, object or person to aim the gesture at")
    parser.add_argument(
        "-o", dest="out", metavar="OUT", help="file to write: .svg, .png or .gif, or for record a gesture file"
    )
    parser.add_argument("--over", choices=tuple(ROBOTS), help="what the robot runs on (default: as its file says)")
    parser.add_argument(
        "--speed", type=speed, default="real", metavar="SPEED", help="real, max, or a factor of real time"
    )
    parser.add_argument("--world", metavar="FILE", help="world file (default: that of the robot)")
