"""A run as a moving picture: the robot drives, its way grows, and the commands under way stand above."""

from __future__ import annotations

import io
from bisect import bisect_right
from math import ceil

from btlang.pictures import letters
from btlang.pictures.canvas import Canvas
from btlang.pictures.run_record import PathSample, PictureMark, RunRecord, outcome
from btlang.pictures.surface import BUBBLES, INK, SMALL, SOFT, TITLE
from btlang.pictures.track import END, PERSON, WALKED, draw_body, draw_standing, place_of, sighting_at, way
from btlang.pictures.world_map import DOOR_COLOUR, OBJECT, Area, Placer, WorldMap, along, draw_door, draw_route
from btlang.robots.geometry import Point, Pose, wrap
from btlang.robots.worlds.world import PERSON_RADIUS, World

TYPE_CHECKING = False
if TYPE_CHECKING:
    from PIL.Image import Image

FRAMES = 140
_EACH, _LAST = 90, 2500  # milliseconds that a frame is shown, and the last one
_LEAST = 0.25  # seconds of the mission between two frames, at least
_COLOURS = 96
_SMALL_COLOURS, _SWATCH = (END[0], PERSON, WALKED, OBJECT, DOOR_COLOUR), 60
_DPI = 90
_MARGIN, _HEAD = 10.0, 48.0
_LINE = 30.0  # of the commands under way, below the title
_ROOM = Area(_MARGIN, _HEAD, 540.0, 420.0)
_BLUE = "#2a6fb0"
_SPOKEN = 10  # frames that a text is shown, at least


def animate(world: World, record: RunRecord, title: str) -> bytes:
    """Return the bytes of a GIF of at most 140 frames that runs for ever."""
    from PIL.Image import Dither

    frames = _Film(world, record, title).frames()
    palette = _palette(frames)
    flat = [frame.quantize(palette=palette, dither=Dither.NONE) for frame in frames]
    out = io.BytesIO()
    durations = [_EACH] * (len(flat) - 1) + [_LAST]
    flat[0].save(out, "GIF", save_all=True, append_images=flat[1:], duration=durations, loop=0, optimize=False)
    return out.getvalue()


