"""Worlds as missions use them: what is wrong with a file is a message about its line."""

from __future__ import annotations

from btlang.robots.body import Body
from btlang.robots.data_file import as_mission_error
from btlang.robots.world import World
from btlang.robots.world_file import WorldError, load_world
from btlang.text.source import Source


def read_world(world: str | Source | None = None, body: Body | None = None, *, bounded: bool = False) -> World:
    """The world in a file or a text, by default the world that ships; as `load_world`. Raises MissionError (BT070)."""
    try:
        return load_world(world, body, bounded=bounded)
    except WorldError as error:
        raise as_mission_error(error) from None
