"""The way of the robot and of people on the map, from light to dark as time passes."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise
from math import atan2, cos, dist, hypot, pi, sin

from btlang.pictures import letters
from btlang.pictures.run_record import RunRecord, Sighting
from btlang.pictures.surface import SMALL
from btlang.pictures.world_map import OBJECT, Area, Placer, WorldMap, along
from btlang.robots.geometry import Point, Pose
from btlang.robots.worlds.world import PERSON_RADIUS, World

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface


START, END = ("white", "#1f4e79"), ("#f2b134", "#5c3d00")
"""The fill and edge of the robot's body."""
_COLOURS = ((0.62, 0.79, 0.93), (0.03, 0.19, 0.42))
_ARROWS = 60.0  # points between two
_STEP = 3.0  # points; the way is drawn in pieces no shorter


def way(record: RunRecord) -> list[Point]:
    """Return all places where the robot was, in metres, without those where it stood still."""
    points: list[Point] = []
    for sample in record.track:
        point = (sample.pose.x, sample.pose.y)
        if not points or points[-1] != point:
            points.append(point)
    return points


def draw_track(canvas: Surface, map: WorldMap, record: RunRecord) -> list[tuple[float, float]]:
    """Draw the way with arrow heads; return its points on the canvas."""
    points: list[tuple[float, float]] = []
    for place in way(record):
        x, y = map.at(*place)
        if not points or hypot(x - points[-1][0], y - points[-1][1]) >= _STEP:
            points.append((x, y))
    if len(points) < 2:
        return points
    pieces = list(pairwise(points))
    shades = [shade(i / max(1, len(pieces) - 1)) for i in range(len(pieces))]
    canvas.line(points, colour="white", line=3.6, z=1.1)
    canvas.draw_shaded(points, shades, line=2, z=1.2)
    gone = _ARROWS / 2
    for ((ax, ay), (bx, by)), colour in zip(pieces, shades, strict=True):
        gone += hypot(bx - ax, by - ay)
        if gone >= _ARROWS:
            gone = 0.0
            _arrow(canvas, bx, by, atan2(by - ay, bx - ax), colour)
    return points


def draw_body(canvas: Surface, map: WorldMap, pose: Pose, radius: float, look: tuple[str, str], z: float) -> None:
    """Draw the round robot with a line to where it looks."""
    x, y = map.at(pose.x, pose.y)
    fill, edge = look
    size = max(radius * map.scale, 4.0)
    canvas.circle(x, y, size, fill=fill, edge=edge, line=1.2, dashed=look is START, z=z)
    angle = pose.heading * pi / 180
    canvas.line([(x, y), (x + size * cos(angle), y - size * sin(angle))], colour=edge, line=1.4, z=z)


def shade(share: float) -> str:
    """Return the colour of the way after a share of its length."""
    (r, g, b), (r2, g2, b2) = _COLOURS
    mixed = (r + (r2 - r) * share, g + (g2 - g) * share, b + (b2 - b) * share)
    return "#" + "".join(f"{round(part * 255):02x}" for part in mixed)


def _arrow(canvas: Surface, x: float, y: float, angle: float, colour: str) -> None:
    corners = [(x + 5.6 * cos(angle + turn), y + 5.6 * sin(angle + turn)) for turn in (0.0, 2.45, -2.45)]
    canvas.polygon(corners, fill=colour, edge="white", line=0.7, z=1.3)


WALKED, PERSON = "#9c3f74", "#cc79a7"
"""The colours of ways, and of people whom the robot sees."""
_LEAST = 0.1  # metres; who moved less has no way
_JUMP = 1.0  # metres between two looks that nobody walks
_LONGEST_NAME = 110.0


def ways(sightings: Sequence[Sighting]) -> list[list[Point]]:
    """Return the ways that somebody walked, one for each time that he or she was there."""
    found: list[list[Point]] = [[]]
    for each in sightings:
        point = each.point
        if point is None or (found[-1] and dist(found[-1][-1], point) > _JUMP):
            found.append([])
        if point is not None:
            found[-1].append(point)
    return [way for way in found if sum(dist(a, b) for a, b in pairwise(way)) > _LEAST]


def sighting_at(sightings: Sequence[Sighting], t: float) -> Sighting:
    """Return where somebody was at a time, between two looks too; before the first one as in that."""
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
    """Return where a person was at a time, None for who wasn't there, or isn't known by that name."""
    if name in record.sightings:
        return sighting_at(record.sightings[name], t).point
    return next(((person.x, person.y) for person in world.people if person.name == name), None)


def draw_walks(canvas: Surface, map: WorldMap, record: RunRecord, world: World, placer: Placer) -> None:
    """Draw thin dotted lines along the ways of people, with a disc where they are in the end, or a cross where they
    left.
    """
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
    """Write the names of those who walked, at the ends of their ways."""
    for name, sightings in record.sightings.items():
        walked = [] if name in world.names.objects else ways(sightings)
        if walked:
            text = letters.clip_text(letters.make_printable(name), _LONGEST_NAME, SMALL)
            at = map.at(*walked[-1][-1])
            area, _ = placer.place(*at, letters.width(text, SMALL), SMALL + 1, PERSON_RADIUS * map.scale + 1.5)
            canvas.text(*area.middle, text, size=SMALL, colour=WALKED, align="center", halo=True, z=3)


def draw_standing(canvas: Surface, map: WorldMap, world: World, name: str, sighting: Sighting) -> None:
    """Draw somebody or something with its name: a disc where the robot sees it, else a ring."""
    if sighting.point is None:
        return
    known = {thing.name: thing.radius for thing in (*world.objects, *world.people)}
    colours = (OBJECT, OBJECT) if name in world.names.objects else (PERSON, WALKED)
    x, y = map.at(*sighting.point)
    radius = max(known.get(name, PERSON_RADIUS) * map.scale, 2.6)
    canvas.circle(x, y, radius, fill=colours[0] if sighting.seen else "white", edge=colours[1], line=1.2, z=5)
    text = letters.clip_text(letters.make_printable(name), _LONGEST_NAME, SMALL)
    canvas.text(x + radius + 3, y, text, size=SMALL, colour=colours[1], halo=True, z=5)
