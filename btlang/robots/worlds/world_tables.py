"""Reads objects, people, zones and doors of a world file."""

from __future__ import annotations

from btlang.robots.geometry import Point
from btlang.robots.worlds.world import (
    AREA,
    KEEP_OUT,
    NEVER,
    OBJECT_RADIUS,
    PERSON_RADIUS,
    SLOW,
    Door,
    Lane,
    Person,
    PersonUtterance,
    Place,
    Stop,
    Visits,
    WorldObject,
    Zone,
)
from btlang.text.time_of_day import WEEKDAYS, seconds_of
from btlang.text.toml_table import Problem, Table, is_coordinate

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

ANYWHERE = "anywhere"
"""The `walks` of a person who wanders."""
_MOST_STOPS, _MOST_IN_CROWD = 1_000, 1_000
_SHORTEST_VISIT = 60.0  # seconds


def is_point(value: Any) -> bool:
    """Return whether it is [x, y]."""
    return isinstance(value, list) and len(value) == 2 and all(map(is_coordinate, value))


def read_object(table: Table, known: bool) -> WorldObject:
    """Read an entry of `objects`. Raises Problem."""
    name, x, y = table.text("name"), table.number("x"), table.number("y")
    radius = table.number("radius", OBJECT_RADIUS, low=0.01)
    known = table.flag("known", known)
    kind, color = _optional(table, "kind"), _optional(table, "color")
    sized, state, owner = read_likeness(table)
    size, uses = 2 * radius if sized else table.number("size", 2 * radius, low=0.0), table.texts("uses")
    switch = table.choice("switch", ("on", "off"), "")
    fixed = table.flag("fixed", bool(switch))
    content, having = _optional(table, "content"), table.texts("has")
    return table.finish(
        WorldObject(
            name, x, y, radius, known, kind, color, size, uses, switch, fixed, sized, state, owner, content, having
        )
    )


def read_likeness(table: Table) -> tuple[str, tuple[str, ...], str]:
    """Read the size of a thing in a word, "" if it is in metres, its states, and its owner. Raises Problem."""
    sized = table.text("size") if table.has("size") and table.is_text("size") else ""
    return sized, table.texts("state"), _optional(table, "owner")


def read_person(table: Table, known: bool, places: Sequence[Place]) -> Person:
    """Read an entry of `people`. Raises Problem."""
    name, x, y = table.text("name"), table.number("x"), table.number("y")
    radius = table.number("radius", PERSON_RADIUS, low=0.01)
    known = table.flag("known", known)
    comes = table.number("comes", 0.0, low=0.0)
    leaves = table.number("leaves", NEVER, low=comes)
    speed = table.number("speed", 1.1, low=0.05, high=3.0)
    wanders = table.is_text("walks") and table.choice("walks", (ANYWHERE,)) == ANYWHERE
    walks = () if wanders else _route(table, {place.name.lower(): place for place in places})
    again = table.flag("again")
    wears, gesture = table.texts("wears"), _optional(table, "gesture")
    says = tuple(map(_utterance, table.tables("says")))
    answers = _answers(table)
    after, follows = table.number("answers_after", 1.5, low=0.0), table.number("follows", 1.0, low=0.0, high=1.0)
    return table.finish(
        Person(
            name, x, y, radius, known, comes, leaves, speed, walks, again, wanders, wears, gesture, says, answers,
            after, follows, table.texts("refuses"), _visits(table), table.texts("asks"),
            _optional(table, "kind"),
        )
    )  # fmt: skip


def read_crowd(table: Table, known: bool, places: Sequence[Place]) -> tuple[Person, ...]:
    """Read an entry of `crowds`: people of the same kind, called "guest 1", "guest 2" and so on. Raises Problem."""
    count = int(table.number("count", low=1.0, high=_MOST_IN_CROWD))
    person = read_person(table, known, places)
    each = person.replace(wanders=True) if not person.walks else person
    return tuple(each.replace(name=f"{person.name} {at}") for at in range(1, count + 1))


def read_zone(table: Table) -> Zone:
    """Read an entry of `zones`. Raises Problem."""
    name, kind = table.text("name"), table.choice("kind", (KEEP_OUT, SLOW, AREA))
    points = read_corners(table)
    speed = table.number("speed", low=0.01) if kind == SLOW else 0.0
    return table.finish(Zone(name, kind, points, speed))


