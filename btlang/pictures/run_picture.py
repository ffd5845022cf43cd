"""The picture of a run: the world, the way of the robot, where each command began, and a legend."""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.files import write_file
from btlang.engine.status import FAILURE
from btlang.pictures import letters
from btlang.pictures.drawing import open_drawing
from btlang.pictures.files import MOVING, STILL, picture_ending
from btlang.pictures.run_record import WIDTH, Legend, PictureMark, RecordedCommand, RunRecord, select_commands
from btlang.pictures.surface import BUBBLES, HEADING, INK, LOOKS, SMALL, SOFT, TITLE
from btlang.pictures.track import (
    END,
    START,
    WALKED,
    draw_body,
    draw_track,
    draw_walks,
    name_walks,
    place_of,
    shade,
    way,
    ways,
)
from btlang.pictures.world_map import Area, Placer, WorldMap, along
from btlang.robots.geometry import Point
from btlang.robots.worlds.world import World
from btlang.run.bus import INLINE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface

_MARGIN, _GUTTER, _STRIP = 16.0, 22.0, 26.0
_TOP = _MARGIN + HEADING
_LEAST_WIDE = 440.0  # what is written below the map needs it
_ROOM = Area(_MARGIN, _TOP, 600.0, 520.0)  # for the map
_NEAR = 13.0  # points; commands that begin so near to each other share a mark
_BUBBLES, _WIDEST_BUBBLE = 8, 130.0
_SIGNS = {
    "bump": ("✱", "#c0440c", "bump"),
    "stuck": ("✖", "#c0440c", "stuck"),
    "grasp": ("▲", "#7a4f9e", "picked up"),
    "release": ("▼", "#7a4f9e", "put down"),
    "give": ("▼", "#7a4f9e", "given"),
    "drop": ("▽", "#c0440c", "dropped"),
}


class RunPicture:
    """A sink of a run, and then its picture, under a title. `label` and `is_action` are those of btlang.api.Mission."""

    policy = INLINE

    def __init__(
        self, world: World, label: Callable[[Node], str], is_action: Callable[[Node], bool], title: str
    ) -> None:
        self._world = world
        self._title = title
        self.record = RunRecord(label, is_action)

    def __call__(self, event: object) -> None:
        self.record(event)  # type: ignore[arg-type]

    def save(self, path: str) -> None:
        """Draw what happened so far to a file that ends in .svg, .png or .gif; nothing where no run began.

        Raises ValueError for another ending, MissionError (BT009, BT081).
        """
        kind = picture_ending(path, STILL + MOVING)
        if not self.record.begun:
            return
        with open_drawing(path, kind) as sheet:
            if kind == ".gif":
                from btlang.pictures.animation import animate

                data = animate(self._world, self.record, self._title)
            else:
                data = _Still(sheet, self._world, self.record, self._title).canvas.encode(kind)
        write_file(path, data)


