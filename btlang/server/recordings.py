"""The recordings of a robot on this computer: listed, sent, and as films for pages."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from contextlib import suppress
from functools import partial

from btlang.diagnostics.errors import MissionError
from btlang.recording.film import Film
from btlang.recording.open import opened
from btlang.recording.reader import read_about
from btlang.recording.side_by_side import side_by_side
from btlang.server.access import AccessError
from btlang.server.utf16 import in_units

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_NAME = re.compile(r"[\w-]+(\.\d+)?\.mcap", re.ASCII)
_MOST = 200  # in a list, the newest


def listed(folder: str) -> list[dict[str, Any]]:
    """Name, size in bytes, time (seconds since 1970) and task of each, newest first. Raises AccessError (404)."""
    found: list[tuple[float, str, int]] = []
    with suppress(OSError):
        for entry in os.scandir(_checked(folder)):
            if _NAME.fullmatch(entry.name):
                status = entry.stat()
                found.append((status.st_mtime, entry.name, status.st_size))
    recordings = []
    for time, name, size in sorted(found, reverse=True)[:_MOST]:
        about = read_about(os.path.join(folder, name))
        task = int(about["task"]) if about.get("task", "").isdigit() else 0
        recordings.append(
            {"name": name, "bytes": size, "time": time, "task": task, "mission": about.get("mission", "")}
        )
    return recordings


def path_of(folder: str, name: str) -> str:
    """The file of one. Raises AccessError (404)."""
    path = os.path.join(_checked(folder), name)
    if not _NAME.fullmatch(name) or not os.path.isfile(path):
        raise AccessError(404, "There's no such recording.")
    return path


def film(path: str) -> bytes:
    """See btlang.recording.film.Film.data, as JSON; runs nothing."""
    return _written(partial(_film, path))


def comparison(one: str, other: str) -> bytes:
    """See btlang.recording.side_by_side, as JSON; runs nothing."""
    return _written(partial(_comparison, one, other))


def tree(path: str) -> bytes:
    """The tree of a recording as `xml` of BehaviorTree.CPP, as JSON; runs nothing."""
    return _written(partial(_tree, path))


def _film(path: str) -> dict[str, Any]:
    with opened(path, ()) as (recording, mission, nodes):
        data = Film(mission, dict(recording.about)).take(recording.events(nodes)).data()
    return in_units(data, data["text"])


def _comparison(one: str, other: str) -> dict[str, Any]:
    data = side_by_side(one, other)
    return {**data, "films": [in_units(each, each["text"]) for each in data["films"]]}


def _tree(path: str) -> dict[str, Any]:
    with opened(path, ()) as (_, mission, _):
        return {"xml": str(mission.to("xml"))}


def _written(read: Callable[[], dict[str, Any]]) -> bytes:
    try:
        data = {"ok": True, **read()}
    except MissionError as error:
        data = {"ok": False, "text": str(error), "code": error.diagnostics[0].code}
    return json.dumps(data, default=str).encode()


def _checked(folder: str) -> str:
    if not folder:
        raise AccessError(404, "The recordings of this robot aren't on this computer.")
    return folder
