"""The picture of a world as its file describes it."""

from __future__ import annotations

from btlang.diagnostics.files import write_file
from btlang.pictures import letters
from btlang.pictures.drawing import open_drawing
from btlang.pictures.files import STILL, picture_ending
from btlang.pictures.surface import HEADING, TITLE
from btlang.pictures.track import START, draw_body
from btlang.pictures.world_map import Area, Placer, WorldMap
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.worlds.world import World

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from btlang.pictures.surface import Surface

_MARGIN, _STRIP = 16.0, 22.0
_TOP = _MARGIN + HEADING
_ROOM = Area(_MARGIN, _TOP, 760.0, 620.0)
_LEAST_WIDE = 260.0  # for the title


def draw_world(world: World, path: str, title: str) -> None:
    """Draw a world with the robot at its start to a file that ends in .svg or .png.

    Raises ValueError for another ending, MissionError (BT009, BT081).
    """
    kind = picture_ending(path, STILL)
    with open_drawing(path, kind) as sheet:
        data = _draw(sheet, world, title).encode(kind)
    write_file(path, data)


def _draw(sheet: Callable[[float, float, str], Surface], world: World, title: str) -> Surface:
    drawn = WorldMap(world, _ROOM)
    area = drawn.area
    wide = max(area.width, _LEAST_WIDE)
    canvas = sheet(wide + 2 * _MARGIN, _TOP + area.height + _STRIP + _MARGIN, title)
    canvas.text(_MARGIN, _MARGIN + 4, letters.clip_text(title, wide, TITLE, True), size=TITLE, bold=True)
    placer = Placer(area)
    drawn.draw(canvas)
    placer.avoid(drawn.lines())
    radius = standard_body().radius
    draw_body(canvas, drawn, world.start, radius, START, 1)
    (x, y), size = drawn.at(world.start.x, world.start.y), radius * drawn.scale
    placer.taken.append(Area(x - size, y - size, 2 * size, 2 * size))
    drawn.draw_names(canvas, placer)
    drawn.draw_scale(canvas, _MARGIN + 2, _TOP + area.height + _STRIP - 6)
    return canvas