class _Still:
    def __init__(
        self, sheet: Callable[[float, float, str], Surface], world: World, record: RunRecord, title: str
    ) -> None:
        self._record, self._world = record, world
        self._way, self._walked = way(record), _walked(record, world)
        self._map = WorldMap(_in_the_end(world, record), _ROOM, (*self._way, *self._walked))
        area, legend = self._map.area, Legend(record)
        self._key = self._key_items()
        wide = max(area.width, _LEAST_WIDE)
        height = max(area.height + _STRIP, legend.height)
        self.canvas = sheet(_MARGIN + wide + _GUTTER + WIDTH + _MARGIN, _TOP + height + _MARGIN, title)
        text = letters.clip_text(title, wide + _GUTTER + WIDTH, TITLE, True)
        self.canvas.text(_MARGIN, _MARGIN + 4, text, size=TITLE, bold=True)
        self._placer = Placer(area)
        self._map.draw(self.canvas, [name for name in record.sightings if ways(record.sightings[name])])
        points = draw_track(self.canvas, self._map, record)
        self._placer.avoid(along(points, 4.0))
        self._placer.avoid(self._map.lines())
        draw_walks(self.canvas, self._map, record, world, self._placer)
        self._bodies()
        groups = _groups(select_commands(record.commands), self._map)
        self._placer.taken += [Area(x - 2, y - 2, 4, 4) for (x, y), _ in groups]
        marks = self._marks()
        self._map.draw_names(self.canvas, self._placer, record.moved)
        name_walks(self.canvas, self._map, record, world, self._placer)
        self._numbers(groups)
        self._bubbles(marks)
        legend.draw(self.canvas, _MARGIN + wide + _GUTTER, _TOP)
        self._strip(_TOP + area.height + _STRIP - 8, wide)

    def _bodies(self) -> None:
        track, radius = self._record.track, self._record.radius
        for pose, look, z in ((track[0].pose, START, 1), (track[-1].pose, END, 2)):
            draw_body(self.canvas, self._map, pose, radius, look, z)
            (x, y), size = self._map.at(pose.x, pose.y), radius * self._map.scale
            self._placer.taken.append(Area(x - size, y - size, 2 * size, 2 * size))

    def _marks(self) -> list[PictureMark]:
        """Draw signs, each once at a place; return what was said."""
        drawn: list[tuple[str, float, float]] = []
        said: list[PictureMark] = []
        for mark in self._record.marks:
            if mark.kind not in _SIGNS:
                said.append(mark)
                continue
            sign, colour, _ = _SIGNS[mark.kind]
            reach = self._record.radius if mark.kind in ("grasp", "release", "give", "drop", "bump") else 0.0
            x, y = self._map.at(*mark.pose.ahead(reach))
            if any(kind == mark.kind and abs(px - x) + abs(py - y) < 7 for kind, px, py in drawn):
                continue
            drawn.append((mark.kind, x, y))
            self.canvas.text(x, y, sign, size=9, colour=colour, align="center", halo=True, z=5)
            self._placer.taken.append(Area(x - 4, y - 4, 8, 8))
        return said

    def _numbers(self, groups: list[tuple[tuple[float, float], list[RecordedCommand]]]) -> None:
        shown = {command.number for _, group in groups for command in group}
        for command in self._record.commands:
            if command.number not in shown:
                x, y = self._map.at(command.start.pose.x, command.start.pose.y)
                self.canvas.circle(x, y, 1.6, fill=INK, z=5)
        for (x, y), group in groups:
            text = numbers([command.number for command in group])
            looks = {LOOKS[command.status] for command in group}
            failed = any(command.status == FAILURE for command in group)
            colour = LOOKS[FAILURE].strong if failed else looks.pop().strong if len(looks) == 1 else INK
            width, height = max(letters.width(text, SMALL, True) + 7, 13.0), 13.0
            area, _ = self._placer.place(x, y, width, height, 5.0)
            middle = area.middle
            self.canvas.line([(x, y), middle], colour=colour, line=0.9, z=5)
            self.canvas.circle(x, y, 2.2, fill=colour, edge="white", line=0.6, z=5)
            self.canvas.box(area.x, area.y, width, height, round=6.4, fill=colour, edge="white", line=0.8, z=6)
            self.canvas.text(*middle, text, size=SMALL, bold=True, colour="white", align="center", z=6)

    def _bubbles(self, said: list[PictureMark]) -> None:
        """Draw what the robot and others said, each text once, as long as there is room for it."""
        texts: dict[str, PictureMark] = {}
        for mark in said:
            if mark.text:
                texts.setdefault(mark.text, mark)
        for mark in list(texts.values())[:_BUBBLES]:
            text = letters.clip_text(letters.make_printable(mark.text), _WIDEST_BUBBLE, SMALL)
            speaker = place_of(self._world, self._record, mark.who, mark.t) if mark.kind == "hear" else None
            x, y = self._map.at(*(speaker or (mark.pose.x, mark.pose.y)))
            fill, edge = BUBBLES.get(mark.kind, BUBBLES["say"])
            width = letters.width(text, SMALL) + 10
            area, overlap = self._placer.place(x, y, width, 14.0, max(8.0, self._record.radius * self._map.scale + 4))
            if overlap > 20:
                self._placer.taken.remove(area)
                continue
            cx, cy = area.middle
            cx = min(max(x, area.x + 8), area.x + width - 8)
            self.canvas.polygon([(cx - 3, cy), (cx + 3, cy), (x, y)], fill=fill, edge=edge, line=0.7, z=2.5)
            self.canvas.box(area.x, area.y, width, 14, round=5, fill=fill, edge=edge, line=0.7, z=2.6)
            self.canvas.box(cx - 2.6, cy - 5, 5.2, 10, fill=fill, z=2.7)
            self.canvas.text(area.x + 5, cy, text, size=SMALL, colour=INK, z=2.8)

    def _key_items(self) -> list[tuple[str, str, str]]:
        kinds = {mark.kind for mark in self._record.marks}
        return [_SIGNS[kind] for kind in _SIGNS if kind in kinds]

    def _strip(self, y: float, wide: float) -> None:
        """Draw the scale and what the signs mean, below the map."""
        canvas, x = self.canvas, _MARGIN + 2
        x += self._map.draw_scale(canvas, x, y + 2) + 20
        for look, word in ((START, "start"), (END, "end")):
            canvas.circle(x + 5, y, 5, fill=look[0], edge=look[1], dashed=look is START)
            canvas.text(x + 14, y, word, size=SMALL, colour=SOFT)
            x += 14 + letters.width(word, SMALL) + 14
        for i in range(12):
            canvas.line([(x + 2 * i, y), (x + 2 * i + 2, y)], colour=shade(i / 11), line=2.4, round=False)
        canvas.text(x + 29, y, "way, light to dark", size=SMALL, colour=SOFT)
        x += 29 + letters.width("way, light to dark", SMALL) + 14
        canvas.circle(x + 6, y, 5.5, fill=INK)
        canvas.text(x + 6, y, "n", size=SMALL, bold=True, colour="white", align="center")
        canvas.text(x + 15, y, "command begins", size=SMALL, colour=SOFT)
        x += 15 + letters.width("command begins", SMALL) + 14
        if self._walked:
            canvas.line([(x, y), (x + 18, y)], colour=WALKED, line=1.1, dashed=True, round=False)
            canvas.text(x + 23, y, "people", size=SMALL, colour=SOFT)
            x += 23 + letters.width("people", SMALL) + 14
        for sign, colour, word in self._key:
            if x + 12 + letters.width(word, SMALL) > _MARGIN + wide:
                break
            canvas.text(x + 4, y, sign, colour=colour, align="center")
            canvas.text(x + 12, y, word, size=SMALL, colour=SOFT)
            x += 12 + letters.width(word, SMALL) + 14


