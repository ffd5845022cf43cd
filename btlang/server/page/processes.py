"""Work for pages in processes of its own: checking missions, making films of recordings, counting in UTF-16."""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Callable, Mapping
from functools import partial
from weakref import WeakValueDictionary

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.document import messages
from btlang.editing.edits import read_edit
from btlang.editing.queries import DOES, PLACES, TextQuery, answer_of, in_units, of_mission
from btlang.editing.words import RobotWords
from btlang.recording.film import Film, count_failures, side_by_side, try_mission
from btlang.recording.reader import open_recording
from btlang.server.http.access import AccessError, text_in
from btlang.server.page.shown_documents import ShownDocuments
from btlang.support.gc_pause import gc_paused
from btlang.support.worker import Worker, WorkerEnded
from btlang.testing.trial import results_of
from btlang.text.source import Source, Utf16Units

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def film(path: str, language: str = "") -> bytes:
    """Return the film of a recording (see Film) as JSON; runs nothing."""
    return _write_film(partial(_film, path, language))


def comparison(one: str, other: str, language: str = "") -> bytes:
    """Return two recordings side by side as JSON (see recording/film.py); runs nothing."""
    return _write_film(partial(_comparison, one, other, language))


def failures(*paths: str) -> bytes:
    """Return in how many runs of the mission of the first recording each node failed, as JSON; runs nothing."""
    return _write_film(partial(count_failures, paths))


def tree(path: str) -> bytes:
    """Return the tree of a recording as `xml` of BehaviorTree.CPP, as JSON; runs nothing."""
    return _write_film(partial(_tree, path))


def _film(path: str, language: str) -> dict[str, Any]:
    with open_recording(path) as (recording, mission, nodes):
        data = Film(mission, dict(recording.about), language).take(recording.events(nodes)).data()
    return in_units(data, data["text"])


def _comparison(one: str, other: str, language: str) -> dict[str, Any]:
    data = side_by_side(one, other, language)
    return {**data, "films": [in_units(each, each["text"]) for each in data["films"]]}


def _tree(path: str) -> dict[str, Any]:
    with open_recording(path) as (_, mission, _):
        return {"xml": str(mission.to("xml"))}


def _write_film(read: Callable[[], dict[str, Any]]) -> bytes:
    try:
        data = {"ok": True, **read()}
    except MissionError as error:
        data = {"ok": False, "text": str(error), "code": error.diagnostics[0].code}
    return json.dumps(data, default=str).encode()


TESTS = "tests"
"""The name of tests in messages."""
MOST_CHARACTERS = 200_000
_PATIENCE = 10.0  # seconds for one text


def _test(source: Source, words: RobotWords, tests: str, called: str) -> dict[str, Any]:
    mission = words.mission(source)

    def given(name: str, world: str | None) -> Mission | None:
        if name not in (called, f"{called}.txt"):
            return None
        return mission if world is None else words.mission(source, world=world)

    beside = os.path.join(os.path.dirname(words.file), TESTS)
    text = Source(tests, beside) if words.file else Source(tests, TESTS, roots=())
    return {"messages": messages(mission.warnings, source), **results_of(text, given)}


TRIES: Mapping[str, TextQuery] = {
    "test": TextQuery(
        "Tests of a mission in the simulated world, with films of those that fail.", _test, ("tests", "called")
    ),
    "try": TextQuery("A run of a mission in the simulated world, as a film.", of_mission(try_mission)),
}
"""The queries that take longer: they have a process of their own."""
ASKED = {**DOES, **TRIES}


def arguments_of(kind: str, data: Mapping[str, Any], text: str) -> dict[str, Any]:
    """Return the further arguments of a request, with places as characters of its text. Raises AccessError (400)."""
    asked = ASKED[kind]
    given = {name: data[name] for name in asked.takes if data.get(name) is not None}
    given |= {name: data.get(name) for name in asked.needs}
    for field in PLACES & given.keys():
        units = Utf16Units(text)
        if type(given[field]) is not int or not 0 <= given[field] <= units.length:
            raise AccessError(400, f"'{field}' must be a place in the text, a whole number of UTF-16 units.")
        given[field] = units.character(given[field])
    for field in ("name", "tests", "called", "shown"):
        if field in given:
            text_in(given, field)
    if len(given.get("tests", "")) > MOST_CHARACTERS:
        raise AccessError(413, f"Tests may have {MOST_CHARACTERS:,} characters.")
    if "edit" in given:
        given["edit"] = read_edit(given["edit"])
    return given


def answer(kind: str, text: str, words: RobotWords, arguments: Mapping[str, Any] = {}) -> dict[str, Any]:
    """Return what is asked of a text, with what is wrong with it as data; places are in UTF-16 units."""
    source = words.source(text)
    found = in_units(answer_of(ASKED[kind], source, words, arguments), text)
    shown = arguments.get("shown")
    return found if shown is None else _shown.shorten(found, text, shown)


_shown = ShownDocuments()
"""What the pages of this process's server have."""


def _write_answer(kind: str, text: str, words: RobotWords, arguments: Mapping[str, Any]) -> bytes:
    """Return the answer as JSON in ASCII: half a character of UTF-16 has no other encoding."""
    with gc_paused:
        return json.dumps(answer(kind, text, words, arguments), separators=(",", ":")).encode()


class Checker:
    """A process that checks missions, for one event loop. Texts take turns, one of each user at a time."""

    def __init__(self) -> None:
        self._worker = Worker()
        self._turn = asyncio.Lock()
        self._own_turns: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()
        self._newest: dict[tuple[str, str, str], object] = {}

    async def answer(
        self,
        kind: str,
        text: str,
        words: RobotWords,
        arguments: Mapping[str, Any] = {},
        user: str = "",
        page: str | None = None,
    ) -> bytes:
        """Return what the function `answer` does, as JSON.

        Of a page, which types faster than texts are read, only the newest request of a kind waits. Raises AccessError:
        413 and 422 for a text that is too long, or takes too long, 409 for a request that a newer one replaced.
        """
        if len(text) > MOST_CHARACTERS:
            raise AccessError(413, f"A mission may have {MOST_CHARACTERS:,} characters.")
        asked, place = object(), (user, page or "", kind)
        own_turn = self._own_turns.setdefault(user, asyncio.Lock())
        if page is not None:
            self._newest[place] = asked
        try:
            async with own_turn, self._turn:
                if page is not None and self._newest.get(place) is not asked:
                    raise AccessError(409, "A newer request of the page replaced this one.")
                return await self._done(_write_answer, kind, text, words, arguments)
        finally:
            if self._newest.get(place) is asked:
                del self._newest[place]

    async def shown(self, show: Callable[..., bytes], *paths: str) -> bytes:
        """Return what processes.py makes of recordings. Raises AccessError (422) if it takes too long."""
        async with self._turn:
            return await self._done(show, *paths)

    async def _done(self, do: Callable[..., bytes], *given: object) -> bytes:
        try:
            return await self._worker.do(_PATIENCE, do, *given)
        except WorkerEnded:
            raise AccessError(422, "This text takes too long to read.") from None

    def close(self) -> None:
        """End the process, whatever it does."""
        self._worker.close()
