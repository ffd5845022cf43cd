"""Recordings as data for pages, in a process of its own."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial

from btlang.diagnostics.errors import MissionError
from btlang.recording.film import Film
from btlang.recording.open import opened
from btlang.recording.side_by_side import side_by_side
from btlang.server.utf16 import in_units

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


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
