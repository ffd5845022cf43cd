"""An SVG that animates itself (SMIL): what maps and trees are drawn on for the moving picture of the README."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from math import dist

from btlang.pictures.style import PAPER
from btlang.pictures.svg import SvgSurface

FASTER = 3.0
"""Seconds of the mission in a second of the picture."""
HOLD = 4.0
"""Seconds that the end is shown."""

Spans = Sequence[tuple[float, float]]
"""Seconds of the mission from when and until when something is shown."""


class MovingSurface(SvgSurface):
    """Also has what maps are drawn with, and groups that come, go and move. `z` counts within a `layer`."""

    def __init__(self, width: float, height: float, title: str, seconds: float) -> None:
        self._parts: list[tuple[float, list[str]]] = []
        self._seconds = seconds / FASTER + HOLD
        super().__init__(width, height, title)

    def text(self, x, y, text, *, z=0.0, halo=False, **options) -> None:
        with self._at(z) as lines:
            super().text(x, y, text, **options)
            if halo and lines:
                outline = f'<text paint-order="stroke" stroke="{PAPER}" stroke-width="2.5" stroke-linejoin="round"'
                lines[:] = [line.replace("<text", outline, 1) for line in lines]

    def box(self, *place, z=0.0, **options) -> None:
        with self._at(z):
            super().box(*place, **options)

    def polygon(self, points, *, z=0.0, line=1.0, **options) -> None:
        with self._at(z) as lines:
            super().polygon(points, **options)
            _widen(lines, line)

    def line(self, points, *, z=0.0, line=1.0, dashed=False, round=True, **options) -> None:
        with self._at(z) as lines:
            super().line(points, **options)
            _widen(lines, line)
            style = 'stroke-dasharray="2 2" ' * dashed + 'stroke-linecap="round" ' * round
            lines[:] = [each.replace("<polyline ", f"<polyline {style}", 1) for each in lines]

    def circle(self, x, y, radius, *, fill="none", edge="none", line=1.0, dashed=False, z=0.0) -> None:
        stroke = {} if edge == "none" else {"stroke": edge, "stroke_width": line}
        with self._at(z):
            self._add("circle", cx=x, cy=y, r=radius, fill=fill, **stroke, stroke_dasharray="2 1.5" if dashed else None)

    @contextmanager
    def layer(self) -> Iterator[None]:
        """What is drawn within is sorted by `z`, and lies above what was drawn before."""
        above, self._parts = self._parts, []
        yield
        lines = [line for _, part in sorted(self._parts, key=lambda part: part[0]) for line in part]
        self._parts = [*above, (0.0, lines)]

    @contextmanager
    def shown(self, spans: Spans, end: float) -> Iterator[None]:
        """What is drawn within is shown in these spans, and without animation if one of them lasts beyond the end."""
        stays = any(until > end for _, until in spans)
        changes: dict[float, bool] = {0.0: False}
        for start, until in spans:
            changes[self._share(start)] = True
            if until <= end:
                changes[self._share(until)] = False
        times = sorted(changes)
        words = ";".join("visible" if changes[time] else "hidden" for time in times)
        with self.layer():
            self._parts.append((-1e9, [f'<g visibility="{"visible" if stays else "hidden"}">']))
            if times != [0.0]:
                self._parts.append((-1e9, [self._animation("visibility", words, times, "discrete")]))
            elif not stays:
                raise ValueError("it's never shown")
            yield
            self._parts.append((1e9, ["</g>"]))

    @contextmanager
    def moving(self, places: Sequence[tuple[float, float, float]], turns: Sequence[float] = ()) -> Iterator[None]:
        """What is drawn within, about the origin, is moved to (time, x, y), and turned if there are angles."""
        times = [self._share(time) for time, _, _ in places]
        moves = ";".join(f"{x:.1f},{y:.1f}" for _, x, y in places)
        opened = [f'<g transform="translate({moves.rpartition(";")[2]})">', self._transform("translate", moves, times)]
        if turns:
            angles = ";".join(f"{turn:.0f}" for turn in turns)
            opened += [f'<g transform="rotate({turns[-1]:.0f})">', self._transform("rotate", angles, times)]
        with self.layer():
            self._parts.append((-1e9, opened))
            yield
            self._parts.append((1e9, ["</g>"] * (1 + bool(turns))))

    def trace(self, points: Sequence[tuple[float, float]], times: Sequence[float], colour: str) -> None:
        """A line that grows: it reaches each point at its time."""
        gone = [0.0]
        for a, b in pairwise(points):
            gone.append(gone[-1] + dist(a, b))
        left = ";".join(f"{1 - length / gone[-1]:.4f}" for length in gone)
        style = '<polyline pathLength="1" stroke-dasharray="1 1" stroke-width="2" stroke-linecap="round" '
        moved = self._animation("stroke-dashoffset", left, [self._share(time) for time in times], "linear")
        with self._at(0.0) as lines:
            super().line(points, colour=colour)
            lines[:] = [each.replace("<polyline ", style, 1).replace("/>", f">{moved}</polyline>") for each in lines]

    def encoded(self, kind: str) -> bytes:
        self._lines += [line for _, part in self._parts for line in part]
        self._parts = []
        return super().encoded(kind)

    @contextmanager
    def group(self, title: str) -> Iterator[None]:
        """Without a title: a moving thing isn't pointed at."""
        yield

    @contextmanager
    def _at(self, z: float) -> Iterator[list[str]]:
        kept, self._lines = self._lines, []
        yield self._lines
        added, self._lines = self._lines, kept
        self._parts.append((z, added))

    def _share(self, time: float) -> float:
        return round(time / FASTER / self._seconds, 5)

    def _animation(self, name: str, values: str, times: Sequence[float], mode: str) -> str:
        return f'<animate attributeName="{name}" {self._timing(values, times, mode)}/>'

    def _transform(self, kind: str, values: str, times: Sequence[float]) -> str:
        timing = self._timing(values, times, "linear")
        return f'<animateTransform attributeName="transform" type="{kind}" {timing}/>'

    def _timing(self, values: str, times: Sequence[float], mode: str) -> str:
        shares = [f"{time:g}" for time in times]
        if mode == "linear":  # which has to end at 1
            shares, values = [*shares, "1"], f"{values};{values.rpartition(';')[2]}"
        return (
            f'values="{values}" keyTimes="{";".join(shares)}" calcMode="{mode}" dur="{self._seconds:.2f}s" '
            'repeatCount="indefinite"'
        )


def _widen(lines: list[str], width: float) -> None:
    if width != 1:
        lines[:] = [line.replace(" stroke=", f' stroke-width="{width:g}" stroke=', 1) for line in lines]
