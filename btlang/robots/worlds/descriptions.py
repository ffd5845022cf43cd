"""Which things of a world a description means: the cup on the table, the nearest one, or any by a seed."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import dist

from btlang.robots.geometry import Point, Pose, centre_of, segment_distance, wrap
from btlang.robots.robot import OnEvent, RobotError
from btlang.robots.worlds.likeness import Parts, unseen
from btlang.robots.worlds.world import World, WorldObject, said
from btlang.text.formatting import nth
from btlang.vocabulary.references import DENIED, RELATIONS, SECOND, SELF, ordinal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.worlds.world import Thing


NEAR = 2.0
"""Metres within which something is near, beside, behind, left or right of another thing."""
HERE = 1.0
"""Metres from a place within which the robot is there."""
BETWEEN = 0.25
"""A share of the distance between two things: what is within it of the line between them is between them."""
_SIDES = {"in_front_of": 0.0, "left_of": 90.0, "behind": 180.0, "right_of": -90.0}
"""The bearings of the sides of the robot, in degrees to the left."""
_HALF_SIDE = 60.0  # degrees: what is ahead to the left is on both of these sides
_ON_THING = 0.5
_AT_PLACE = 4.0
_TOGETHER = frozenset(("on", "inside", "at", "off", "part_of"))
_WORDS = {"inside": "in", "off": "on", "in_front_of": "in front of", "left_of": "left of", "right_of": "right of",
          "beside": "next to", "part_of": "of", "other_than": "different from", "seen_by": "seen by",
          "held_by": "held by"}  # fmt: skip
PICKY = ("seen", "largest", "smallest")
"""The ways to choose that depend on what something is like."""
_AHEAD = 90.0  # degrees to either side


def without_relations(parts: Mapping[str, str]) -> dict[str, str]:
    """Return the parts that describe a thing by itself, without its name and without its relations to others."""
    return {name: text for name, text in parts.items() if not (name == "named" or name in RELATIONS or name in DENIED)}


def describe_relations(parts: Mapping[str, str]) -> str:
    """Return the words for the relations in the parts: ` on the table that isn't red`."""
    words = [
        f" {_WORDS.get(name, name)} {' and '.join(map(_describe_thing, text.split(SECOND)))}"
        for name, text in parts.items()
        if name in RELATIONS
    ]
    words += [f" that isn't {' or '.join(text.split('; '))}" for name, text in parts.items() if name in DENIED]
    return "".join(words)


def _describe_thing(value: str) -> str:
    head, *filters = value.split("; ")
    before, behind = "", ""
    for each in filters:
        name, _, of = each.partition(" ")
        if name == "owner":
            behind = f" of {of}{behind}"
        elif name in RELATIONS:
            behind += f" {_WORDS.get(name, name)} {said(of)}"
        else:
            before += f"{'non-' if name in DENIED else ''}{of} "
    noun = head.removeprefix("kind ")
    return (f"the {before}{noun}" if before or noun != head else said(noun)) + behind


class Relations:
    """The relations between the things of one world.

    `things` are its objects and people, `where` returns the point of a name. `is_seen` returns whether the robot has a
    name in view from a pose, `holder` who holds it.
    """

    def __init__(
        self,
        world: World,
        things: Mapping[str, Thing],
        where: Callable[[str], Point | None],
        is_seen: Callable[[str, Pose], bool],
        holder: Callable[[str], str],
    ) -> None:
        self._world, self._things, self._where = world, things, where
        self._is_seen, self._holder = is_seen, holder
        others = (*(door.name for door in world.doors), *(zone.name for zone in world.zones))
        self._places = [(place.name.lower(), place.name) for place in world.places]
        self._others = [(name.lower(), name) for name in others]

    def holds(self, name: str, parts: Mapping[str, str], pose: Pose) -> bool:
        """Return whether the relations of a thing are as the parts say, and nothing that they deny is true, from a
        pose.
        """
        for part, text in parts.items():
            if part == "named" and name.lower() != text.lower():
                return False
            if part in DENIED and self._is_like(name, DENIED[part], text.split("; ")):
                return False
            if part in RELATIONS and not self._is_so(name, part, text, pose):
                return False
        return True

    def _is_so(self, name: str, relation: str, value: str, pose: Pose) -> bool:
        if relation == "other_than" and value == SELF:
            return not self._is_here(name, pose)
        if relation == "other_than":
            return all(name not in self._meant(each, pose) for each in value.split(SECOND))
        if relation == "between":
            first, _, second = value.partition(SECOND)
            pairs = ((one, other) for one in self._meant(first, pose) for other in self._meant(second, pose))
            return any(self._is_between(name, one, other) for one, other in pairs)
        others = (other for each in value.split(SECOND) for other in self._meant(each, pose))
        return any(self._stands(name, relation, other, pose) for other in others)

    def _is_here(self, name: str, pose: Pose) -> bool:
        """Return whether the robot is at a place, or in the region of that name."""
        here, point = (pose.x, pose.y), self._point(name)
        region = next((zone for zone in self._world.zones if zone.name == name), None)
        return (region is not None and region.contains(here)) or (point is not None and dist(here, point) <= HERE)

    def _is_between(self, name: str, one: str, other: str) -> bool:
        points = [self._point(each) for each in (name, one, other)]
        if None in points or len({name, one, other}) < 3:
            return False
        point, start, end = points
        return segment_distance(point, (*start, *end)) <= BETWEEN * dist(start, end)  # type: ignore[arg-type,misc]

    def _is_like(self, name: str, part: str, values: list[str]) -> bool:
        wanted = {value.lower() for value in values}
        is_like = any(of == part and value in wanted for of, value in self._parts(name))
        return is_like or (part == "kind" and name.lower() in wanted)

    def _parts(self, name: str) -> Parts:
        """Return the parts that a thing or a place can be described by."""
        if name in self._things:
            return self._things[name].parts
        return next((place.parts for place in self._world.places if place.name == name), ())

    def _meant(self, value: str, pose: Pose) -> Iterator[str]:
        """Return the names of the other side of a relation."""
        head, *filters = value.split("; ")
        likes = dict(each.split(" ", 1) for each in filters)
        if head.startswith("kind "):
            likes["kind"] = head.removeprefix("kind ")
            names = [name for name, thing in self._things.items() if isinstance(thing, WorldObject)]
        else:
            wanted = head.lower()
            known = (*self._places, *((name.lower(), name) for name in self._things), *self._others)
            names = [SELF] if head == SELF else list(dict.fromkeys(name for lower, name in known if lower == wanted))
        like = without_relations(likes)
        for name in names:
            thing = self._things.get(name)
            fits = not like or (thing.fits(like) if thing is not None else like.items() <= set(self._parts(name)))
            if fits and self.holds(name, {part: text for part, text in likes.items() if part not in like}, pose):
                yield name

    def _stands(self, name: str, relation: str, other: str, pose: Pose) -> bool:
        """Return whether a relation holds between two names. Raises RobotError if a map can't tell."""
        if relation in ("under", "above"):
            raise RobotError(f"I can't tell what is {relation} {said(other)}")
        if relation == "held_by":
            return self._holder(name) == other
        if relation == "seen_by":
            if other != SELF:
                raise RobotError(f"I can't tell what {said(other)} sees")
            return self._is_seen(name, pose)
        if other == SELF:
            return _is_beside(relation, self._point(name), pose)
        zone = next((zone for zone in self._world.zones if zone.name == other), None)
        one, point = self._point(name), self._point(other)
        if one is None or name == other:
            return False
        if zone is not None and relation in _TOGETHER:
            return zone.contains(one)
        if point is None:
            return False
        if relation in _TOGETHER:
            return self._is_at(one, other, point)
        if dist(one, point) > NEAR:
            return False
        if relation in ("near", "beside"):
            return True
        return _is_on_side(relation, one, point, pose)

    def _is_at(self, one: Point, other: str, point: Point) -> bool:
        """Return whether it is on or in a thing; at a place if no other place is nearer."""
        if other in self._things:
            size = getattr(self._things[other], "size", 0.0)
            return dist(one, point) <= max(_ON_THING, size)
        nearest = min(dist(one, (place.x, place.y)) for place in self._world.places)
        return dist(one, point) <= min(_AT_PLACE, nearest + 1e-9)

    def _point(self, name: str) -> Point | None:
        for door in self._world.doors:
            if door.name == name:
                return door.middle
        try:
            return self._where(name)
        except RobotError:
            zone = next((zone for zone in self._world.zones if zone.name == name), None)
            return None if zone is None else centre_of(zone.points)