def _palette(frames: list[Image]) -> Image:
    """Return colours of the whole film, from some of its frames one below the other."""
    from PIL import Image

    chosen = [*frames[:: max(1, len(frames) // 8)], frames[-1]]
    width, height = chosen[0].size
    strip = Image.new("RGB", (width, height * len(chosen) + _SWATCH))
    for number, frame in enumerate(chosen):
        strip.paste(frame, (0, number * height))
    for number, colour in enumerate(_SMALL_COLOURS):  # which a few pixels have
        strip.paste(colour, (number * _SWATCH, height * len(chosen), (number + 1) * _SWATCH, strip.height))
    return strip.quantize(_COLOURS)


class _Film:
    """A film of a run.

    What stands still is drawn once; onto it the way grows; robot, things and text are redrawn on each frame.
    """

    def __init__(self, world: World, record: RunRecord, title: str) -> None:
        self._record = record
        self._times = [sample.t for sample in record.track]
        self._things = {thing.name: thing for thing in world.objects if thing.name in record.moved}
        self._world = world
        self._swung = [door for door in world.doors if any(name == door.name for _, name, _ in record.doors)]
        moving = {*record.moved, *record.sightings}
        still = world.replace(
            objects=tuple(thing for thing in world.objects if thing.name not in moving),
            people=tuple(person for person in world.people if person.name not in moving),
            doors=tuple(door for door in world.doors if door not in self._swung),
        )
        extent = [*way(record), *((thing.x, thing.y) for thing in self._things.values())]
        extent += [each.point for known in record.sightings.values() for each in known if each.point is not None]
        extent += [point for door in self._swung for point in (door.start, door.end)]
        self._map = WorldMap(still, _ROOM, extent)
        area = self._map.area
        self._canvas = Canvas(max(area.width, 300.0) + 2 * _MARGIN, area.y + area.height + _MARGIN, title)
        text = letters.clip_text(title, self._canvas.width - 2 * _MARGIN - 4, SMALL)
        self._canvas.text(_MARGIN + 2, 12, text, size=SMALL, colour=SOFT)
        self._map.draw(self._canvas)
        for person in world.people:
            if person.name in moving:
                draw_route(self._canvas, person, self._map.at)
        placer = Placer(area)
        placer.avoid(along([self._map.at(*place) for place in way(record)], 4.0))
        self._map.draw_names(self._canvas, placer)
        self._canvas.begin_film(_DPI)

    def frames(self) -> list[Image]:
        """Yield all frames, the last one with the outcome."""
        end = self._times[-1]
        number = min(FRAMES - 1, max(1, ceil(end / _LEAST)))
        film = [self._frame(end * (i - 1) / number, end * i / number) for i in range(number + 1)]
        return [*film, self._frame(end, end, last=True)]

    def _frame(self, before: float, now: float, last: bool = False) -> Image:
        from PIL import Image

        self._canvas.restore()
        self._grow(max(before, 0.0), now)
        sample = self._sample(now)
        self._things_at(now, sample.pose)
        self._surroundings_at(now)
        draw_body(self._canvas, self._map, sample.pose, self._record.radius, END, 6)
        self._speech(now, sample.pose, (now - before) * _SPOKEN)
        self._answers(now, sample.pose, (now - before) * _SPOKEN)
        self._headline(before, now, sample, last)
        self._canvas.lay()
        size, pixels = self._canvas.pixels()
        return Image.frombytes("RGBA", size, pixels).convert("RGB")

    def _grow(self, before: float, now: float) -> None:
        """Draw the way since the last frame, which stays for all frames to come."""
        first, last = bisect_right(self._times, before), bisect_right(self._times, now)
        poses = [self._sample(before).pose, *(s.pose for s in self._record.track[first:last]), self._sample(now).pose]
        points = [self._map.at(pose.x, pose.y) for pose in poses]
        if len(set(points)) > 1:
            self._canvas.line(points, colour=_BLUE, line=2)
        for command in self._record.commands:
            if before < command.start.t <= now or (now == 0 and command.start.t == 0):
                x, y = self._map.at(command.start.pose.x, command.start.pose.y)
                self._canvas.circle(x, y, 2.2, fill=INK, edge="white", line=0.6)
        for mark in self._record.marks:
            if mark.kind == "bump" and before < mark.t <= now:
                x, y = self._map.at(*mark.pose.ahead(self._record.radius))
                self._canvas.text(x, y, "✱", size=11, colour="#c0440c", align="center", bold=True)
        self._canvas.lay()
        self._canvas.keep()

    def _things_at(self, now: float, pose: Pose) -> None:
        """Draw objects that move: where they lie, or in front of the robot that carries them."""
        places: dict[str, Point | None] = {name: (thing.x, thing.y) for name, thing in self._things.items()}
        places |= {name: place for t, name, place in self._record.moves if t <= now}
        for name, place in places.items():
            if name not in self._things:
                continue
            x, y = self._map.at(*(place or pose.ahead(self._record.radius)))
            radius = max(self._things[name].radius * self._map.scale, 2.6)
            self._canvas.circle(x, y, radius, fill=OBJECT, edge="white", line=0.6, z=7)
            if place is not None:
                text = letters.clip_text(letters.make_printable(name), 100, SMALL)
                self._canvas.text(x + radius + 2, y, text, size=SMALL, colour=OBJECT, halo=True, z=5)

    def _surroundings_at(self, now: float) -> None:
        """Draw people and unknown things where they are, and doors as they are."""
        for name, sightings in self._record.sightings.items():
            if name not in self._record.moved:
                draw_standing(self._canvas, self._map, self._world, name, sighting_at(sightings, now))
        for door in self._swung:
            is_open = {name: opened for t, name, opened in self._record.doors if t <= now}.get(door.name, door.open)
            draw_door(self._canvas, door.replace(open=is_open), self._map.at, self._map.area.middle)
            x, y = self._map.at(*door.middle)
            text = letters.clip_text(letters.make_printable(door.name), 100, SMALL)
            self._canvas.text(x + 5, y, text, size=SMALL, colour=DOOR_COLOUR, halo=True, z=3)

    def _speech(self, now: float, pose: Pose, least: float) -> None:
        """Draw what the robot says, above it; what it last said stays for some frames."""
        mark = self._latest(("say", "print", "ask", "call"), now, least)
        if mark is not None:
            self._bubble(mark, (pose.x, pose.y), self._record.radius)

    def _answers(self, now: float, pose: Pose, least: float) -> None:
        """Draw what the robot hears, at whoever says it."""
        mark = self._latest(("hear",), now, least)
        if mark is not None:
            speaker = place_of(self._world, self._record, mark.who, now)
            self._bubble(mark, speaker or (pose.x, pose.y), -self._record.radius if speaker is None else PERSON_RADIUS)

    def _latest(self, kinds: tuple[str, ...], now: float, least: float) -> PictureMark | None:
        """Return what was said last, as long as it is shown."""
        said = [mark for mark in self._record.marks if mark.kind in kinds and mark.text and mark.t <= now]
        return said[-1] if said and now <= said[-1].t + max(least, 0.35 + 0.06 * len(said[-1].text)) else None

    def _bubble(self, mark: PictureMark, place: Point, radius: float) -> None:
        """Draw a bubble above a place, or below it where there is no room, or for a negative radius."""
        text = letters.clip_text(letters.make_printable(mark.text), 180, SMALL)
        fill, edge = BUBBLES.get(mark.kind, BUBBLES["say"])
        width = letters.width(text, SMALL) + 12
        x, y = self._map.at(*place)
        area, away = self._map.area, abs(radius) * self._map.scale
        left = min(max(x - width / 2, area.x), area.x + max(area.width - width, 0))
        top = y - away - 24
        if top < area.y or radius < 0:
            top = y + away + 9
        self._canvas.polygon([(x - 3, top + 8), (x + 3, top + 8), (x, y)], fill=fill, edge=edge, line=0.7, z=8)
        self._canvas.box(left, top, width, 15, round=5, fill=fill, edge=edge, line=0.8, z=8)
        self._canvas.text(left + 6, top + 7.5, text, size=SMALL, z=8)

    def _headline(self, before: float, now: float, sample: PathSample, last: bool) -> None:
        right = self._canvas.width - _MARGIN
        clock = f"{now:.1f} s   ·   battery {sample.battery:.0f} %"
        self._canvas.text(right, _LINE, clock, size=SMALL, colour=SOFT, align="right", z=9)
        room = right - _MARGIN - 130
        colour, title = INK, self._title(before, now)
        if last:
            look, words = outcome(self._record)
            colour, title = look.strong, f"{look.sign} {words}"
        title = letters.clip_text(letters.make_printable(title), room, TITLE, True)
        self._canvas.text(_MARGIN + 2, _LINE, title, size=TITLE, bold=True, colour=colour, z=9)

    def _title(self, before: float, now: float) -> str:
        under_way = [c.text for c in self._record.commands if c.start.t <= now and (c.end > now or c.start.t > before)]
        return "  and  ".join(dict.fromkeys(under_way))

    def _sample(self, t: float) -> PathSample:
        """Return where the robot was, between two samples too."""
        track = self._record.track
        after = bisect_right(self._times, t)
        if after == 0 or after == len(track):
            return track[min(after, len(track) - 1)]
        a, b = track[after - 1], track[after]
        share = (t - a.t) / (b.t - a.t)
        p, q = a.pose, b.pose
        heading = p.heading + wrap(q.heading - p.heading) * share
        pose = Pose(p.x + (q.x - p.x) * share, p.y + (q.y - p.y) * share, heading)
        return PathSample(t, pose, a.battery + (b.battery - a.battery) * share)
