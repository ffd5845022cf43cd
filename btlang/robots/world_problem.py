"""World files, with what is wrong with them as a message about its line."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.robots.world import World
from btlang.robots.world_file import WorldError, load_world
from btlang.text.source import Source, Span


def world_problem(error: WorldError) -> MissionError:
    """BT070 at the line of the error."""
    from btlang.diagnostics.reading import read_source

    try:
        source = read_source(error.path)
    except MissionError:
        source = Source("", error.path)
    start = source.offset(error.line or 1)
    end = start + len(source.line(error.line).rstrip()) if error.line and source.text else start
    return MissionError([diagnostic("BT070", Span(source, start, end), reason=error.message)])


def read_world(world: str | None = None) -> World:
    """The world in a file, by default the world that ships. Raises MissionError (BT070)."""
    try:
        return load_world(world)
    except WorldError as error:
        raise world_problem(error) from None
