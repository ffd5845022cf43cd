"""What a robot knows of its world, by name: what there is, where it is, and where to stand to open a door."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import hypot

from btlang.robots.geometry import Point, Pose, centre_of, edges, segment_distance, wrap
from btlang.robots.robot import OnEvent, RobotError
from btlang.robots.worlds.descriptions import PICKY, Choices, Relations, without_relations
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.sight import Sight
from btlang.robots.worlds.world import Door, FurnitureBox, Place, World, Zone, said
from btlang.robots.zones import Zones
from btlang.run.robot_state import Whereabouts
from btlang.vocabulary.references import SELF, ordinal

_BESIDE = 0.7  # metres from the middle of a door
_STEPS = 12  # parts of each side of a region, in the search for its middle


def spots_beside(door: Door, pose: Pose) -> list[Pose]:
    """Return the poses before and behind a door, facing it; the one nearer to the pose first."""
    (ax, ay), (bx, by), (x, y) = door.start, door.end, door.middle
    length = max(hypot(bx - ax, by - ay), 1e-9)
    across = -(by - ay) / length * _BESIDE, (bx - ax) / length * _BESIDE
    spots = [(x + side * across[0], y + side * across[1]) for side in (1, -1)]
    spots.sort(key=pose.distance_to)
    return [Pose(*spot, Pose(*spot).bearing_to((x, y))) for spot in spots]


def _middle(region: Zone, boxes: Iterable[FurnitureBox]) -> Point:
    """Return the point of a region, in no furniture, that is farthest from its border."""
    xs, ys = zip(*region.points, strict=True)
    steps = [number / _STEPS for number in range(1, _STEPS)]
    grid = [(min(xs) + i * (max(xs) - min(xs)), min(ys) + j * (max(ys) - min(ys))) for i in steps for j in steps]
    spots = [spot for spot in grid if region.contains(spot) and not any(box.contains(spot) for box in boxes)]
    border = [(*a, *b) for a, b in edges(region.points)]
    return max(
        spots,
        key=lambda spot: min(segment_distance(spot, segment) for segment in border),
        default=centre_of(region.points),
    )


class Knowledge:
    """The places, objects, people, doors and zones of a world, and people who come unexpected.

    Names may be in any case; unknown ones raise RobotError. Poses are those of the robot.
    """

    def __init__(self, world: World, obstacles: Obstacles, sight: Sight) -> None:
        self._given_world = world
        self.obstacles = obstacles
        self.zones = Zones(world.zones)
        self.sight = sight
        self._given_to: dict[str, str] = {}
        self._regions = {zone.name: zone for zone in world.regions}
        self._take(world)

    def name_places(self, places: Iterable[Place]) -> None:
        """Set the places of a mission, in addition to those of the world."""
        self._take(self._given_world.with_places(places))

    def _take(self, world: World) -> None:
        """Work out what follows from a world alone: conditions ask for it at each tick."""
        self.world, self.names = world, world.names
        self._spellings: dict[str, str] = {}
        self._places = {place.name: place for place in world.places}
        self._relations = Relations(world, self.obstacles.things, self.where, self.sight.sees, self._holder)

    def place(self, name: str) -> Place | None:
        """Return the place of a name as the world spells it; of a region the point that is farthest from its border."""
        if name not in self._places and name in self._regions:
            self._places[name] = Place(name, *_middle(self._regions[name], self.world.boxes))
        return self._places.get(name)

    def whereabouts(self) -> tuple[Whereabouts, ...]:
        """Return where walking people and unknown things are, to the centimetre, and whether they are in view."""
        raise NotImplementedError

    def known(self, name: str) -> str:
        """Return the name as the world spells it."""
        known = self._spellings.get(name)
        if known is None:
            names = self.names  # things are added meanwhile
            every = (*names.places, *names.regions, *names.objects, *names.people, *self.obstacles.things)
            known = next((known for known in every if known.lower() == name.lower()), None)
            if known is None:
                raise RobotError(f"I don't know where '{name}' is")
            self._spellings[name] = known
        return known

    def is_person(self, name: str) -> bool:
        """Return whether it is the name of a person."""
        return name in self.sight.names("person")

    def locate(self, name: str, pose: Pose) -> Point:
        """Return where it is; what the robot carries is where the robot is. Raises RobotError
        if it hasn't been seen.
        """
        return self.where(name) or (pose.x, pose.y)

    def where(self, name: str) -> Point | None:
        """Return where it is, like `locate`; None while the robot carries it."""
        known = self.known(name)
        place = self.place(known)
        if place is not None:
            return place.x, place.y
        if known in self._given_to:
            return self.where(self._given_to[known])
        point = self.sight.where(known)
        if point is None and not self.obstacles.is_carried(known):
            raise RobotError(f"I haven't seen {said(known)}")
        return point

    def free(self, kind: str) -> list[str]:
        """Return the names of a type whose position is known, without objects that are carried or fixed."""
        if kind not in ("object", "person"):
            return list(self.names.every(kind))
        things = self.obstacles.things
        names = (name for name in self.sight.names(kind) if self.sight.where(name) is not None)
        return [name for name in names if not getattr(things[name], "fixed", False)]

    def described(self, kind: str, parts: Mapping[str, str], pose: Pose) -> list[str]:
        """Return the names of a type with these parts whose position is known, or that are carried, nearest first."""
        things, where, like = self.obstacles.things, self.sight.where, without_relations(parts)
        if kind in ("object", "person"):
            every, named = self.sight.names(kind), parts.get("named", "").lower()
            if named:  # looked at first, as all else takes longer
                every = [name for name in every if name.lower() == named]
            known = (
                name
                for name in every
                if (where(name) and not self.sight.is_gone(name)) or self.obstacles.is_carried(name)
            )
            names = [name for name in known if name in things and (not like or things[name].fits(like))]
        else:
            places = self.world.places if kind == "place" else ()
            fitting = [place.name for place in places if set(like.items()) <= set(place.parts)]
            names = fitting if like else list(self.names.every(kind))
        if len(like) < len(parts):
            names = [name for name in names if self._relations.holds(name, parts, pose)]
        if len(names) < 2:
            return names
        return sorted(names, key=lambda name: pose.distance_to(self._spot(kind, name, pose)))

    def _spot(self, kind: str, name: str, pose: Pose) -> Point:
        return self.door(name).middle if kind == "door" else self.locate(name, pose)

    def _holder(self, name: str) -> str:
        """Return who holds a thing, SELF for the robot, "" for nobody."""
        return self._given_to.get(name) or (SELF if self.obstacles.is_carried(name) else "")

    def choose(
        self,
        kind: str,
        how: str,
        parts: Mapping[str, str],
        where: Callable[[], Pose],
        began: Callable[[], Pose],
        choices: Choices,
        on_event: OnEvent | None,
    ) -> str:
        """Return one of the names of a type. Raises RobotError if there is none with these parts.

        Places are counted from where the mission `began`, so that the third one stays the same.
        """
        listed = not parts and how not in PICKY
        pose = Pose(0.0, 0.0) if listed and how == "random" else where()
        start = began() if kind == "place" and ordinal(how) else pose
        names = self.free(kind) if listed else self.described(kind, parts, pose)
        if how == "seen":
            names = [name for name in self.sight.seen(kind, pose) if name in names] or names
        things = self.obstacles.things
        return choices.choose(
            kind, how, names, parts, on_event,
            lambda name: start.distance_to(self.locate(name, pose)), lambda name: getattr(things[name], "size", 0.0),
            lambda name: wrap(pose.bearing_to(self.locate(name, pose))), self.world.ordinals == "name",
        )  # fmt: skip

    def nearby_people(self, within: float, pose: Pose) -> list[str]:
        """Return the names of the people within so many metres, nearest first: of those who walk, the ones in view."""
        found = []
        for name in self.sight.names("person"):
            point = self.sight.where(name)
            if point is not None and self.sight.is_fresh(name) and pose.distance_to(point) <= within:
                found.append((pose.distance_to(point), name))
        return [name for _, name in sorted(found)]

    def give(self, name: str, person: str) -> None:
        """Note that a person has an object from now on."""
        self._given_to[name] = self.known(person)

    def check_free(self, name: str) -> None:
        """Raise RobotError for an object that somebody was given."""
        if name in self._given_to:
            raise RobotError(f"{said(self._given_to[name])} has {said(name)}")

    def check_movable(self, name: str) -> None:
        """Raise RobotError for an object that can't be picked up, or that the robot hasn't seen."""
        known = self.known(name)
        self.check_free(known)
        self.where(known)
        if getattr(self.obstacles.things.get(known), "fixed", False):
            raise RobotError(f"{said(known)} is fixed")

    def door(self, name: str) -> Door:
        """Return a door as it is now. Raises RobotError for an unknown one."""
        for door in self.obstacles.doors.values():
            if door.name.lower() == name.lower():
                return door
        raise RobotError(f"there's no door called '{name}'")

    def beside_door(self, name: str, pose: Pose) -> list[Pose]:
        """Return where a robot can stand to move a door, facing it: before and behind it, nearest first."""
        return spots_beside(self.door(name), pose)

    def _watched(self, where: Callable[[str], Point | None], is_seen: Callable[[str], bool]) -> tuple[Whereabouts, ...]:
        """Return where walking people and unknown things are, to the centimetre."""
        found: list[Whereabouts] = []
        for name in self.sight.watched:
            point = where(name)
            x, y = (None, None) if point is None else (round(point[0], 2), round(point[1], 2))
            found.append((name, x, y, is_seen(name)))
        return tuple(found)
