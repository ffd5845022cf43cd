"""Where a robot that is up keeps what belongs to it, and where it is spoken to: by its name."""

from __future__ import annotations

import os
import re

from btlang.robots.sockets import socket_folder
from btlang.support.user_dirs import user_dir
from btlang.task.messages import wrong

USUAL_NAME = "robot"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,31}")


def checked_name(name: str) -> str:
    """The name. Raises MissionError (BT198) if it can't be part of a file name."""
    if _NAME.fullmatch(name) is None:
        raise wrong(name, "it must be up to 32 letters, digits, '-' and '_'")
    return name


def data_folder(name: str) -> str:
    """What the robot keeps: its store, its recordings, its latch."""
    return os.path.join(user_dir("data"), "robots", checked_name(name))


def robots_known() -> list[str]:
    """Names of robots that were up some time."""
    folder = os.path.join(user_dir("data"), "robots")
    names = os.listdir(folder) if os.path.isdir(folder) else []
    return sorted(name for name in names if _NAME.fullmatch(name))


def socket_path(name: str, stop: bool = False) -> str:
    """The socket for commands to a robot; with `stop` the one for the emergency stop alone."""
    return os.path.join(socket_folder(), f"{checked_name(name)}{'.stop' if stop else ''}.sock")


def names_up() -> list[str]:
    """Robots that have a socket; after a crash it may be that nobody listens there."""
    return sorted(
        entry.removesuffix(".sock")
        for entry in os.listdir(socket_folder())
        if entry.endswith(".sock") and not entry.endswith(".stop.sock")
    )
