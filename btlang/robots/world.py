"""What a world holds: walls, places, movable things and faults. Frozen data without numpy."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

from btlang.record import Record
from btlang.robots.geometry import Point, Pose, Segment
from btlang.text.time_of_day import USUAL_START

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

PERSON_RADIUS = 0.25
OBJECT_RADIUS = 0.05
NEVER = float("inf")


class Place(Record):
    """A named point to stand on; `facing` (degrees) is None where any direction will do."""

    name: str
    x: float
    y: float
    facing: float | None = None


class Thing(Record):
    """An object or a person: a disc that the robot sees, walks around and bumps into."""

    name: str
    x: float
    y: float
    radius: float


class Box(Record):
    """A piece of furniture: a rectangle parallel to the axes, given by its centre and size."""

    x: float
    y: float
    width: float
    height: float

    def contains(self, point: Point) -> bool:
        """True on its edge too."""
        return abs(point[0] - self.x) <= self.width / 2 and abs(point[1] - self.y) <= self.height / 2

    def edges(self) -> tuple[Segment, ...]:
        """Its four sides."""
        left, right = self.x - self.width / 2, self.x + self.width / 2
        low, high = self.y - self.height / 2, self.y + self.height / 2
        corners = ((left, low), (right, low), (right, high), (left, high))
        return tuple((*corners[i - 1], *corners[i]) for i in range(4))


class Fault(Record):
    """Something that goes wrong from `start` until `end` (seconds of the run).

    kind "blocked": no way leads to `place`. "slip": of the motion of `wheel` ("left", "right", "both") the share `grip`
    (0 to 1) reaches the floor. "silent scanner": no scans. "weak hand": `hand` drops what it has held for `seconds`.
    """

    kind: str
    start: float = 0.0
    end: float = NEVER
    place: str = ""
    wheel: str = "both"
    grip: float = 1.0
    hand: str = "right"
    seconds: float = 0.0


def said(name: str) -> str:
    """The name as it is spoken of: "the lab", but "Alice" and the spot "(1.00, 2.00)"."""
    return name if name[:1].isupper() or name[:1] == "(" else f"the {name}"


class WorldNames(Record):
    """The names a mission may use, as the world file spells them."""

    places: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()
    people: tuple[str, ...] = ()

    def of(self, kind: str) -> tuple[str, ...]:
        """Those of a type: "place", "object" or "person"."""
        return {"place": self.places, "object": self.objects, "person": self.people}.get(kind, ())


class World(Record):
    """A world as its file describes it. `walls` are polylines; a dock is also the place "dock".

    `clock` is the time of day at its start, in seconds since midnight.
    """

    start: Pose
    battery: float = 100.0
    walls: tuple[tuple[Point, ...], ...] = ()
    boxes: tuple[Box, ...] = ()
    places: tuple[Place, ...] = ()
    objects: tuple[Thing, ...] = ()
    people: tuple[Thing, ...] = ()
    faults: tuple[Fault, ...] = ()
    dock: Place | None = None
    clock: float = USUAL_START

    @property
    def names(self) -> WorldNames:
        """All names of the world."""
        return WorldNames(*(tuple(thing.name for thing in kind) for kind in (self.places, self.objects, self.people)))

    def wall_segments(self) -> tuple[Segment, ...]:
        """The walls in straight pieces, without furniture."""
        return tuple((*a, *b) for wall in self.walls for a, b in pairwise(wall))

    def segments(self) -> tuple[Segment, ...]:
        """All that is fixed: walls first, then the sides of boxes."""
        return self.wall_segments() + tuple(edge for box in self.boxes for edge in box.edges())

    def with_places(self, places: Iterable[Place]) -> World:
        """The world with more named places; each replaces a place of the same name."""
        named = {place.name.lower(): place for place in places}
        others = tuple(known for known in self.places if known.name.lower() not in named)
        changed: World = self.replace(places=(*others, *named.values()))
        return changed

    def as_map(self) -> dict[str, Any]:
        """What is drawn of it, as in a world file."""
        listed = {kind: getattr(self, kind) for kind in ("boxes", "places", "objects", "people")}
        found: dict[str, Any] = {kind: [each.as_dict() for each in known] for kind, known in listed.items()}
        return {"walls": self.walls, "dock": None if self.dock is None else self.dock.as_dict(), **found}
