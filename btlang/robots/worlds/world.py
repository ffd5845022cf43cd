"""What a world holds: walls, places, people, zones and faults. Frozen data without numpy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise
from random import Random

from btlang.robots.geometry import Point, Pose, Segment, contains
from btlang.robots.worlds.likeness import Parts, kinds_of, of_person, of_thing, wears
from btlang.support.record import Record
from btlang.text.time_of_day import DAY, USUAL_START
from btlang.vocabulary.references import HOME, PARTS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_LEAST, _MOST = 0.5, 1.5  # of the time that a visit usually takes
_WEEK = 7
KEEP_OUT, SLOW, AREA = "keep out", "slow", "area"
PERSON_RADIUS = 0.25
OBJECT_RADIUS = 0.05
NEVER = float("inf")
_UNDRAWN = (
    "comes", "leaves", "says", "answers", "answers_after", "follows", "again", "uses", "walks", "visits", "asks",
    "sized", "state", "owner", "content", "having",
)  # fmt: skip


class Visits(Record):
    """One visit on each of these days (0 is Monday), not before `start` and gone by `end` (seconds since midnight).

    It lasts about `stays` seconds: half of it to one and a half.
    """

    start: float
    end: float
    stays: float
    days: tuple[int, ...] = tuple(range(_WEEK))

    def next(self, now: float, weekday: int, seed: str) -> tuple[float, float]:
        """Return when the next visit begins and ends, in seconds since the midnight before day 0, which is that
        `weekday`.

        It follows from the day and the seed alone. One that would have begun before `now` isn't made up for.
        """
        day = int(now // DAY)
        while True:
            if (weekday + day) % _WEEK in self.days:
                random = Random(f"{seed} {day}")
                stays = min(self.stays * random.uniform(_LEAST, _MOST), self.end - self.start)
                comes = day * DAY + random.uniform(self.start, self.end - stays)
                if comes >= now:
                    return comes, comes + stays
            day += 1


class Place(Record):
    """A named point to stand on; `facing` (degrees) is None for any direction, `kind` may be "room".

    It may be described as an object is.
    """

    name: str
    x: float
    y: float
    facing: float | None = None
    kind: str = ""
    color: str = ""
    sized: str = ""
    state: tuple[str, ...] = ()
    owner: str = ""

    @property
    def parts(self) -> Parts:
        """The parts that it can be described by."""
        return of_thing(kinds_of(self.name, self.kind), self.color, self.sized, self.state, self.owner)


class Thing(Record):
    """An object or a person: a disc that the robot sees, drives around and bumps into.

    If a thing isn't `known`, the robot knows it only from where its sensors have seen it.
    """

    name: str
    x: float
    y: float
    radius: float
    known: bool = True

    @property
    def parts(self) -> Parts:
        """The parts that it can be described by: ("color", "red")."""
        return ()

    def fits(self, parts: Mapping[str, str]) -> bool:
        """Return whether a description with these parts fits it."""
        return set(parts.items()) <= set(self.parts)


class WorldObject(Thing):
    """An object. `size` is the metres of its longest side, `uses` are what it is good for: "drink".

    It may be `sized` in a word ("small"), have a `state` ("dirty"), belong to its `owner`, hold its `content` ("water")
    and be one `having` parts ("red lid"). `switch` is "on" or "off" if it can be switched; a `fixed` object can't be
    picked up.
    """

    kind: str = ""
    color: str = ""
    size: float = 0.0
    uses: tuple[str, ...] = ()
    switch: str = ""
    fixed: bool = False
    sized: str = ""
    state: tuple[str, ...] = ()
    owner: str = ""
    content: str = ""
    having: tuple[str, ...] = ()

    @property
    def parts(self) -> Parts:
        """The parts that it can be described by."""
        kinds = kinds_of(self.name, self.kind)
        return of_thing(kinds, self.color, self.sized, self.state, self.owner, self.uses, self.content, self.having)


class Stop(Record):
    """A point of a route: nobody leaves for it before second `at` of the run, and they stay for `stays` seconds."""

    x: float
    y: float
    at: float = 0.0
    stays: float = 0.0


class PersonUtterance(Record):
    """A text that somebody calls out at a second of the run."""

    at: float
    text: str


class Person(Thing):
    """Somebody who may come, walk along a route, speak, answer, follow the robot, and leave; in seconds of the run.

    `walks` is the route, which is walked over and over if `again` is true; a person who `wanders` walks from place to
    place. `answers` are by a word of the question, "*" for any, and take `answers_after` seconds. `follows` is from 0
    to 1, how well they keep up when guided: 1 always. What they `refuse` isn't taken from the robot. `visits` are when
    they come in place of `comes` and `leaves`; the `kind` may be "guest"; what they `ask` is asked now and then near
    the robot.
    """

    comes: float = 0.0
    leaves: float = NEVER
    speed: float = 1.1
    walks: tuple[Stop, ...] = ()
    again: bool = False
    wanders: bool = False
    wears: tuple[str, ...] = ()
    gesture: str = ""
    says: tuple[PersonUtterance, ...] = ()
    answers: Mapping[str, str] = {}
    answers_after: float = 1.5
    follows: float = 1.0
    refuses: tuple[str, ...] = ()
    visits: Visits | None = None
    asks: tuple[str, ...] = ()
    kind: str = ""

    @property
    def parts(self) -> Parts:
        """The parts that they can be described by."""
        kind = (("kind", self.kind.lower()),) if self.kind else ()
        return (*of_person(self.wears, self.gesture), *kind)

    def fits(self, parts: Mapping[str, str]) -> bool:
        """Return whether a description with these parts fits them."""
        is_kind = parts.get("kind", "") in ("", self.kind.lower())
        return is_kind and wears(self.wears, parts) and parts.get("gesture", "") in ("", self.gesture.lower())

    @property
    def comes_later(self) -> bool:
        """Whether they aren't there at the start."""
        return bool(self.comes or self.visits)

    @property
    def moves(self) -> bool:
        """Whether they ever move by themselves."""
        return bool(self.walks or self.wanders or self.comes_later or self.leaves < NEVER)


