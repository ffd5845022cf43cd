"""Gestures: key frames in time, as their files describe them. Frozen data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from btlang.support.record import Record

BEARING = "bearing"
"""In a posture, the angle towards the target of the robot."""
OPPOSITE = "-bearing"
"""The same for a joint that turns to the right when its angle grows."""
BEARINGS = (BEARING, OPPOSITE)

Step = Mapping[str, float | str]
"""Joint -> degrees (metres if it slides) or one of BEARINGS."""


def angle_of(value: float | str, bearing: float) -> float:
    """Return the angle of a joint in a step, for a target `bearing` degrees to the left."""
    return -bearing if value == OPPOSITE else bearing if value == BEARING else float(value)


def joints_of(wanted: Gesture | Sequence[Step]) -> tuple[str, ...]:
    """Return the names of the joints in a gesture, or in the steps of a posture."""
    steps = [frame.joints for frame in wanted.frames] if isinstance(wanted, Gesture) else wanted
    return tuple(dict.fromkeys(name for step in steps for name in step))


class KeyFrame(Record):
    """The positions of some joints at a second of the gesture, kept for `hold` seconds. The
    others stay where they are.
    """

    at: float
    joints: Step
    hold: float = 0.0


class Gesture(Record):
    """A gesture: key frames in time, and the words for it.

    `stroke` is the second of the gesture that carries its meaning, such as the lowest point of a bow. The motion to the
    stroke may take `least` to `most` times as long as in the key frames, so that the stroke meets a word. `aim` is the
    part of the body, such as "right arm", that points at what the phrase names: its joints are found by geometry at the
    stroke. `phrases` are those of the word, `help` describes it. `other` is the gesture to do instead if the target is
    on the other side than the part that points at it. `file` is where it comes from.
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
        """Return the gesture of the side that is nearer to a target `bearing` degrees to the left."""
        is_left = self.aim.startswith("left")
        return self if self.other is None or bearing == 0.0 or is_left == (bearing > 0.0) else self.other

    @property
    def seconds(self) -> float:
        """The seconds that it takes if no limit of the body slows it down."""
        return self.frames[-1].at + self.frames[-1].hold

    @property
    def stroke_frame(self) -> int:
        """The number of the key frame of the stroke, or of the nearest one."""
        stroke = self.stroke
        apart = [max(frame.at - stroke, stroke - frame.at - frame.hold, 0.0) for frame in self.frames]
        return apart.index(min(apart))
