"""People on pictures of runs: the ways that they walked, and where they are at a moment."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise
from math import dist

from btlang.pictures import letters
from btlang.pictures.placing import Area, Placer, along
from btlang.pictures.run_record import RunRecord, Sighting
from btlang.pictures.style import SMALL
from btlang.pictures.world_map import OBJECT, WorldMap
from btlang.robots.geometry import Point
from btlang.robots.worlds.world import PERSON_RADIUS, World

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface

WALKED, PERSON = "#9c3f74", "#cc79a7"
"""The colours of ways, and of people whom the robot sees."""
_LEAST = 0.1  # metres; who moved less has no way
_JUMP = 1.0  # metres between two looks that nobody walks
_LONGEST_NAME = 110.0


def ways(sightings: Sequence[Sighting]) -> list[list[Point]]:
    """The ways that somebody walked, one for each time that he or she was there."""
    found: list[list[Point]] = [[]]
    for each in sightings:
        point = each.point
        if point is None or (found[-1] and dist(found[-1][-1], point) > _JUMP):
            found.append([])
        if point is not None:
            found[-1].append(point)
    return [way for way in found if sum(dist(a, b) for a, b in pairwise(way)) > _LEAST]


def sighting_at(sightings: Sequence[Sighting], t: float) -> Sighting:
    """Where somebody was at a time, between two looks too; before the first one as in that."""
    after = bisect_right(sightings, t, key=lambda each: each.t)
    if after == 0 or after == len(sightings):
        return sightings[min(after, len(sightings) - 1)]
    a, b = sightings[after - 1], sightings[after]
    if a.point is None or b.point is None or dist(a.point, b.point) > _JUMP:
        return a
    share = (t - a.t) / (b.t - a.t)
    (ax, ay), (bx, by) = a.point, b.point
    return Sighting(t, (ax + (bx - ax) * share, ay + (by - ay) * share), a.seen)


def place_of(world: World, record: RunRecord, name: str, t: float) -> Point | None:
    """Where a person was at a time, None for who wasn't there, or isn't known by that name."""
    if name in record.sightings:
        return sighting_at(record.sightings[name], t).point
    return next(((person.x, person.y) for person in world.people if person.name == name), None)


def draw_walks(canvas: Surface, map: WorldMap, record: RunRecord, world: World, placer: Placer) -> None:
    """Thin dotted lines along the ways of people, with a disc where they are in the end, or a cross where they left."""
    for name, sightings in record.sightings.items():
        if name in world.names.objects:
            continue
        for way in ways(sightings):
            points = [map.at(*point) for point in way]
            canvas.line(points, colour="white", line=2.6, z=0.9)
            canvas.line(points, colour=WALKED, line=0.9, dashed=True, round=False, z=1.0)
            placer.avoid(along(points, 4.0))
            x, y = points[-1]
            if sightings[-1].point is None or way[-1] != sightings[-1].point:
                for side in (-3, 3):
                    canvas.line([(x - 3, y - side), (x + 3, y + side)], colour=WALKED, line=1.4, z=2)
            else:
                canvas.circle(x, y, PERSON_RADIUS * map.scale, fill="#f3dcea", edge=WALKED, line=1.2, z=2)
                canvas.circle(x, y, 2.4, fill=WALKED, z=2)
            placer.taken.append(Area(x - 4, y - 4, 8, 8))


def name_walks(canvas: Surface, map: WorldMap, record: RunRecord, world: World, placer: Placer) -> None:
    """The names of those who walked, at the ends of their ways."""
    for name, sightings in record.sightings.items():
        walked = [] if name in world.names.objects else ways(sightings)
        if walked:
            text = letters.clipped(letters.shown(name), _LONGEST_NAME, SMALL)
            at = map.at(*walked[-1][-1])
            area, _ = placer.place(*at, letters.width(text, SMALL), SMALL + 1, PERSON_RADIUS * map.scale + 1.5)
            canvas.text(*area.middle, text, size=SMALL, colour=WALKED, align="center", halo=True, z=3)


def draw_standing(canvas: Surface, map: WorldMap, world: World, name: str, sighting: Sighting) -> None:
    """Somebody or something with its name: a disc where the robot sees it, else a ring."""
    if sighting.point is None:
        return
    known = {thing.name: thing.radius for thing in (*world.objects, *world.people)}
    colours = (OBJECT, OBJECT) if name in world.names.objects else (PERSON, WALKED)
    x, y = map.at(*sighting.point)
    radius = max(known.get(name, PERSON_RADIUS) * map.scale, 2.6)
    canvas.circle(x, y, radius, fill=colours[0] if sighting.seen else "white", edge=colours[1], line=1.2, z=5)
    text = letters.clipped(letters.shown(name), _LONGEST_NAME, SMALL)
    canvas.text(x + radius + 3, y, text, size=SMALL, colour=colours[1], halo=True, z=5)