class Zone(Record):
    """A polygon that the robot keeps out of, or drives through at no more than `speed` metres a second.

    An area has no effect by itself; a mission may close it, or stay in it.
    """

    name: str
    kind: str
    points: tuple[Point, ...]
    speed: float = 0.0

    @property
    def is_closed(self) -> bool:
        """Whether the robot has to keep out."""
        return self.kind == KEEP_OUT

    @property
    def is_slow(self) -> bool:
        """Whether the robot drives slowly there."""
        return self.kind == SLOW

    def contains(self, point: Point) -> bool:
        """Return whether a point is inside, by the even-odd rule."""
        return contains(self.points, point)


class Door(Record):
    """A door between two points of a wall. A closed one is a piece of wall."""

    name: str
    start: Point
    end: Point
    open: bool = True

    @property
    def middle(self) -> Point:
        """The point in the middle."""
        return (self.start[0] + self.end[0]) / 2, (self.start[1] + self.end[1]) / 2


class Lane(Record):
    """A straight piece of the ways that a robot keeps to, `one_way` from its start to its end."""

    start: Point
    end: Point
    one_way: bool = False


class FurnitureBox(Record):
    """A piece of furniture: a rectangle parallel to the axes, given by its centre and size."""

    x: float
    y: float
    width: float
    height: float

    def contains(self, point: Point) -> bool:
        """Return whether a point is inside, or on the edge."""
        return abs(point[0] - self.x) <= self.width / 2 and abs(point[1] - self.y) <= self.height / 2

    def edges(self) -> tuple[Segment, ...]:
        """Return its four sides."""
        left, right = self.x - self.width / 2, self.x + self.width / 2
        low, high = self.y - self.height / 2, self.y + self.height / 2
        corners = ((left, low), (right, low), (right, high), (left, high))
        return tuple((*corners[i - 1], *corners[i]) for i in range(4))


class WorldFault(Record):
    """Something that goes wrong from `start` until `end` (seconds of the run).

    kind "blocked": no way leads to `place`. "slip": the share `grip` (0 to 1) of the motion of `wheel` ("left",
    "right", "both") reaches the floor. "silent scanner": no scans. "weak hand": `hand` drops what it has held for
    `seconds`. "dock": connecting to the dock at `place`, "" for any, fails, so many `times`.
    """

    kind: str
    start: float = 0.0
    end: float = NEVER
    place: str = ""
    wheel: str = "both"
    grip: float = 1.0
    hand: str = "right"
    seconds: float = 0.0
    times: float = NEVER


def said(name: str) -> str:
    """Return the name as it is spoken of: "the lab", but "Alice" and the spot "(1.00, 2.00)"."""
    return name if name[:1].isupper() or name[:1] == "(" else f"the {name}"


