"""Random worlds with all that a world file can describe."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from btlang.robots.geometry import Pose
from btlang.robots.worlds.world import (
    KEEP_OUT,
    NEVER,
    SLOW,
    Door,
    FurnitureBox,
    Lane,
    Person,
    PersonUtterance,
    Place,
    Stop,
    Visits,
    World,
    WorldFault,
    WorldObject,
    Zone,
)

_numbers = st.floats(-50.0, 50.0) | st.integers(-50, 50).map(float)
_points = st.tuples(_numbers, _numbers)
_seconds = st.floats(0.0, 1000.0)
_texts = st.text(min_size=1, max_size=8).map(lambda text: " ".join(text.split())).filter(bool)
_FAR = 100.0  # metres from everything else: places need room


@st.composite
def worlds(draw: st.DrawFn) -> World:
    """Worlds that a file can describe, whose places have room."""
    names = iter(draw(st.lists(_texts, min_size=30, max_size=30, unique_by=str.lower)))
    spots = iter(range(100))

    def some(most: int = 3) -> range:
        return range(draw(st.integers(0, most)))

    def apart() -> tuple[float, float]:
        return _FAR + next(spots), draw(_numbers)

    places = tuple(_place(draw, next(names), apart()) for _ in some())
    dock = Place("dock", *apart(), draw(_numbers)) if draw(st.booleans()) and "dock" not in _names(places) else None
    faults = tuple(_fault(draw, places) for _ in some())
    return World(
        Pose(*apart(), draw(_numbers)),
        draw(st.floats(0.0, 100.0)),
        tuple(tuple(draw(st.lists(_points, min_size=2, max_size=5))) for _ in some()),
        tuple(FurnitureBox(*draw(_points), draw(st.floats(0.01, 5.0)), draw(st.floats(0.01, 5.0))) for _ in some()),
        (*places, *((dock,) if dock else ())),
        tuple(_object(draw, next(names)) for _ in some()),
        tuple(_person(draw, next(names)) for _ in some()),
        faults,
        dock,
        draw(st.integers(0, 24 * 60 - 1)) * 60.0,
        tuple(_zone(draw, next(names)) for _ in some()),
        tuple(Door(next(names), draw(_points), (60.0, 60.0), draw(st.booleans())) for _ in some()),
        draw(st.none() | st.integers(0, 1_000_000)),
        lanes=tuple(Lane(draw(_points), draw(_points), draw(st.booleans())) for _ in some()),
    )


def _names(places: tuple[Place, ...]) -> set[str]:
    return {place.name.lower() for place in places}


def _place(draw: st.DrawFn, name: str, at: tuple[float, float]) -> Place:
    optional = st.just("") | _texts
    states = tuple(draw(st.lists(_texts, max_size=2)))
    return Place(
        name, *at, draw(st.none() | _numbers), draw(optional), draw(optional), draw(optional), states, draw(optional)
    )


def _object(draw: st.DrawFn, name: str) -> WorldObject:
    switch = draw(st.sampled_from(["", "on", "off"]))
    optional = st.just("") | _texts
    radius, sized = draw(st.floats(0.01, 1.0)), draw(optional)
    return WorldObject(
        name, *draw(_points), radius, draw(st.booleans()), draw(optional), draw(optional),
        2 * radius if sized else draw(st.floats(0.0, 3.0)), tuple(draw(st.lists(_texts, max_size=2))), switch,
        draw(st.booleans()), sized, tuple(draw(st.lists(_texts, max_size=2))), draw(optional), draw(optional),
        tuple(draw(st.lists(_texts, max_size=2))),
    )  # fmt: skip


def _person(draw: st.DrawFn, name: str) -> Person:
    comes = draw(st.just(0.0) | _seconds)
    if draw(st.integers(0, 3)) == 0:
        start, hours = draw(st.integers(0, 12)), draw(st.integers(1, 11))
        days = tuple(sorted(draw(st.sets(st.integers(0, 6), min_size=1))))
        visits = Visits(start * 3600.0, (start + hours) * 3600.0, draw(st.floats(60.0, hours * 3600.0)), days)
        return Person(name, *draw(_points), draw(st.floats(0.01, 1.0)), visits=visits)
    wanders = draw(st.booleans())
    stops = st.builds(Stop, _numbers, _numbers, st.just(0.0) | _seconds, st.just(0.0) | _seconds)
    return Person(
        name, *draw(_points), draw(st.floats(0.01, 1.0)), draw(st.booleans()), comes,
        draw(st.just(NEVER) | st.floats(comes, 2000.0)), draw(st.floats(0.05, 3.0)),
        () if wanders else tuple(draw(st.lists(stops, max_size=3))), draw(st.booleans()), wanders,
        tuple(draw(st.lists(_texts, max_size=2))), draw(st.just("") | _texts),
        tuple(draw(st.lists(st.builds(PersonUtterance, _seconds, _texts), max_size=2))),
        draw(st.dictionaries(_texts.map(str.lower), _texts, max_size=2)), draw(_seconds), draw(st.floats(0.0, 1.0)),
        asks=tuple(draw(st.lists(_texts, max_size=2))),
    )  # fmt: skip


def _zone(draw: st.DrawFn, name: str) -> Zone:
    kind = draw(st.sampled_from([KEEP_OUT, SLOW]))
    points = tuple(draw(st.lists(_points, min_size=3, max_size=5)))
    return Zone(name, kind, points, draw(st.floats(0.01, 3.0)) if kind == SLOW else 0.0)


def _fault(draw: st.DrawFn, places: tuple[Place, ...]) -> WorldFault:
    kinds = ["slip", "silent scanner", "weak hand", *(["blocked"] if places else [])]
    kind = draw(st.sampled_from(kinds))
    more: dict[str, dict[str, Any]] = {
        "blocked": {"place": draw(st.sampled_from(places)).name if places else ""},
        "slip": {"wheel": draw(st.sampled_from(["left", "right", "both"])), "grip": draw(st.floats(0.0, 1.0))},
        "weak hand": {"hand": draw(st.sampled_from(["left", "right"])), "seconds": draw(_seconds)},
    }
    return WorldFault(kind, draw(_seconds), draw(st.just(NEVER) | _seconds), **more.get(kind, {}))
