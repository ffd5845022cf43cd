"""What else the map of a world shows: zones, doors and the routes of people."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import hypot

from btlang.robots.geometry import Point, edges
from btlang.robots.worlds.world import Door, Person, World, Zone

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface

_CLOSED_ZONE, _SLOW_ZONE = "#c0440c", "#9a6a00"
DOOR_COLOUR, _ROUTE = "#2f6f8f", "#cc79a7"
_GAP, _HATCH = 5.0, 7.0  # points between the dots of a route, and between the lines of a zone

At = Callable[[float, float], tuple[float, float]]
"""Points of the canvas, of metres."""


def draw_zones(canvas: Surface, world: World, at: At) -> None:
    """Slow zones in yellow; those to keep out of in red and hatched."""
    for zone in world.zones:
        corners = [at(*point) for point in zone.points]
        if zone.is_closed:
            canvas.polygon(corners, fill="#fbdccb", edge=_CLOSED_ZONE, line=0.9)
            for line in hatching(corners, _HATCH):
                canvas.line(line, colour=_CLOSED_ZONE, line=0.5, round=False)
        else:
            canvas.polygon(corners, fill="#fff3c4", edge=_SLOW_ZONE, line=0.9)


def zone_colour(zone: Zone) -> str:
    """Of its name."""
    return _CLOSED_ZONE if zone.is_closed else _SLOW_ZONE


def middle_of(zone: Zone) -> Point:
    """A point in the zone for its name: the middle of its corners."""
    xs, ys = [x for x, _ in zone.points], [y for _, y in zone.points]
    return sum(xs) / len(xs), sum(ys) / len(ys)


def hatching(corners: Sequence[Point], step: float) -> list[list[Point]]:
    """Lines that rise to the right, so far apart, where they are in a polygon."""
    found = []
    sums = [x + y for x, y in corners]
    along = (int(min(sums) // step) + 1) * step
    while along < max(sums):
        crossings = []
        for (ax, ay), (bx, by) in edges(corners):
            a, b = ax + ay - along, bx + by - along
            if (a > 0) != (b > 0):
                share = a / (a - b)
                crossings.append((ax + share * (bx - ax), ay + share * (by - ay)))
        crossings.sort()
        found += [list(pair) for pair in zip(crossings[::2], crossings[1::2], strict=True)]
        along += step
    return found


def draw_door(canvas: Surface, door: Door, at: At, middle: Point) -> None:
    """Closed a bar in the wall; open its leaf, at a right angle to the wall, towards the middle of the canvas."""
    start, end = at(*door.start), at(*door.end)
    if not door.open:
        canvas.line([start, end], colour="white", line=4.2, round=False)
        canvas.line([start, end], colour=DOOR_COLOUR, line=3.0, round=False)
        return
    across, down = start[1] - end[1], end[0] - start[0]
    leaves = ((start[0] + side * across, start[1] + side * down) for side in (1, -1))
    leaf = min(leaves, key=lambda leaf: hypot(leaf[0] - middle[0], leaf[1] - middle[1]))
    canvas.line([start, end], colour=DOOR_COLOUR, line=0.7, dashed=True)
    canvas.line([start, leaf], colour=DOOR_COLOUR, line=2.0, round=False)


def draw_route(canvas: Surface, person: Person, at: At) -> None:
    """Dots from where somebody begins to each stop, and back to the first one where the route is walked again."""
    stops = [(person.x, person.y), *((stop.x, stop.y) for stop in person.walks)]
    if person.again and len(stops) > 2:
        stops.append(stops[1])
    for a, b in pairwise([at(*stop) for stop in stops]):
        steps = max(int(hypot(b[0] - a[0], b[1] - a[1]) / _GAP), 1)
        for step in range(1, steps + 1):
            share = step / steps
            canvas.circle(a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, 0.9, fill=_ROUTE)
    for stop in stops[1:]:
        canvas.circle(*at(*stop), 2.2, fill="white", edge=_ROUTE, line=0.9)