def _in_the_end(world: World, record: RunRecord) -> World:
    """Return the world with its doors as they were at last."""
    is_open = {name: opened for _, name, opened in record.doors}
    changed: World = world.replace(
        doors=tuple(door.replace(open=is_open.get(door.name, door.open)) for door in world.doors)
    )
    return changed


def _walked(record: RunRecord, world: World) -> list[Point]:
    """Return all points of the ways of people."""
    names = [name for name in record.sightings if name not in world.names.objects]
    return [point for name in names for way in ways(record.sightings[name]) for point in way]


def numbers(values: list[int]) -> str:
    """Write `1`, `3-5`, `1, 3-5`: numbers in order with runs joined; of many, the first and `…`."""
    runs: list[list[int]] = []
    for value in sorted(values):
        if runs and value == runs[-1][-1] + 1:
            runs[-1].append(value)
        else:
            runs.append([value])
    parts = [str(run[0]) if len(run) == 1 else f"{run[0]}\N{EN DASH}{run[-1]}" for run in runs]
    return ", ".join(parts if len(parts) <= 4 else [*parts[:3], "…"])


def _groups(commands: list[RecordedCommand], map: WorldMap) -> list[tuple[tuple[float, float], list[RecordedCommand]]]:
    """Return groups of commands that began at nearly the same place, with the place of the first of them."""
    groups: list[tuple[tuple[float, float], list[RecordedCommand]]] = []
    for command in commands:
        x, y = map.at(command.start.pose.x, command.start.pose.y)
        for (gx, gy), group in groups:
            if abs(gx - x) < _NEAR and abs(gy - y) < _NEAR:
                group.append(command)
                break
        else:
            groups.append(((x, y), [command]))
    return groups
