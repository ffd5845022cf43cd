"""Worlds back to the data of their files, and to TOML: reading that gives the same world."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.robots.worlds.world import Door, Lane, Person, Stop, Visits, World, WorldFault, WorldObject
from btlang.robots.worlds.world_tables import ANYWHERE
from btlang.support.record import Record
from btlang.text.time_of_day import USUAL_START, WEEKDAYS, shown
from btlang.text.toml import toml_value

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_KEYS: dict[type, dict[str, str]] = {
    WorldFault: {"start": "from", "end": "until"},
    Door: {"start": "from", "end": "to"},
    Lane: {"start": "from", "end": "to"},
    WorldObject: {"having": "has"},
}
"""The keys of fields whose key in the file differs."""
_MONDAY = 5  # of January 2026
_LISTS = ("boxes", "docks", "places", "objects", "people", "zones", "doors", "lanes", "faults")


def as_data(world: World) -> dict[str, Any]:
    """Return the tables of its file: texts, numbers, flags, lists and dicts."""
    start, dock = world.start, world.dock
    begin = {"x": start.x, "y": start.y, "facing": start.heading}
    data: dict[str, Any] = {"start": begin | ({} if world.battery == 100.0 else {"battery": world.battery})}
    if (world.clock, world.weekday) != (USUAL_START, 0):
        data["clock"] = f"2026-01-{_MONDAY + world.weekday:02} {shown(world.clock)}"
    if world.seed is not None:
        data["seed"] = world.seed
    data |= {
        key: value for key, value in (("ordinals", world.ordinals), ("home", world.home)) if value not in ("", "way")
    }
    if dock is not None:
        data["dock"] = {"x": dock.x, "y": dock.y, "facing": dock.facing}
    if world.walls:
        data["walls"] = [[list(point) for point in wall] for wall in world.walls]
    for key in _LISTS:
        docks = () if key == "docks" else world.all_docks
        rows = [_row(record) for record in getattr(world, key) if record not in docks]
        if rows:
            data[key] = rows
    return data


def _row(record: Record) -> dict[str, Any]:
    keys, always = _KEYS.get(type(record), {}), _always(record)
    usual = record.field_defaults
    row = {
        keys.get(field, field): _to_data(value)
        for field, value in record.as_dict().items()
        if field in always or field not in usual or value != usual[field]
    }
    if sized := row.pop("sized", ""):
        row["size"] = sized
    if isinstance(record, Person):
        if row.pop("wanders", False):
            row["walks"] = ANYWHERE
    return row


def _always(record: Record) -> tuple[str, ...]:
    """Return the fields without a default in the file, or with one that depends on others."""
    if isinstance(record, WorldObject):
        return ("size", "fixed") if record.switch else ("size",)
    if isinstance(record, WorldFault):
        return {"slip": ("grip",), "weak hand": ("seconds",)}.get(record.kind, ())
    return ()


def _to_data(value: Any) -> Any:
    if isinstance(value, Stop) and not (value.at or value.stays):
        return [value.x, value.y]
    if isinstance(value, Stop):
        row = _row(value)
        return {"to": [row.pop("x"), row.pop("y")], **row}
    if isinstance(value, Visits):
        days = [] if len(value.days) == len(WEEKDAYS) else [WEEKDAYS[day] for day in value.days]
        row = {"from": shown(value.start), "until": shown(value.end), "stays": value.stays}
        return row | ({"days": days} if days else {})
    if isinstance(value, Record):
        return _row(value)
    if isinstance(value, tuple):
        return [_to_data(each) for each in value]
    return dict(value) if isinstance(value, Mapping) else value


def to_toml(world: World) -> str:
    """Return a world file: a line for each wall, place and other thing."""
    return "".join(_entry(key, value) for key, value in as_data(world).items())


def _entry(key: str, value: Any) -> str:
    if not isinstance(value, list):
        return f"{key} = {toml_value(value)}\n"
    rows = "".join(f"  {toml_value(row)},\n" for row in value)
    return f"\n{key} = [\n{rows}]\n"
