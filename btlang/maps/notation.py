"""Worlds in JSON and YAML: the tables of a world file below one key."""

from __future__ import annotations

import json

from btlang.maps.data_text import yaml_module
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import world_from
from btlang.robots.worlds.world_writing import as_data
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_KEY = "world"


def notation(world: World, to: str) -> str:
    """The world as text in "json" or "yaml". Raises MissionError (BT087) where PyYAML isn't installed."""
    data = {_KEY: as_data(world)}
    if to == "json":
        return json.dumps(data, indent=1) + "\n"
    text: str = yaml_module().safe_dump(data, sort_keys=False, default_flow_style=None)
    return text


def is_world(data: object) -> bool:
    """Whether the data of a file are those of a world."""
    return isinstance(data, dict) and data.keys() == {_KEY} and isinstance(data[_KEY], dict) and "start" in data[_KEY]


def read_world_data(data: Any, path: str) -> World:
    """The world of such data. Raises WorldError, and Problem for keys that no file can have."""
    try:
        tables = json.loads(json.dumps(data[_KEY], default=str))  # YAML has dates, and keys that are numbers
    except TypeError:
        raise Problem("the keys of a world are texts") from None
    return world_from(tables, path)
