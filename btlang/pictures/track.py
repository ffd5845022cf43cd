"""The way of the robot on the map, from light to dark as time passes, and the robot itself."""

from __future__ import annotations

from itertools import pairwise
from math import atan2, cos, hypot, pi, sin

from btlang.pictures.run_record import RunRecord
from btlang.pictures.world_map import WorldMap
from btlang.robots.geometry import Point, Pose

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface

START, END = ("white", "#1f4e79"), ("#f2b134", "#5c3d00")
"""Fill and edge of the robot's body."""
_COLOURS = ((0.62, 0.79, 0.93), (0.03, 0.19, 0.42))
_ARROWS = 60.0  # points between two
_STEP = 3.0  # points; the way is drawn in pieces no shorter


def way(record: RunRecord) -> list[Point]:
    """All places where the robot was, in metres, without those where it stood still."""
    points: list[Point] = []
    for sample in record.track:
        point = (sample.pose.x, sample.pose.y)
        if not points or points[-1] != point:
            points.append(point)
    return points


def draw_track(canvas: Surface, map: WorldMap, record: RunRecord) -> list[tuple[float, float]]:
    """Draws the way with arrow heads; returns its points on the canvas."""
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
    canvas.shaded(points, shades, line=2, z=1.2)
    gone = _ARROWS / 2
    for ((ax, ay), (bx, by)), colour in zip(pieces, shades, strict=True):
        gone += hypot(bx - ax, by - ay)
        if gone >= _ARROWS:
            gone = 0.0
            _arrow(canvas, bx, by, atan2(by - ay, bx - ax), colour)
    return points


def draw_body(canvas: Surface, map: WorldMap, pose: Pose, radius: float, look: tuple[str, str], z: float) -> None:
    """The round robot with a line to where it looks."""
    x, y = map.at(pose.x, pose.y)
    fill, edge = look
    size = max(radius * map.scale, 4.0)
    canvas.circle(x, y, size, fill=fill, edge=edge, line=1.2, dashed=look is START, z=z)
    angle = pose.heading * pi / 180
    canvas.line([(x, y), (x + size * cos(angle), y - size * sin(angle))], colour=edge, line=1.4, z=z)


def shade(share: float) -> str:
    """The colour of the way after a share of its length."""
    (r, g, b), (r2, g2, b2) = _COLOURS
    mixed = (r + (r2 - r) * share, g + (g2 - g) * share, b + (b2 - b) * share)
    return "#" + "".join(f"{round(part * 255):02x}" for part in mixed)


def _arrow(canvas: Surface, x: float, y: float, angle: float, colour: str) -> None:
    corners = [(x + 5.6 * cos(angle + turn), y + 5.6 * sin(angle + turn)) for turn in (0.0, 2.45, -2.45)]
    canvas.polygon(corners, fill=colour, edge="white", line=0.7, z=1.3)