class WorldNames(Record):
    """The names a mission may use, as the world file spells them; `features` are their parts, by their type."""

    places: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()
    people: tuple[str, ...] = ()
    zones: tuple[str, ...] = ()
    doors: tuple[str, ...] = ()
    regions: tuple[str, ...] = ()
    """The zones that the robot may enter and no place has the name of: they are places, too."""
    features: Mapping[str, tuple[tuple[str, Parts], ...]] = {}

    def of(self, kind: str) -> tuple[str, ...]:
        """Return the names of a type: a key of `by_type`."""
        return self.by_type.get(kind, ())

    def every(self, kind: str) -> tuple[str, ...]:
        """Return the names among which one of a type is chosen: no region is among the places."""
        return self.places if kind == "place" else self.of(kind)

    @property
    def by_type(self) -> dict[str, tuple[str, ...]]:
        """The names of each type of slots."""
        of = {"place": (*self.places, *self.regions), "object": self.objects, "person": self.people}
        likes = dict.fromkeys(part for named in self.features.values() for _, parts in named for part in parts)
        described = {part: tuple(text for name, text in likes if name == part) for part in PARTS}
        return {**of, "zone": self.zones, "door": self.doors, **described}


class World(Record):
    """A world as its file describes it.

    `walls` are polylines; a dock is also the place "dock", and each of further `docks` the place of its name. `clock`
    is the time of day at its start, in seconds since midnight, on a `weekday` (0: Monday); `seed` is the default for
    runs. `ordinals` is what `the second room` counts by: the "way" from the robot, or the "name". `home` is the place
    that this word means.
    """

    start: Pose
    battery: float = 100.0
    walls: tuple[tuple[Point, ...], ...] = ()
    boxes: tuple[FurnitureBox, ...] = ()
    places: tuple[Place, ...] = ()
    objects: tuple[WorldObject, ...] = ()
    people: tuple[Person, ...] = ()
    faults: tuple[WorldFault, ...] = ()
    dock: Place | None = None
    clock: float = USUAL_START
    zones: tuple[Zone, ...] = ()
    doors: tuple[Door, ...] = ()
    seed: int | None = None
    weekday: int = 0
    docks: tuple[Place, ...] = ()
    ordinals: str = "way"
    home: str = ""
    lanes: tuple[Lane, ...] = ()

    @property
    def all_docks(self) -> tuple[Place, ...]:
        """Every place where a robot can charge."""
        return self.docks if self.dock is None else (self.dock, *self.docks)

    def docks_from(self, pose: Pose) -> tuple[Place, ...]:
        """Return `all_docks`, the nearest to a pose first."""
        return tuple(sorted(self.all_docks, key=lambda dock: pose.distance_to((dock.x, dock.y))))

    @property
    def names(self) -> WorldNames:
        """All names of the world."""
        named = (self.places, self.objects, self.people, self.zones, self.doors)
        likes = (("object", self.objects), ("person", self.people), ("place", self.places))
        features = {kind: tuple((thing.name, thing.parts) for thing in things) for kind, things in likes}
        features["door"] = tuple((door.name, ()) for door in self.doors)
        if self.home:
            at_home = ((name, (*parts, HOME) if name == self.home else parts) for name, parts in features["place"])
            features["place"] = tuple(at_home)
        places, objects, people, zones, doors = (tuple(each.name for each in kind) for kind in named)
        return WorldNames(places, objects, people, zones, doors, tuple(zone.name for zone in self.regions), features)

    @property
    def regions(self) -> tuple[Zone, ...]:
        """The zones that the robot may enter, and that nothing else has the name of."""
        named = {thing.name.lower() for things in (self.places, self.objects, self.people) for thing in things}
        return tuple(zone for zone in self.zones if not zone.is_closed and zone.name.lower() not in named)

    def wall_segments(self) -> tuple[Segment, ...]:
        """Return the walls in straight pieces, without furniture."""
        return tuple((*a, *b) for wall in self.walls for a, b in pairwise(wall))

    def segments(self) -> tuple[Segment, ...]:
        """Return all that is fixed: walls first, then the sides of boxes."""
        return self.wall_segments() + tuple(edge for box in self.boxes for edge in box.edges())

    def with_places(self, places: Iterable[Place]) -> World:
        """Return the world with more named places; each replaces a place of the same name."""
        named = {place.name.lower(): place for place in places}
        others = tuple(known for known in self.places if known.name.lower() not in named)
        changed: World = self.replace(places=(*others, *named.values()))
        return changed

    def as_map(self) -> dict[str, Any]:
        """Return what is drawn of it, as in a world file."""
        found: dict[str, Any] = {
            kind: [each.as_dict(_UNDRAWN) for each in getattr(self, kind)]
            for kind in ("boxes", "places", "objects", "people", "zones", "doors", "lanes")
        }
        for person, shown in zip(self.people, found["people"], strict=True):
            shown["walks"] = [(stop.x, stop.y) for stop in person.walks]
        dock = next((dock.as_dict() for dock in self.all_docks), None)
        return {"walls": self.walls, "dock": dock, **found}
