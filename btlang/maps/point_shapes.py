"""Other shapes of lists of points, as the usual ones: columns, texts of numbers, names before numbers, and CSV."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping

from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_BETWEEN = re.compile(r"\s*[,;]\s*|\s+")
_LEAST, _MOST = 2, 7  # numbers of a point
_COLUMNS = (("x", "y"), ("xs", "ys"), ("latitude", "longitude"), ("lat", "lon"), ("lat", "lng"), ("lats", "lons"))
_ONE = {"names": "name", "labels": "name", "ids": "id", "yaws": "yaw", "thetas": "theta", "headings": "heading",
        "xs": "x", "ys": "y", "lats": "lat", "lons": "lon"}  # fmt: skip


def usual_shape(data: Any, names: Iterable[str]) -> Any:
    """Return data with points in tables and lists of numbers only; texts under the keys `names` stay texts.

    Raises Problem for columns of different lengths.
    """
    if isinstance(data, Mapping):
        rows = _rows(data)
        if rows is not None:
            return rows
        keep = {key for key in data if str(key).lower() in names and isinstance(data[key], str)}
        return {key: value if key in keep else usual_shape(value, names) for key, value in data.items()}
    if isinstance(data, str):
        return numbers_in(data) or data
    if not isinstance(data, list):
        return data
    if len(data) > _LEAST and isinstance(data[0], str) and are_numbers(data[1:]) and len(data) <= _MOST + 1:
        return {"name": data[0], "pose": data[1:]}
    if len(data) == _LEAST and are_numbers(data[0]) and are_numbers(data[1:]):
        return {"position": data[0], "yaw": data[1]}
    return [usual_shape(each, names) for each in data]


def are_numbers(value: Any) -> bool:
    """Return whether a value is a list of one or more numbers."""
    if not isinstance(value, list) or not value:
        return False
    return all(isinstance(each, int | float) and not isinstance(each, bool) for each in value)


def numbers_in(text: str) -> list[float]:
    """Return the numbers of a text that holds as many as a point may have, and nothing else; [] for any other text."""
    parts = _BETWEEN.split(text.strip().strip("[]()").strip())
    is_point = _LEAST <= len(parts) <= _MOST and all(map(_NUMBER.fullmatch, parts))
    return [float(part) for part in parts] if is_point else []


def _rows(table: Mapping[Any, Any]) -> list[dict[str, Any]] | None:
    """Return a table for each point of columns, such as {x: [1, 2], y: [3, 4]}; None for any other table."""
    columns = {str(key).lower(): value for key, value in table.items() if isinstance(value, list)}
    for first, second in _COLUMNS:
        for key in columns:
            other = key.removesuffix(first) + second
            is_axis = key == first or key.endswith(f"_{first}")
            if is_axis and are_numbers(columns[key]) and are_numbers(columns.get(other)):
                count, before = len(columns[key]), key.removesuffix(first)
                if len(columns[other]) != count:
                    raise Problem(f"{key} has {count} numbers, and {other} has {len(columns[other])}")
                found = {name.removeprefix(before): value for name, value in columns.items() if len(value) == count}
                return [{_ONE.get(name, name): value[at] for name, value in found.items()} for at in range(count)]
    return None


def read_csv(text: str) -> list[Any]:
    """Return a table for each line below a line of names, or a list for each line; numbers as numbers.

    Semicolons, tabs, commas or blanks are between the columns. A text that is no CSV has no lines.
    """
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    divider = next((each for each in ";\t," if all(each in line for line in lines)), " ")
    try:
        cells = list(csv.reader(lines, delimiter=divider, skipinitialspace=True))
    except csv.Error:  # a cell is too long
        return []
    rows = [[_value(cell.strip()) for cell in row] for row in cells]
    if not rows or any(isinstance(cell, float) for cell in rows[0]):
        return rows
    names = [str(name).lower() for name in rows[0]]
    return [dict(zip(names, row, strict=False)) for row in rows[1:]]


def are_lines_of_points(rows: list[Any]) -> bool:
    """Return whether each line of a text has at least two numbers; a text in YAML has not."""
    values = [row.values() if isinstance(row, dict) else row for row in rows]
    return bool(values) and all(sum(isinstance(cell, float) for cell in line) >= _LEAST for line in values)


def _value(cell: str) -> str | float:
    return float(cell) if _NUMBER.fullmatch(cell) else cell
