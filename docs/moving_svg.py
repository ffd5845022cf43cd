"""An SVG that animates itself (SMIL): what maps and trees are drawn on for the moving picture of the README."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from math import dist
from operator import itemgetter

from btlang.pictures.drawing import SvgSurface, write_points

FASTER = 3.0
"""Seconds of the mission in a second of the picture."""
HOLD = 4.0
"""Seconds that the end is shown."""

Spans = Sequence[tuple[float, float]]
"""Seconds of the mission from when and until when something is shown."""


class MovingSurface(SvgSurface):
    """Also has groups that come, go and move. `z` counts within a `layer`."""

    def __init__(self, width: float, height: float, title: str, seconds: float) -> None:
        self._seconds = seconds / FASTER + HOLD
        super().__init__(width, height, title)

    @contextmanager
    def layer(self) -> Iterator[None]:
        """What is drawn within is sorted by `z`, and lies above what was drawn before."""
        above, self._parts = self._parts, []
        yield
        self._parts = [*above, *((0.0, line) for _, line in sorted(self._parts, key=itemgetter(0)))]

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
            self._parts.append((-1e9, f'<g visibility="{"visible" if stays else "hidden"}">'))
            if times != [0.0]:
                self._parts.append((-1e9, self._animation("visibility", words, times, "discrete")))
            elif not stays:
                raise ValueError("it's never shown")
            yield
            self._parts.append((1e9, "</g>"))

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
            self._parts += [(-1e9, line) for line in opened]
            yield
            self._parts += [(1e9, "</g>")] * (1 + bool(turns))

    def trace(self, points: Sequence[tuple[float, float]], times: Sequence[float], colour: str) -> None:
        """A line that grows: it reaches each point at its time."""
        gone = [0.0]
        for a, b in pairwise(points):
            gone.append(gone[-1] + dist(a, b))
        left = ";".join(f"{1 - length / gone[-1]:.4f}" for length in gone)
        moved = self._animation("stroke-dashoffset", left, [self._share(time) for time in times], "linear")
        self._add(
            0.0, "polyline", moved, pathLength="1", stroke_dasharray="1 1", points=write_points(points), fill="none",
            stroke=colour, stroke_width="2", stroke_linejoin="round", stroke_linecap="round",
        )  # fmt: skip

    @contextmanager
    def group(self, title: str) -> Iterator[None]:
        """Without a title: a moving thing isn't pointed at."""
        yield

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
