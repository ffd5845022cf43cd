"""Where a robot keeps its tasks: in a file of its folder, or where `btc robot up --store` says."""

from __future__ import annotations

import os
import re
from contextlib import suppress

_USUAL = "tasks.db"
_POINTER = "store"  # the file of the folder that says where the store was when the robot was up last
_USER = re.compile(r"^(\w+://[^/:@]*):[^/]*@")
_PARAMETER = re.compile(r"([?&])password=[^&]*&?")


def usual_store(folder: str) -> str:
    """Return the place of the store in the folder of a robot, if no other one is chosen."""
    return os.path.join(folder, _USUAL)


def latest_store(folder: str) -> str:
    """Return the place of the store that the robot of a folder used last."""
    with suppress(OSError), open(os.path.join(folder, _POINTER), encoding="utf-8", errors="surrogateescape") as file:
        return file.read()
    return usual_store(folder)


def note_store(folder: str, place: str) -> None:
    """Keep where the store is, without its password, for those who ask about a robot that is down."""
    place = without_password(place) if "://" in place else os.path.abspath(place)
    with (
        suppress(OSError),
        open(os.path.join(folder, _POINTER), "w", encoding="utf-8", errors="surrogateescape") as file,
    ):
        file.write(place)


def without_password(place: str) -> str:
    """Return the place of a store without a password, in its user or as a parameter."""
    place = _USER.sub(r"\1@", place)
    return _PARAMETER.sub(r"\1", place).rstrip("?&") if "://" in place else place
