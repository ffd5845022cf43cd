"""The moving picture of the README: a mission, its tree and the robot as it runs.

It is made of a run: every status, place, time and word on it comes from an event of that run. A viewer without
animation shows the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

from moving_svg import FASTER, MovingSurface

import btlang
from btlang.pictures import letters
from btlang.pictures.run_record import LastStatuses, PathSample, RunRecord, outcome
from btlang.pictures.surface import BUBBLES, INK, LOOKS, NEVER, SMALL, SOFT, TITLE, Look
from btlang.pictures.track import END, draw_body, way
from btlang.pictures.tree_layout import Maker, TreeLayout, lay_out
from btlang.pictures.tree_picture import _TreePicture
from btlang.pictures.world_map import OBJECT, Area, Placer, WorldMap, along
from btlang.robots.geometry import Pose, wrap
from btlang.robots.worlds.world import Thing, World
from btlang.robots.worlds.world_file import load_world
from btlang.run.events import StatusesChanged
from btlang.text.source import Span

_MARGIN, _TOP, _LEFT = 14.0, 44.0, 312.0
_LINE = 13.5
_STEP = 0.25  # seconds of the mission between two places of the robot
_SPOKEN = 4.0  # seconds of the mission that a text is shown, at least
_BLUE, _BAND = "#2a6fb0", "#ffecb8"

T = TypeVar("T")


class Watcher:
    """A sink: the statuses of all nodes whenever one changes, and the lines of the mission that are under way."""

    policy = "inline"

    def __init__(self, mission: btlang.Mission) -> None:
        self._maker = (mission.tree, mission.label, mission.is_action)
        self._last = LastStatuses()
        self._under_way: dict[str, int] = {}
        self.frames: list[tuple[float, tuple[int | None, ...]]] = []
        self.lines: list[tuple[float, frozenset[int]]] = [(0.0, frozenset())]
        self.record = RunRecord(mission.label, mission.is_action)

    def __call__(self, event: object) -> None:
        self.record(event)
        if not isinstance(event, StatusesChanged):
            return
        self._last(event)
        for change in event:
            self._under_way.pop(change.path, None)
            if LOOKS[change.status].word == "running" and not change.node.children and change.node.span is not None:
                self._under_way[change.path] = line_of(change.node.span)
        self.lines.append((event.t, frozenset(self._under_way.values())))
        [sheet] = Maker(*self._maker, self._last).sheets()
        self.frames.append((event.t, tuple(box.status for box in sheet.boxes)))

    def layout(self) -> TreeLayout:
        """Where the boxes of the tree go."""
        [sheet] = Maker(*self._maker, self._last).sheets()
        return lay_out(sheet.boxes, signs=True)


def line_of(span: Span) -> int:
    """The number of its line in the mission, from 0."""
    return span.source.text.count("\n", 0, span.start)


class MovingTree(_TreePicture):
    """Draws each node once for each status that it has, each shown at its times."""

    def __init__(self, surface: MovingSurface, watcher: Watcher, end: float) -> None:
        self._signs, self.surface = True, surface
        self._spots = watcher.layout()
        self._frames, self._end = watcher.frames, end

    def draw(self, x: float, y: float) -> None:
        """Draws it with its upper left corner at a place, and what the colours mean below it."""
        for index, spot in enumerate(self._spots.spots):
            if spot.box.shape == "frame":
                self._each_look(index, x, y)
        for link in self._spots.links:
            self._link(link, x, y)
        for index, spot in enumerate(self._spots.spots):
            if spot.box.shape != "frame":
                self._each_look(index, x, y)
        found = {status for _, statuses in self._frames for status in statuses}
        with self.surface.group(""):
            self._draw_legend_at(x, y + self._spots.height + 22, [LOOKS[each] for each in LOOKS if each in found])

    def _each_look(self, index: int, x: float, y: float) -> None:
        spot = self._spots.spots[index]
        values = [(0.0, None), *((time, statuses[index]) for time, statuses in self._frames)]
        for status, spans in spans_of(values, self._end).items():
            with self.surface.shown(spans, self._end):
                drawn = spot.replace(box=spot.box.replace(status=status))
                (self._frame if spot.box.shape == "frame" else self._box)(drawn, x, y)

    def _draw_legend_at(self, x: float, y: float, looks: Sequence[Look]) -> None:
        for look in (*looks, NEVER):
            self.surface.box(x, y - 6, 14, 12, round=3, fill=look.pale, edge=look.strong)
            self.surface.text(x + 7, y, look.sign, bold=True, colour=look.strong, align="center", size=SMALL)
            self.surface.text(x + 19, y, look.word, colour=SOFT, size=SMALL)
            x += letters.width(look.word, SMALL) + 36


def spans_of(values: Sequence[tuple[float, T]], end: float) -> dict[T, list[tuple[float, float]]]:
    """When each value holds: from its time to that of the next one, the last one beyond the end."""
    spans: dict[T, list[tuple[float, float]]] = {}
    untils = [time for time, _ in values[1:]] + [end + 1]
    for (time, value), until in zip(values, untils, strict=True):
        if until > time:
            before = spans.setdefault(value, [])
            if before and before[-1][1] == time:
                time = before.pop()[0]
            before.append((time, until))
    return spans


def moving_picture(path: Path) -> bytes:
    """Runs a mission in the world that ships, and returns the file."""
    mission, name = btlang.parse_file(str(path)), path.name
    watcher = Watcher(mission)
    result = mission.run(speed="max", sinks=[watcher])
    assert result.succeeded, result.why()
    assert not watcher.record.sightings, "people who walk aren't drawn"
    end, layout, text = result.seconds, watcher.layout(), path.read_text(encoding="utf-8").rstrip().splitlines()
    map_top = _TOP + len(text) * _LINE + 50
    room = Area(_MARGIN, map_top, _LEFT, 400.0)
    world = load_world(None)
    cup = [thing for thing in world.objects if thing.name in watcher.record.moved]
    still = world.replace(objects=tuple(thing for thing in world.objects if thing not in cup))
    map = WorldMap(still, room, [*way(watcher.record), *((thing.x, thing.y) for thing in cup)])
    height = max(map_top + map.area.height, _TOP + layout.height + 30) + _MARGIN
    width = _MARGIN + _LEFT + 24 + layout.width + _MARGIN
    surface = MovingSurface(width, height, f"{name}: a mission, its tree and the robot, as it runs", end)
    surface.text(_MARGIN, 18, name, size=TITLE, bold=True)
    about = f"on the simulated robot, shown {FASTER:g} times as fast"
    surface.text(_MARGIN + letters.width(name, TITLE, True) + 10, 18, about, colour=SOFT)
    draw_clock(surface, watcher.record, end, width - _MARGIN)
    draw_text(surface, text, watcher.lines, end)
    draw_headline(surface, watcher.record, end, map_top - 16)
    draw_map(surface, map, still, watcher.record, cup, end)
    MovingTree(surface, watcher, end).draw(_MARGIN + _LEFT + 24, _TOP - 6)
    return surface.encode(".svg")


def draw_clock(surface: MovingSurface, record: RunRecord, end: float, right: float) -> None:
    """The time and the battery, second by second."""
    values = [
        (float(second), f"{second} s   ·   battery {sample_at(record, second).battery:.0f} %")
        for second in range(int(end) + 1)
    ]
    values.append((end, f"{end:.1f} s   ·   battery {record.track[-1].battery:.0f} %"))
    for text, spans in spans_of(values, end).items():
        with surface.shown(spans, end):
            surface.text(right, 18, text, colour=SOFT, align="right")


def draw_text(
    surface: MovingSurface, text: Sequence[str], lines: Sequence[tuple[float, frozenset[int]]], end: float
) -> None:
    """The mission, with a band behind the lines whose commands are under way."""
    surface.box(_MARGIN, _TOP - 8, _LEFT, len(text) * _LINE + 12, round=4, fill="#f6f7f8", edge="#dfe3e6")
    for number, line in enumerate(text):
        y = _TOP + number * _LINE + 5
        spans = spans_of([(time, number in found) for time, found in lines], end).get(True)
        if spans:
            with surface.shown(spans, end):
                surface.box(_MARGIN + 4, y - _LINE / 2, _LEFT - 8, _LINE, round=3, fill=_BAND)
        surface.text(_MARGIN + 10, y, line, colour=SOFT if line.startswith("#") else INK)


def draw_headline(surface: MovingSurface, record: RunRecord, end: float, y: float) -> None:
    """The commands under way, and in the end the outcome."""
    times = sorted({0.0, end, *(c.start.t for c in record.commands), *(c.end for c in record.commands)})
    values = [(t, "  and  ".join(c.text for c in record.commands if c.start.t <= t < c.end)) for t in times if t < end]
    for text, spans in spans_of([*values, (end, "")], end).items():
        if text:
            with surface.shown(spans, end):
                surface.text(_MARGIN, y, text, size=TITLE, bold=True)
    look, words = outcome(record)
    with surface.shown([(end, end + 1)], end):
        surface.text(_MARGIN, y, f"{look.sign} {words}", size=TITLE, bold=True, colour=look.strong)


def draw_map(
    surface: MovingSurface, map: WorldMap, still: World, record: RunRecord, cup: Sequence[Thing], end: float
) -> None:
    """The world, the way as it grows, the robot with what it carries, and what it says."""
    with surface.layer():
        map.draw(surface)
        placer = Placer(map.area)
        placer.avoid(along([map.at(*place) for place in way(record)], 4.0))
        map.draw_names(surface, placer)
    steps = [end * i / round(end / _STEP) for i in range(round(end / _STEP) + 1)]
    poses = [sample_at(record, time).pose for time in steps]
    places = [map.at(pose.x, pose.y) for pose in poses]
    surface.trace(places, steps, _BLUE)
    for thing in cup:
        draw_resting(surface, map, thing, record, end)
    turns = [-poses[0].heading]
    for before, now in pairwise(poses):
        turns.append(turns[-1] - wrap(now.heading - before.heading))
    with surface.moving([(t, *place) for t, place in zip(steps, places, strict=True)], turns):
        draw_body(surface, Origin(map.scale), Pose(0.0, 0.0, 0.0), record.radius, END, 0)
        for thing in cup:
            spans = spans_of([(t, place is None) for t, name, place in record.moves if name == thing.name], end)
            with surface.shown(spans[True], end):
                x, radius = record.radius * map.scale, max(thing.radius * map.scale, 2.6)
                surface.circle(x, 0, radius, fill=OBJECT, edge="white", line=0.6)
    for mark in record.marks:
        if mark.kind in BUBBLES and mark.text:
            with surface.shown([(mark.t, mark.t + _SPOKEN)], end):
                draw_bubble(surface, map, mark.text, mark.kind, mark.pose, record.radius)


class Origin:
    """A map on which everything is at the origin: for what is moved afterwards."""

    def __init__(self, scale: float) -> None:
        self.scale = scale

    def at(self, x: float, y: float) -> tuple[float, float]:
        return 0.0, 0.0


def draw_resting(surface: MovingSurface, map: WorldMap, thing: Thing, record: RunRecord, end: float) -> None:
    """An object that is carried, where it lies before and after."""
    places = [(0.0, (thing.x, thing.y)), *((t, place) for t, name, place in record.moves if name == thing.name)]
    for place, spans in spans_of(places, end).items():
        if place is None:
            continue
        with surface.shown(spans, end):
            (x, y), radius = map.at(*place), max(thing.radius * map.scale, 2.6)
            surface.circle(x, y, radius, fill=OBJECT, edge="white", line=0.6)
            surface.text(x + radius + 2, y - 4, thing.name, size=SMALL, colour=OBJECT, halo=True)


def draw_bubble(surface: MovingSurface, map: WorldMap, text: str, kind: str, pose: Pose, radius: float) -> None:
    """What is said, to the right of the robot."""
    fill, edge = BUBBLES[kind]
    width = letters.width(text, SMALL) + 10
    (x, y), area = map.at(pose.x, pose.y), map.area
    left = min(x + radius * map.scale + 5, area.x + area.width - width)
    surface.polygon([(left + 4, y + 4), (left + 10, y + 4), (x, y)], fill=fill, edge=edge, line=0.7)
    surface.box(left, y + 2, width, 14, round=5, fill=fill, edge=edge, line=0.8)
    surface.text(left + 5, y + 9, text, size=SMALL)


def sample_at(record: RunRecord, time: float) -> PathSample:
    """Where the robot was, between two samples too."""
    track = record.track
    after = next((i for i, sample in enumerate(track) if sample.t > time), len(track))
    if after in (0, len(track)):
        return track[min(after, len(track) - 1)]
    a, b = track[after - 1], track[after]
    share, p, q = (time - a.t) / (b.t - a.t), a.pose, b.pose
    heading = p.heading + wrap(q.heading - p.heading) * share
    pose = Pose(p.x + (q.x - p.x) * share, p.y + (q.y - p.y) * share, heading)
    return PathSample(time, pose, a.battery + (b.battery - a.battery) * share)
