"""Missions that are written elsewhere: checked, completed, explained and laid out, in a process of its own.

A long text, or one that is made to take long, ends with that process. Nothing here imports the code of words.
"""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from btlang.api import format_mission, parse_tree, world_vocabulary
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.report import as_data
from btlang.frontends.mission.completion.completer import completions
from btlang.server.access import AccessError
from btlang.text.escaping import one_line
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.diagnostics.diagnostic import Diagnostic

MOST_CHARACTERS = 200_000
_PATIENCE = 10.0  # seconds for one text
_MOST_OFFERS = 200


class Words:
    """Where the words of a robot are: keyword files, world and language. The world is a file, or the text of one."""

    def __init__(
        self, keywords: Sequence[str] = (), world: str | None = None, language: str = "en", world_text: str = ""
    ) -> None:
        self.keywords, self.language = keywords, language
        self.world = Source(world_text, "world", roots=()) if world_text else world

    def in_world(self, name: str, text: str) -> Words:
        """These words with the places of a world in a text; `name` is what messages show."""
        other = Words(self.keywords, language=self.language)
        other.world = Source(text, one_line(name), roots=())
        return other


def _messages(problems: Iterable[Diagnostic]) -> list[dict[str, Any]]:
    return [as_data(problem) for problem in problems]


def _check(source: Source, words: Words) -> dict[str, Any]:
    mission = parse_tree(source, keywords=words.keywords, world=words.world, language=words.language)
    return {"messages": _messages(mission.warnings), "outline": str(mission)}


def _explain(source: Source, words: Words) -> dict[str, Any]:
    mission = parse_tree(source, keywords=words.keywords, world=words.world, language=words.language)
    return {"messages": _messages(mission.warnings), "explanation": mission.explain()}


def _format(source: Source, words: Words) -> dict[str, Any]:
    laid_out = format_mission(source, keywords=words.keywords, world=words.world, language=words.language)
    return {"messages": [], "text": laid_out}


def _complete(source: Source, words: Words) -> dict[str, Any]:
    found = completions(source.text, world_vocabulary(words.keywords, words.world, words.language))
    return {"messages": [], "completions": [each.as_dict() for each in found[:_MOST_OFFERS]]}


DOES: Mapping[str, Callable[[Source, Words], dict[str, Any]]] = {
    "check": _check, "complete": _complete, "explain": _explain, "format": _format,
}  # fmt: skip


def answer(kind: str, text: str, words: Words) -> dict[str, Any]:
    """What is asked of a text, with what is wrong with it as data."""
    try:
        return {"ok": True, **DOES[kind](Source(text, "mission", roots=()), words)}
    except MissionError as error:
        return {"ok": False, "messages": _messages(error.diagnostics)}


class Checker:
    """For one event loop."""

    def __init__(self) -> None:
        self._process: ProcessPoolExecutor | None = None
        self._turn = asyncio.Lock()

    async def answer(self, kind: str, text: str, words: Words) -> dict[str, Any]:
        """As the function `answer`. Raises AccessError (413, 422) for a text that is too long, or takes too long."""
        if len(text) > MOST_CHARACTERS:
            raise AccessError(413, f"A mission may have {MOST_CHARACTERS:,} characters.")
        async with self._turn:
            if self._process is None:
                self._process = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
            loop = asyncio.get_running_loop()
            try:
                async with asyncio.timeout(_PATIENCE):
                    return await loop.run_in_executor(self._process, answer, kind, text, words)
            except (TimeoutError, BrokenProcessPool):
                self.close()
                raise AccessError(422, "This text takes too long to read.") from None

    def close(self) -> None:
        """Ends the process, whatever it does."""
        ended, self._process = self._process, None
        if ended is not None:
            for process in tuple((ended._processes or {}).values()):
                process.kill()
            ended.shutdown(wait=False, cancel_futures=True)