def _is_beside(relation: str, point: Point | None, pose: Pose) -> bool:
    """Return whether a point is on that side of the robot, or near it."""
    if point is None:
        return False
    if relation in ("near", "beside"):
        return dist(point, (pose.x, pose.y)) <= NEAR
    return abs(wrap(pose.bearing_to(point) - _SIDES[relation])) <= _HALF_SIDE


def _is_on_side(relation: str, one: Point, point: Point, pose: Pose) -> bool:
    """Return whether the first point is on that side of the second one, seen from the pose of the robot."""
    sight = point[0] - pose.x, point[1] - pose.y
    offset = one[0] - point[0], one[1] - point[1]
    ahead = sight[0] * offset[0] + sight[1] * offset[1]
    left = sight[0] * offset[1] - sight[1] * offset[0]
    side = {"behind": ahead, "in_front_of": -ahead, "left_of": left, "right_of": -left}[relation]
    return side > 0 and side >= max(abs(ahead), abs(left)) - 1e-9


class Choices:
    """The choices of one run after the other; each run begins with its own seed.

    What is chosen depends on the seed and on how many random choices came before: so a run can go on elsewhere.
    """

    def __init__(self) -> None:
        self.seed = self._made = 0

    def begin(self, seed: int, made: int = 0) -> None:
        """Begin a run after so many random choices."""
        self.seed, self._made = seed, made

    def choose(
        self,
        kind: str,
        how: str,
        names: Sequence[str],
        parts: Mapping[str, str],
        on_event: OnEvent | None,
        distance: Callable[[str], float],
        size: Callable[[str], float],
        bearing: Callable[[str], float],
        by_name: bool = False,
    ) -> str:
        """Return the nearest of the names, a random one and so on. Raises RobotError if nothing has these parts.

        A number counts them from the nearest one on, or `by_name`.
        """
        if not names:
            raise RobotError(
                unseen(kind, parts, describe_relations(parts))
                if parts or how == "seen"
                else f"there's no {kind} to choose"
            )
        if how in ("nearest", "seen"):
            data: dict[str, str | int] = {"type": kind, "how": "nearest", "name": min(names, key=distance)}
        elif how == "furthest":
            data = {"type": kind, "how": how, "name": max(names, key=distance)}
        elif how in ("leftmost", "rightmost"):
            ahead = [name for name in names if abs(bearing(name)) <= _AHEAD] or names
            chosen = max(ahead, key=bearing) if how == "leftmost" else min(ahead, key=bearing)
            data = {"type": kind, "how": how, "name": chosen}
        elif number := ordinal(how):
            line = sorted(sorted(names, key=_natural), key=lambda name: 0.0 if by_name else distance(name))
            if abs(number) > len(line):
                raise RobotError(f"number {abs(number)} is asked for, but there's only {', '.join(line)}")
            data = {"type": kind, "how": nth(number), "name": line[number - 1 if number > 0 else number]}
        elif how in ("largest", "smallest"):
            chosen = max(names, key=size) if how == "largest" else min(names, key=size)
            data = {"type": kind, "how": how, "name": chosen}
        elif how == "random":
            data = {"type": kind, "how": how, "name": self._any(names), "seed": self.seed}
        else:
            raise RobotError(f"it can choose the nearest or a random {kind}, not by '{how}'")
        if on_event is not None:
            on_event("choose", data)
        return str(data["name"])

    def _any(self, names: Sequence[str]) -> str:
        from random import Random  # most missions need none

        self._made += 1
        return Random(f"{self.seed} {self._made}").choice(names)


def _natural(name: str) -> tuple[tuple[int, str], ...]:
    """Return a key that sorts `room 2` before `room 10`."""
    return tuple((int(part), "") if part.isdecimal() else (0, part) for part in re.split(r"(\d+)", name.lower()))
