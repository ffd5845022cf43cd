"""Gestures: key frames in time, as their files describe them. Frozen data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from btlang.support.record import Record

BEARING = "bearing"
"""In a posture the angle towards what the robot points or looks at."""
OPPOSITE = "-bearing"
"""As BEARING, for a joint that turns to the right where its angle grows."""
BEARINGS = (BEARING, OPPOSITE)

Step = Mapping[str, float | str]
"""Joint -> degrees (metres where it slides) or one of BEARINGS."""


def angle_of(value: float | str, bearing: float) -> float:
    """The angle of a joint in a step, where what the robot turns to is `bearing` degrees to the left."""
    return -bearing if value == OPPOSITE else bearing if value == BEARING else float(value)


def joints_of(wanted: Gesture | Sequence[Step]) -> tuple[str, ...]:
    """The names of the joints in a gesture, or in the steps of a posture."""
    steps = [frame.joints for frame in wanted.frames] if isinstance(wanted, Gesture) else wanted
    return tuple(dict.fromkeys(name for step in steps for name in step))


class KeyFrame(Record):
    """Where some joints are `at` so many seconds of the gesture, for `hold` seconds. The others stay where they are."""

    at: float
    joints: Step
    hold: float = 0.0


class Gesture(Record):
    """`stroke` is the second of the gesture that its meaning is in, such as the lowest point of a bow.

    The way to the stroke may take `least` to `most` times as long as its key frames say, so that the stroke meets a
    word. `aim` is the part of the body, such as "right arm", that points at what the phrase names: its joints are found
    by geometry at the stroke. `phrases` are those of the word, `help` says what it is. `other` is what is done instead
    where the target is on the other side of the robot than the part that points at it. `file` is where it comes from.
    """

    name: str
    frames: tuple[KeyFrame, ...]
    stroke: float
    phrases: tuple[str, ...] = ()
    help: str = ""
    aim: str = ""
    least: float = 0.7
    most: float = 1.5
    other: Gesture | None = None
    file: str = ""

    def towards(self, bearing: float) -> Gesture:
        """That of the side that is nearer to what is `bearing` degrees to the left."""
        is_left = self.aim.startswith("left")
        return self if self.other is None or bearing == 0.0 or is_left == (bearing > 0.0) else self.other

    @property
    def seconds(self) -> float:
        """How long it takes where no limit of the body slows it down."""
        return self.frames[-1].at + self.frames[-1].hold

    @property
    def stroke_frame(self) -> int:
        """The number of the key frame that the stroke is in, or that is nearest to it."""
        stroke = self.stroke
        apart = [max(frame.at - stroke, stroke - frame.at - frame.hold, 0.0) for frame in self.frames]
        return apart.index(min(apart))