def read_corners(table: Table) -> tuple[Point, ...]:
    """Read the `points` of an area. Raises Problem."""
    points = table.items("points")
    if len(points) < 3 or not all(map(is_point, points)):
        message = "a zone has three or more points: write points = [[0, 0], [4, 0], [4, 2]]"
        raise table.problem("points", message)
    return tuple((float(x), float(y)) for x, y in points)


def read_door(table: Table) -> Door:
    """Read an entry of `doors`. Raises Problem."""
    name, start, end = table.text("name"), _point(table, "from"), _point(table, "to")
    if start == end:
        raise table.problem("to", "a door needs two different points")
    return table.finish(Door(name, start, end, table.flag("open", True)))


def read_lane(table: Table) -> Lane:
    """Read an entry of `lanes`. Raises Problem."""
    return table.finish(Lane(_point(table, "from"), _point(table, "to"), table.flag("one_way", False)))


def _optional(table: Table, key: str) -> str:
    return table.text(key) if table.has(key) else ""


def _point(table: Table, key: str) -> Point:
    pair = table.items(key) if table.has(key) else None
    if not is_point(pair):
        raise table.problem(key, f'"{key}" must be a point; write {key} = [2, 3]')
    assert pair is not None
    return float(pair[0]), float(pair[1])


def _route(table: Table, places: Mapping[str, Place]) -> tuple[Stop, ...]:
    stops = table.items("walks")
    if len(stops) > _MOST_STOPS:
        raise table.problem("walks", f"a route has at most {_MOST_STOPS:,} stops")
    return tuple(_stop(table, index, value, places) for index, value in enumerate(stops))


def _stop(table: Table, index: int, value: Any, places: Mapping[str, Place]) -> Stop:
    path = (*table.path, "walks", index)
    if not isinstance(value, dict):
        return Stop(*_where(value, places, path))
    stop = Table("a stop", value, path)
    to = value.get("to") if stop.has("to") else None
    at, stays = stop.number("at", 0.0, low=0.0), stop.number("stays", 0.0, low=0.0)
    return stop.finish(Stop(*_where(to, places, path), at, stays))


def _where(value: Any, places: Mapping[str, Place], path: tuple[str | int, ...]) -> Point:
    if is_point(value):
        return float(value[0]), float(value[1])
    place = places.get(value.lower()) if isinstance(value, str) else None
    if place is None:
        message = (
            'a stop is a place of this world or a point: write walks = ["kitchen", [3, 4], { to = "lab", at = 30 }]'
        )
        raise Problem(message, *path)
    return place.x, place.y


def _visits(table: Table) -> Visits | None:
    if not table.has("visits"):
        return None
    for key in ("comes", "leaves"):
        if table.has(key):
            raise table.problem(key, f'somebody has "visits" or "{key}", not both')
    visits = table.table("visits")
    start, end = _time_of_day(visits, "from"), _time_of_day(visits, "until")
    if end - start < _SHORTEST_VISIT:
        raise visits.problem("until", '"until" must be later than "from" on the same day')
    stays = visits.number("stays", low=_SHORTEST_VISIT, high=end - start)
    days = visits.texts("days") or WEEKDAYS
    for day in days:
        if day not in WEEKDAYS:
            raise visits.problem("days", f'"{day}" is no day; write days = ["Monday", "Sunday"]')
    return visits.finish(Visits(start, end, stays, tuple(sorted({WEEKDAYS.index(day) for day in days}))))


def _time_of_day(table: Table, key: str) -> float:
    try:
        return seconds_of(table.text(key))
    except ValueError as problem:
        raise table.problem(key, f'"{key}" {problem}; write {key} = "10:00"') from None


def _utterance(table: Table) -> PersonUtterance:
    return table.finish(PersonUtterance(table.number("at", low=0.0), table.text("text")))


def _answers(table: Table) -> dict[str, str]:
    answers = table.values("answers")
    for word, answer in answers.items():
        if not isinstance(answer, str):
            message = 'an answer is a text; write answers = { "coffee" = "yes" }'
            raise Problem(message, *table.path, "answers", word)
    return {word.lower(): answer for word, answer in answers.items()}
