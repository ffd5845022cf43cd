"""Data from other programs: JSON and YAML with limits, values checked one by one, and worlds in this form."""

from __future__ import annotations

import json
from math import atan2, degrees

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.maps.point_shapes import are_lines_of_points, read_csv
from btlang.robots.files import DataFileError
from btlang.robots.geometry import wrap
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import world_from
from btlang.robots.worlds.world_writing import as_data
from btlang.text.formatting import joined
from btlang.text.json_text import NestedTooDeep, load_json
from btlang.text.source import NOWHERE, Source
from btlang.text.toml_table import Problem, is_coordinate

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any


_MOST_YAML = 1_000_000  # characters; reading so many takes seconds
_LONGEST = 40  # characters of a value in a message
_KEY = "world"


class ForeignFileError(DataFileError):
    """The reason why no world can be made from a file of another program."""

    code = "BT075"


def read_data(source: Source) -> Any:
    """Return the data in JSON, YAML or CSV; of several documents a list of them.

    Raises ForeignFileError for any other text, MissionError (BT087) if PyYAML isn't installed.
    """
    try:
        return load_json(source.text)
    except NestedTooDeep:
        raise ForeignFileError("it is nested too deep", source.name, None, source) from None
    except ValueError:  # no JSON, or a number that is too long
        if source.name.lower().endswith(".json"):
            raise ForeignFileError("this isn't JSON", source.name, None, source) from None
        if source.name.lower().endswith((".csv", ".tsv")):
            return read_csv(source.text)
        if source.name.lower().endswith(".txt") and are_lines_of_points(rows := read_csv(source.text)):
            return rows
    if len(source.text) > _MOST_YAML:
        message = f"a YAML file may have at most {_MOST_YAML:,} characters; write JSON instead"
        raise ForeignFileError(message, source.name, None, source)
    return _read_yaml(source)


def _read_yaml(source: Source) -> Any:
    yaml = yaml_module()

    class Loader(yaml.SafeLoader):  # type: ignore[misc, name-defined]
        def compose_node(self, parent: Any, index: Any) -> Any:
            if self.check_event(yaml.AliasEvent):
                place = self.peek_event().start_mark
                raise yaml.MarkedYAMLError(problem="aliases (*name) can't be used here", problem_mark=place)
            return super().compose_node(parent, index)

    try:
        documents = [each for each in yaml.load_all(source.text, Loader) if each is not None]
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark is not None else None
        raise ForeignFileError(f"this isn't YAML: {error.problem}", source.name, line, source) from None
    except RecursionError:
        raise ForeignFileError("it is nested too deep", source.name, None, source) from None
    except (yaml.YAMLError, ValueError, OverflowError) as error:  # a character that may not be there, a wrong date
        raise ForeignFileError(f"this isn't YAML: {str(error).splitlines()[0]}", source.name, None, source) from None
    return documents[0] if len(documents) == 1 else documents


def yaml_module() -> ModuleType:
    """Import PyYAML. Raises MissionError (BT087) if it isn't installed."""
    try:
        import yaml
    except ImportError:
        raise missing_package("YAML files", "PyYAML") from None
    module: ModuleType = yaml
    return module


def missing_package(what: str, package: str) -> MissionError:
    """Return the error that a package of the extra `maps` isn't installed."""
    return MissionError([diagnostic("BT087", NOWHERE, what=what, package=package)])


def shown(value: object) -> str:
    """Return a value in a message, cut short."""
    # a long number has no text, and that of a large list takes long to make
    text = repr(value) if isinstance(value, str | float | bool | None) else f"a {type(value).__name__}"
    return text if len(text) <= _LONGEST else text[:_LONGEST] + "..."


def number(value: Any, what: str, low: float | None = None, high: float | None = None) -> float:
    """Return a finite number of at most a million, within the bounds. Raises Problem."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Problem(f"{what} must be a number, not {shown(value)}")
    if not is_coordinate(value):
        raise Problem(f"{what} must be a number from -1,000,000 to 1,000,000")
    if (low is not None and value < low) or (high is not None and value > high):
        bounds = f"at least {low:g}" if high is None else f"from {low:g} to {high:g}"
        raise Problem(f"{what} must be {bounds}, not {value:g}")
    return float(value)


def numbers(value: Any, what: str, *counts: int) -> list[float]:
    """Return a list of so many numbers. Raises Problem."""
    if not isinstance(value, list) or len(value) not in counts:
        raise Problem(f"{what} must be a list of {joined([*map(str, counts)], 'or')} numbers")
    return [number(each, what) for each in value]


def yaw(what: str, x: float, y: float, z: float, w: float) -> float:
    """Return the direction in degrees, (-180, 180], of a quaternion of any length but 0. Raises Problem."""
    length = x * x + y * y + z * z + w * w
    if length < 1e-9:
        raise Problem(f"{what} must be a quaternion, and this one has the length 0")
    return wrap(degrees(atan2(2 * (w * z + x * y), length - 2 * (y * y + z * z))))


def notation(world: World, to: str) -> str:
    """Return the world as text in "json" or "yaml". Raises MissionError (BT087) if PyYAML isn't installed."""
    data = {_KEY: as_data(world)}
    if to == "json":
        return json.dumps(data, indent=1) + "\n"
    text: str = yaml_module().safe_dump(data, sort_keys=False, default_flow_style=None)
    return text


def is_world(data: object) -> bool:
    """Return whether the data of a file are a world."""
    return isinstance(data, dict) and data.keys() == {_KEY} and isinstance(data[_KEY], dict) and "start" in data[_KEY]


def read_world_data(data: Any, path: str) -> World:
    """Return the world in such data. Raises WorldError, and Problem for unknown keys."""
    try:
        tables = json.loads(json.dumps(data[_KEY], default=str))  # YAML has dates, and keys that are numbers
    except TypeError:
        raise Problem("the keys of a world are texts") from None
    return world_from(tables, path)
