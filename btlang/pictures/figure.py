"""Pictures of a body: its capsules from the side and from the front, at moments of a gesture."""

from __future__ import annotations

import io
from collections.abc import Mapping

import numpy as np

from btlang.pictures.canvas import Canvas
from btlang.pictures.drawing import open_drawing
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture
from btlang.robots.bodies.joint_tables import BASE
from btlang.robots.motion.kinematics import Kinematics
from btlang.robots.simulation.rehearsal import STEP, Rehearsal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface

_SCALE = 85.0  # points a metre
_WIDE, _HIGH = 1.5, 2.05  # metres of a view
_MARGIN = 12.0
_COLUMNS = 6
_BODY, _LEFT, _RIGHT, _HEAD = "#b8bec8", "#2f7fd1", "#d8662c", "#56606e"
_EDGE = "#ffffff"
_FILM = 0.06  # seconds between two pictures of a film
_PAUSE = 0.8  # seconds that its last one stays


def draw_gesture(body: Body, gesture: Gesture, rehearsal: Rehearsal, path: str, kind: str) -> bytes:
    """Return the bytes of a file of a kind, ".svg", ".png" or ".gif". Raises MissionError (BT081)."""
    with open_drawing(path, kind) as sheet:
        if kind == ".gif":
            return _film(body, gesture, rehearsal)
        times = _moments(gesture, rehearsal)
        columns = min(_COLUMNS, len(times))
        rows = -(-len(times) // columns)
        width, height = _MARGIN + columns * (2 * _WIDE * _SCALE + _MARGIN), _MARGIN + rows * (_HIGH * _SCALE + 26)
        canvas = sheet(width, height, f"The gesture {gesture.name}")
        for number, (seconds, says) in enumerate(times):
            row, column = divmod(number, columns)
            left = _MARGIN + column * (2 * _WIDE * _SCALE + _MARGIN)
            top = _MARGIN + row * (_HIGH * _SCALE + 26)
            canvas.text(left + _WIDE * _SCALE, top + 8, says, align="center")
            _draw(canvas, body, rehearsal.angles[_index(rehearsal, seconds)], left, top + 16)
        return canvas.encode(kind)


def _moments(gesture: Gesture, rehearsal: Rehearsal) -> list[tuple[float, str]]:
    """Return the seconds of its key frames and of its stroke, with what stands above each."""
    longer = rehearsal.seconds / gesture.seconds
    found = {0.0: "0 s"} | {frame.at: f"{frame.at:g} s" for frame in gesture.frames}
    found[gesture.stroke] = f"{gesture.stroke:g} s: stroke"
    return [(at * longer, says) for at, says in sorted(found.items())]


def _index(rehearsal: Rehearsal, seconds: float) -> int:
    return min(len(rehearsal.angles) - 1, round(seconds / STEP))


def _draw(canvas: Surface, body: Body, angles: Mapping[str, float], left: float, top: float) -> None:
    """Draw the side that it turns its right arm to, and the front."""
    rows = np.array([[angles[joint.name] for joint in body.joints]])
    frames = Kinematics(body).frames(rows)
    floor = top + _HIGH * _SCALE - 6
    for view, middle in enumerate((left + 0.6 * _SCALE, left + 1.5 * _WIDE * _SCALE)):
        canvas.line([(middle - 0.5 * _SCALE, floor), (middle + 0.5 * _SCALE, floor)], colour=_BODY, line=1)
        shapes = []
        for capsule in body.capsules:
            ends = [frames[capsule.link].place(point)[:, 0] for point in (capsule.start, capsule.end)]
            depth = [-end[1] for end in ends] if view == 0 else [end[0] for end in ends]
            across = [end[0] for end in ends] if view == 0 else [end[1] for end in ends]
            points = [(middle + x * _SCALE, floor - end[2] * _SCALE) for x, end in zip(across, ends, strict=True)]
            shapes.append((sum(depth), capsule.link, points, 2 * capsule.radius * _SCALE))
        for _, link, points, wide in sorted(shapes, key=lambda shape: shape[0]):
            canvas.line(points, colour=_EDGE, line=wide + 1.6)
            canvas.line(points, colour=_colour(link), line=wide)
        if "head" in frames:
            nose = frames["head"].place((0.14, 0.0, 0.12))[:, 0]
            ahead, across = (nose[1], nose[0]) if view == 0 else (-nose[0], nose[1])
            if view == 0 or ahead < -frames["head"].origin[0, 0]:
                canvas.circle(
                    middle + across * _SCALE, floor - nose[2] * _SCALE, 2.4, fill=_HEAD if view == 0 else _EDGE
                )


def _colour(link: str) -> str:
    words = (link or BASE).split()
    sides = {"left": _LEFT, "right": _RIGHT, "head": _HEAD}
    return next((colour for word, colour in sides.items() if word in words), _BODY)


def _film(body: Body, gesture: Gesture, rehearsal: Rehearsal) -> bytes:
    from PIL import Image

    pictures: list[Image.Image] = []
    count = max(2, round(rehearsal.seconds / _FILM))
    for number in range(count + 1):
        seconds = rehearsal.seconds * number / count
        width, height = 2 * _WIDE * _SCALE + 2 * _MARGIN, _HIGH * _SCALE + 40
        canvas = Canvas(width, height, gesture.name)
        canvas.text(width / 2, 14, f"{gesture.name}  {seconds:.1f} s", align="center")
        _draw(canvas, body, rehearsal.angles[_index(rehearsal, seconds)], _MARGIN, 24)
        canvas.begin_film(100)
        size, pixels = canvas.pixels()
        pictures.append(Image.frombuffer("RGBA", size, pixels).convert("RGB"))
    out = io.BytesIO()
    lasts = [round(1000 * rehearsal.seconds / count)] * count + [round(1000 * _PAUSE)]
    pictures[0].save(out, "gif", save_all=True, append_images=pictures[1:], duration=lasts, loop=0, optimize=True)
    return out.getvalue()
