"""How far strokes are from their words, measured on the joints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from btlang.actions.speech import say
from btlang.robots.robot import Operation
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.support.record import Record

FINE = 0.01  # seconds between two looks at the joints
_NEAR = 3.0  # degrees from the stroke


class Met(Record):
    """Seconds by which a stroke was behind its word, and what was promised."""

    name: str
    late: float
    planned: float


class Posed(Protocol):
    """A robot, as far as it is looked at here."""

    @property
    def time(self) -> float: ...
    def joint(self, name: str) -> float: ...


class Way:
    """A gesture on its way: its joints have `targets` at the stroke, None where geometry finds them."""

    def __init__(self, name: str, targets: Mapping[str, float], at: float) -> None:
        self.name, self.targets, self.at = name, targets, at
        self.met: float | None = None  # of a gesture with an aim what its course says
        self._nearest, self._over = _NEAR, False

    def look(self, robot: Posed) -> None:
        """The stroke is where the joints are nearest to it for the first time."""
        off = max(abs(robot.joint(name) - target) for name, target in self.targets.items())
        self._over = self._over or (self.met is not None and off > _NEAR)
        if off < self._nearest - 0.001 and not self._over:
            self._nearest, self.met = off, robot.time


def measured(robot: SimulatedRobot, text: str, period: float, beside: Callable[[], object] = lambda: None) -> list[Met]:
    """Says a text with a tick each `period`, and `beside` that; the strokes of its gestures."""
    ways: list[Way] = []
    planned: list[Mapping[str, Any]] = []
    begin = robot.gesture

    def watched(name: str, **options: Any) -> Operation:
        made = begin(name, **options)
        found = robot.body.gestures[name]
        [frame] = [frame for frame in found.frames if frame.at == found.stroke]
        targets = {} if found.aim else {joint: float(angle) for joint, angle in frame.joints.items()}
        ways.append(Way(name, targets, float(options["stroke_at"])))
        if found.aim:
            ways[-1].met = getattr(made, "stroke", None)
        return made

    robot.gesture = watched  # type: ignore[method-assign]
    robot.on_event = lambda kind, data: planned.append(data) if kind == "stroke" else None
    steps = say(robot, text)
    for _ in steps:
        beside()
        for _ in range(round(period / FINE)):
            robot.step(FINE)
            for way in ways:
                if way.targets:
                    way.look(robot)
    assert len(planned) == len(ways)
    return [
        Met(way.name, 99.0 if way.met is None else way.met - way.at, data["stroke"] - data["word"])
        for way, data in zip(ways, planned, strict=True)
    ]
