"""The values of options: a function for each kind turns a text into a value, or raises argparse's error."""

from __future__ import annotations

import argparse
import math
import os
import re
from collections.abc import Callable, Sequence

from btlang.run.limits import SLOWEST

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.geometry import Pose

_LONGEST_NAME = 40  # of a project


def speed(text: str) -> float | str:
    """Read "real", "max" or a factor of real time."""
    return text if text in ("real", "max") else between(SLOWEST, 1e6)(text)


def real_speed(text: str) -> float | str:
    """Read "real" or a factor of real time."""
    return text if text == "real" else between(SLOWEST, 1e6)(text)


def robot_on(platforms: Sequence[str]) -> Callable[[str], str]:
    """Make a reader of what runs missions: one of these names, or a robot file."""

    def robot(text: str) -> str:
        from btlang.robots.bodies.body_file import shipped_bodies
        from btlang.robots.platforms import ROBOTS
        from btlang.robots.registry import find_installed_robot

        if text in platforms:
            return text
        names = (*platforms, *shipped_bodies())
        if text in names or text.endswith(".toml") or (os.path.exists(text) and text not in ROBOTS):
            return text
        if find_installed_robot(text) is not None:
            return text
        raise argparse.ArgumentTypeError(f"expected {', '.join(names)} or a robot file, not '{text}'")

    return robot


def robot_or_library(text: str) -> str:
    """Read any robot that missions can run on, or `library:NAME`."""
    from btlang.robots.platforms import ROBOTS

    return text if text.startswith("library:") else robot_on(tuple(ROBOTS))(text)


def namespace(text: str) -> str:
    """Read a namespace of ROS 2: "", or names with slashes between, and perhaps before them."""
    if text and not all(part.isidentifier() and part.isascii() for part in text.removeprefix("/").split("/")):
        raise argparse.ArgumentTypeError(f"expected names of letters, digits and _ separated by /, not '{text}'")
    return text


def node_name(text: str) -> str:
    """Read the name of a node of ROS 2."""
    if not (text.isidentifier() and text.isascii()):
        raise argparse.ArgumentTypeError(f"expected a name of letters, digits and _, not '{text}'")
    return text


def ros_name(text: str) -> str:
    """Read a full name of the graph of ROS 2, or a pattern for some."""
    if not text.startswith(("/", "*")):
        raise argparse.ArgumentTypeError(f"expected a name that begins with /, such as '/btlang/*', not '{text}'")
    return text


def at_least(least: int) -> Callable[[str], int]:
    """Make a reader of whole numbers from `least` on."""

    def number(text: str) -> int:
        if not text.isdecimal() or int(text) < least:
            raise argparse.ArgumentTypeError(f"expected a whole number from {least} on, not '{text}'")
        return int(text)

    return number


def port(text: str) -> int:
    """Read a TCP port that has a next one."""
    if not text.isdecimal() or not 1 <= int(text) <= 65_534:
        raise argparse.ArgumentTypeError(f"expected a port from 1 to 65534, not '{text}'")
    return int(text)


def network(text: str) -> str:
    """Read an IP address, or a network such as 10.0.0.0/8."""
    from ipaddress import ip_network

    try:
        return str(ip_network(text))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected an address or a network such as 10.0.0.0/8, not '{text}'") from None


def size(text: str) -> int:
    """Read a number of bytes, written with kB, MB or GB."""
    units = {"kb": 1_000, "mb": 1_000_000, "gb": 1_000_000_000}
    number, unit = text[:-2], text[-2:].lower()
    if unit not in units or not number.strip().isdecimal() or int(number) == 0:
        raise argparse.ArgumentTypeError(f"expected a size such as 100MB, not '{text}'")
    return int(number) * units[unit]


def between(least: float, most: float) -> Callable[[str], float]:
    """Make a reader of numbers from `least` to `most`."""

    def number(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"expected a number from {least:g} to {most:g}, not '{text}'")
        return value

    return number


def picture(*endings: str) -> Callable[[str], str]:
    """Make a reader of paths with one of these endings."""

    def path(text: str) -> str:
        from btlang.pictures.files import picture_ending

        try:
            picture_ending(text, endings)
        except ValueError as problem:
            raise argparse.ArgumentTypeError(str(problem)) from None
        return text

    return path


def library_version(text: str) -> tuple[int, ...]:
    """Read a version of BehaviorTree.CPP, 3 or 4, such as 4.8."""
    if not re.fullmatch(r"[34](\.\d{1,3}){0,2}", text):
        raise argparse.ArgumentTypeError(f"{text!r} is no version of BehaviorTree.CPP 3 or 4, such as 4.8")
    return tuple(map(int, text.split(".")))


def duration(text: str) -> float:
    """Read seconds, written as a number or in the words of the language."""
    try:
        value = float(text)
    except ValueError:
        from btlang.vocabulary.load import load_vocabulary

        value = float(load_vocabulary().value("duration", text) or math.nan)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"expected a duration such as 60s or 2min, not '{text}'")
    return value


def server_address(text: str) -> str:
    """Read the address of a server that robots join, or ""."""
    if text and not re.fullmatch(r"wss://[^\s/?#@]+/?", text):
        raise argparse.ArgumentTypeError(f"expected an address such as wss://host:8443, not '{text}'")
    return text.rstrip("/")


def robot_name(text: str) -> str:
    """Read the name of a robot that is up, or ""."""
    from btlang.diagnostics.diagnostic import MissionError
    from btlang.task.commands.client import check_name

    try:
        return text and check_name(text)
    except MissionError:
        raise argparse.ArgumentTypeError(f"expected up to 32 letters, digits, '-' and '_', not '{text}'") from None


def project_name(text: str) -> str:
    """Read a name that a Python module may have."""
    from keyword import iskeyword

    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", text) or iskeyword(text) or len(text) > _LONGEST_NAME:
        raise argparse.ArgumentTypeError(
            f"expected a name of small letters, digits and _, such as coffee_machine, not '{text}'"
        )
    return text


def pose(text: str) -> Pose:
    """Read "X,Y" or "X,Y,FACING" in metres and degrees."""
    from btlang.robots.geometry import Pose
    from btlang.text.toml_table import is_coordinate

    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not all(map(is_coordinate, numbers)):
        raise argparse.ArgumentTypeError(f"expected X,Y or X,Y,FACING, such as 1.5,2,90, not '{text}'")
    return Pose(*numbers)


def latitude_longitude(text: str) -> tuple[float, float]:
    """Read "LAT,LON" in degrees."""
    try:
        latitude, longitude = (float(part) for part in text.split(","))
    except ValueError:
        latitude = longitude = math.nan
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):
        raise argparse.ArgumentTypeError(f"expected LAT,LON, such as 48.1,11.6, not '{text}'")
    return latitude, longitude
