"""`btc mcp`: a server for language models, which write, check and simulate missions with its tools.

It speaks the Model Context Protocol on standard input and output. Texts come from a model, so no tool reads or writes a
file, loads words beyond those of the command line, or moves a real robot; and each mission has limits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from importlib.util import find_spec

import btlang
from btlang.api import Mission, parse_tree
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic, sort_diagnostics
from btlang.diagnostics.files import MOST_BYTES
from btlang.diagnostics.formats import to_data
from btlang.editing.partial import partial_reading
from btlang.recording.film import simulate
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.robots.worlds.name_listing import list_words
from btlang.run.logs import PlainLines
from btlang.text.source import Source, Span
from btlang.vocabulary.listing import overview

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from typing import Any

_PATIENCE = 20.0  # seconds of real time that a simulation may take
_MOST_LINES = 500  # of what happened
_NAME = "<mission>"
_INSTRUCTIONS = """\
btlang compiles missions for robots, written in plain English, into behavior trees. Search the words with `words`, write
a mission, check it with `check`, apply the `fix` of each message, see with `explain` how each sentence is understood,
and run it with `simulate`. Give what a person has said to `understand`: rewrite only the sentences that it doesn't
understand, with its forms and names, and show the person the `reading` of every sentence before a robot does it."""


def serve(options: argparse.Namespace) -> int:
    """Serve until standard input ends. Raises MissionError, also where the package `mcp` is missing (BT082)."""
    if find_spec("mcp") is None:
        raise MissionError([diagnostic("BT082", Span(Source("", "btc mcp"), 0, 0), verb="mcp", package="mcp")])
    from mcp.server import MCPServer

    tools = Tools(options.keywords, options.world, options.language)
    server = MCPServer("btlang", instructions=_INSTRUCTIONS, version=btlang.__version__, log_level="ERROR")
    for tool in (tools.words, tools.check, tools.explain, tools.understand, tools.simulate, tools.grammar):
        server.tool()(tool)
    server.run("stdio")
    return 0


def _answer_problems(tool: Callable[..., dict[str, object]]) -> Callable[..., dict[str, object]]:
    """Return the tool, which answers with the messages where a text can't be used."""

    @wraps(tool)
    def answer(*given: Any, **named: Any) -> dict[str, object]:
        try:
            return tool(*given, **named)
        except MissionError as error:
            return {"ok": False, "messages": _messages(error.diagnostics)}

    return answer


class Tools:
    """The tools of a model. Every answer is data, also where a mission is wrong."""

    def __init__(self, keywords: Sequence[Any] = (), world: str | None = None, language: str = "en") -> None:
        self._options: dict[str, Any] = {"keywords": tuple(keywords), "world": world, "language": language}
        self._vocabulary = world_vocabulary(keywords, world, language)

    def words(self, search: str = "") -> dict[str, object]:
        """Return what missions can say: a topic, or phrases with these words. Without a search, the topics."""
        if search.strip():
            lines = list_words(self._vocabulary, search, command="words")
        else:
            lines = overview(self._vocabulary, command="words")
        return {"ok": True, "lines": lines}

    @_answer_problems
    def check(self, text: str) -> dict[str, object]:
        """Return the messages about a mission.

        A `fix` replaces the characters at its place; of `readings` choose one.
        """
        mission = self._mission(text)
        mission.check()
        return {"ok": True, "messages": _messages(mission.warnings)}

    @_answer_problems
    def explain(self, text: str) -> dict[str, object]:
        """Return how each sentence of a mission is understood, with brackets, and as a behavior tree."""
        mission = self._mission(text)
        return {"ok": True, "explanation": mission.explain(), "messages": _messages(mission.warnings)}

    @_answer_problems
    def understand(self, text: str) -> dict[str, object]:
        """Each sentence of what a person has said: its reading in controlled English, or what isn't understood of it.

        A sentence that isn't understood has the phrases that may fit; `names` are those that the robot knows.
        """
        return partial_reading(text, self._vocabulary, self._mission)

    @_answer_problems
    def simulate(self, text: str, seconds: float = 600.0, ticks: int = 12_000) -> dict[str, object]:
        """Run a mission on the simulated robot as fast as possible, for at most so many seconds and ticks.

        Returns what happened, the status at the end, what stopped it if it didn't end by itself, and why it failed.
        """
        mission = self._mission(text)
        lines: list[str] = []
        sink = PlainLines(mission.label, mission.is_action, lines.append)
        outcome, stopped = simulate(mission, sink, seconds, _PATIENCE, ticks)
        if outcome is None:
            return {"ok": False, "stopped": "a command never returns", "lines": lines[:_MOST_LINES], "messages": []}
        return {
            "ok": outcome.succeeded,
            "status": outcome.status.name,
            "stopped": stopped,
            "why": outcome.why(),
            "seconds": round(outcome.seconds, 3),
            "ticks": outcome.ticks,
            "lines": lines[:_MOST_LINES],
            "lines_left_out": max(0, len(lines) - _MOST_LINES),
            "messages": _messages(mission.warnings),
        }

    def grammar(self, to: str = "gbnf") -> dict[str, object]:
        """Return the grammar of missions, to constrain the output of a model: gbnf, ebnf, or json-schema for trees as
        JSON.
        """
        from btlang.backends.grammar.targets import GRAMMARS

        if to not in GRAMMARS:
            return {"ok": False, "reason": f"there is no grammar '{to}'; choose one of {', '.join(GRAMMARS)}"}
        return {"ok": True, "grammar": GRAMMARS[to](self._vocabulary)}

    def _mission(self, text: str) -> Mission:
        """Compile a text, which can include no file. Raises MissionError."""
        source = Source(text, _NAME, folder="", roots=())
        if len(text.encode("utf-8", "surrogatepass")) > MOST_BYTES:
            reason = f"it has more than {MOST_BYTES:,} bytes"
            raise MissionError([diagnostic("BT001", Span(Source("", _NAME), 0, 0), file=_NAME, reason=reason)])
        return parse_tree(source, **self._options)


def _messages(problems: Sequence[Diagnostic]) -> list[dict[str, Any]]:
    return [to_data(problem) for problem in sort_diagnostics(list(problems))]
