"""The files of recordings in the folder of a robot."""

from __future__ import annotations

import os
import re
from contextlib import suppress

from btlang.recording.reader import read_about
from btlang.server.access import AccessError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

NAME = re.compile(r"[\w-]+(\.\d+)?\.mcap", re.ASCII)
"""The names that recordings may have."""
MOST = 200
"""In a list, the newest."""
PIECE = 49_152
"""Bytes that are read at once."""


def listed(folder: str) -> list[dict[str, Any]]:
    """Name, size in bytes, time (seconds since 1970) and task of each, newest first. Raises AccessError (404)."""
    found: list[tuple[float, str, int]] = []
    with suppress(OSError):
        for entry in os.scandir(_checked(folder)):
            if NAME.fullmatch(entry.name):
                status = entry.stat()
                found.append((status.st_mtime, entry.name, status.st_size))
    recordings = []
    for time, name, size in sorted(found, reverse=True)[:MOST]:
        about = read_about(os.path.join(folder, name))
        task = int(about["task"]) if about.get("task", "").isdigit() else 0
        recordings.append(
            {"name": name, "bytes": size, "time": time, "task": task, "mission": about.get("mission", "")}
        )
    return recordings


def path_of(folder: str, name: str) -> str:
    """The file of one. Raises AccessError (404)."""
    path = os.path.join(_checked(folder), name)
    if not NAME.fullmatch(name) or not os.path.isfile(path):
        raise AccessError(404, "There's no such recording.")
    return path


def piece(folder: str, name: str, at: int) -> tuple[int, bytes]:
    """The bytes of one, and at most PIECE of them from a place on. Raises AccessError (404)."""
    path = path_of(folder, name)
    try:
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            file.seek(at)
            return size, file.read(PIECE)
    except (OSError, ValueError, OverflowError):
        raise AccessError(404, "There's no such recording.") from None


def _checked(folder: str) -> str:
    if not folder:
        raise AccessError(404, "The recordings of this robot aren't on this computer.")
    return folder
