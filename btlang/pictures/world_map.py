"""The world from above: walls, furniture, places, people and things, with their names."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping

from btlang.pictures import letters
from btlang.pictures.placing import Area, Placer, along
from btlang.pictures.style import INK, SMALL, SOFT
from btlang.pictures.world_details import (
    DOOR_COLOUR,
    draw_door,
    draw_route,
    draw_zones,
    middle_of,
    zone_colour,
)
from btlang.robots.geometry import Point
from btlang.robots.worlds.world import Thing, World

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface

_WALL, _FURNITURE, _FLOOR = "#3d4750", "#d9d2c5", "#fafaf7"
_PLACE, _PERSON, OBJECT = "#5b6b7a", "#cc79a7", "#7a4f9e"
_LARGEST = 110.0  # points a metre
_ROUND = 0.35  # metres around everything
_LEAST = (4.0, 2.5)  # metres that a map shows
_LONGEST_NAME = 110.0


class WorldMap:
    """Draws on a canvas within `room`; `area` is what it takes of it. The world is scaled to fit.

    `track` are further points that have to be on the map.
    """

    def __init__(self, world: World, room: Area, track: Iterable[Point] = ()) -> None:
        self._world = world
        points = [(world.start.x, world.start.y), *track, *(point for wall in world.walls for point in wall)]
        points += [edge[:2] for box in world.boxes for edge in box.edges()]
        points += [(place.x, place.y) for place in world.places]
        points += [(thing.x, thing.y) for thing in (*world.objects, *world.people)]
        points += [(stop.x, stop.y) for person in world.people for stop in person.walks]
        points += [point for zone in world.zones for point in zone.points]
        points += [point for door in world.doors for point in (door.start, door.end)]
        xs, ys = [x for x, _ in points], [y for _, y in points]
        width = max(max(xs) - min(xs) + 2 * _ROUND, _LEAST[0])
        height = max(max(ys) - min(ys) + 2 * _ROUND, _LEAST[1])
        left, low = (max(xs) + min(xs) - width) / 2, (max(ys) + min(ys) - height) / 2
        self.scale = min(room.width / width, room.height / height, _LARGEST)
        self.area = Area(room.x, room.y, width * self.scale, height * self.scale)
        self._left, self._top = left, low + height

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Points of the canvas, of metres."""
        return self.area.x + (x - self._left) * self.scale, self.area.y + (self._top - y) * self.scale

    def draw(self, canvas: Surface, walked: Container[str] = ()) -> None:
        """The floor, zones, walls, doors and furniture, and a ring and the route of each person.

        The rings of those who have `walked` away are dashed.
        """
        world, s = self._world, self.scale
        canvas.box(self.area.x, self.area.y, self.area.width, self.area.height, round=4, fill=_FLOOR)
        draw_zones(canvas, world, self.at)
        for box in world.boxes:
            x, y = self.at(box.x - box.width / 2, box.y + box.height / 2)
            canvas.box(x, y, box.width * s, box.height * s, round=1.5, fill=_FURNITURE, edge="#b3aa98", line=0.8)
        for wall in world.walls:
            canvas.line([self.at(*point) for point in wall], colour=_WALL, line=2.6)
        for door in world.doors:
            draw_door(canvas, door, self.at, self.area.middle)
        for person in world.people:
            draw_route(canvas, person, self.at)
        for person in world.people:
            x, y = self.at(person.x, person.y)
            if person.name in walked:
                canvas.circle(x, y, person.radius * s, fill="white", edge=_PERSON, dashed=True)
                continue
            canvas.circle(x, y, person.radius * s, fill="#f3dcea", edge=_PERSON)
            canvas.circle(x, y, max(person.radius * s * 0.45, 2.0), fill=_PERSON)

    def draw_names(self, canvas: Surface, placer: Placer, moved: Mapping[str, Point | None] = {}) -> None:
        """Marks and names of what is in the world; `moved` says where objects lie in the end."""
        for zone in self._world.zones:
            x, y = self.at(*middle_of(zone))
            text = letters.clipped(letters.shown(zone.name), _LONGEST_NAME, SMALL)
            canvas.text(x, y, text, size=SMALL, colour=zone_colour(zone), align="center", halo=True, z=1.5)
            width = letters.width(text, SMALL)
            placer.taken.append(Area(x - width / 2, y - SMALL / 2, width, SMALL))
        for place in self._world.places:
            x, y = self.at(place.x, place.y)
            if place in self._world.all_docks:
                canvas.box(x - 5, y - 5, 10, 10, round=2.5, fill="#ffe08a", edge="#8a6d00", line=0.9, z=3)
                canvas.text(x, y, "⚡", size=8, colour="#5c4900", align="center", z=3)
                placer.taken.append(Area(x - 5, y - 5, 10, 10))
            else:
                canvas.polygon([(x - 3.2, y), (x, y - 3.2), (x + 3.2, y), (x, y + 3.2)], fill="white", edge=_PLACE, z=3)
                placer.taken.append(Area(x - 3, y - 3, 6, 6))
        for place in self._world.places:
            self._name(canvas, placer, place.name, self.at(place.x, place.y), _PLACE, 6.5)
        for person in self._world.people:
            radius = person.radius * self.scale
            x, y = self.at(person.x, person.y)
            placer.taken.append(Area(x - radius, y - radius, 2 * radius, 2 * radius))
            self._name(canvas, placer, person.name, (x, y), "#9c3f74", radius + 1.5)
        for thing in self._world.objects:
            self._object(canvas, placer, thing, moved)
        for door in self._world.doors:
            self._name(canvas, placer, door.name, self.at(*door.middle), DOOR_COLOUR, 4.0)

    def _object(self, canvas: Surface, placer: Placer, thing: Thing, moved: Mapping[str, Point | None]) -> None:
        radius = max(thing.radius * self.scale, 2.6)
        x, y = self.at(thing.x, thing.y)
        if thing.name in moved:
            canvas.circle(x, y, radius, fill="white", edge=OBJECT, line=0.8, dashed=True)
            placer.taken.append(Area(x - radius, y - radius, 2 * radius, 2 * radius))
            self._name(canvas, placer, thing.name, (x, y), SOFT, radius + 1.5)
            place = moved[thing.name]
            if place is None:
                return
            x, y = self.at(*place)
        canvas.circle(x, y, radius, fill=OBJECT, edge="white", line=0.6, z=4)
        placer.taken.append(Area(x - radius, y - radius, 2 * radius, 2 * radius))
        self._name(canvas, placer, thing.name, (x, y), OBJECT, radius + 1.5)

    def _name(
        self, canvas: Surface, placer: Placer, name: str, at: tuple[float, float], colour: str, gap: float
    ) -> None:
        text = letters.clipped(letters.shown(name), _LONGEST_NAME, SMALL)
        area, _ = placer.place(*at, letters.width(text, SMALL), SMALL + 1, gap)
        x, y = area.middle
        canvas.text(x, y, text, size=SMALL, colour=colour, align="center", halo=True, z=3)

    def lines(self) -> list[tuple[float, float]]:
        """Points on all walls, for labels to keep away from."""
        return [point for wall in self._world.walls for point in along([self.at(*p) for p in wall], 5.0)]

    def draw_scale(self, canvas: Surface, x: float, y: float) -> float:
        """A bar of a round length; returns the width that it takes."""
        metres = next(m for m in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 1e9) if m * self.scale >= 40)
        length, text = metres * self.scale, f"{metres:g} m"
        if length > 200:  # a world of one point
            return 0.0
        canvas.line([(x, y - 3), (x, y), (x + length, y), (x + length, y - 3)], colour=INK, line=1.1)
        canvas.text(x + length + 5, y - 2, text, size=SMALL, colour=SOFT)
        return length + 5 + letters.width(text, SMALL)
