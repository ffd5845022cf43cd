"""The body of a robot as it is by now, for those who watch: its joints, and the word that it says."""

from __future__ import annotations

from functools import partial

from btlang.run.robot_state import asked

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Joint

_PERIOD = 0.1  # seconds between two looks at the joints


class BodyNow:
    """`joints` are those of links, in the order of the body's URDF: radians and metres, None for one that isn't known.
    `speech` is the text that is spoken, "" for none, with where the word of now begins and ends.
    """

    def __init__(self) -> None:
        self.joints: list[float | None] = []
        self.speech: tuple[str, int, int] = ("", 0, 0)
        self._next = 0.0

    def look(self, robot: Any, wall: float) -> None:
        """Takes in how the robot is now. For the thread of the run."""
        self.speech = asked(lambda: _speech(robot)) or ("", 0, 0)
        if wall < self._next:
            return
        self._next = wall + _PERIOD
        joints = [joint for joint in getattr(getattr(robot, "body", None), "joints", ()) if joint.link]
        self.joints = [asked(partial(_position, robot, joint)) for joint in joints]


def _position(robot: Any, joint: Joint) -> float:
    return round(float(robot.joint(joint.name)) * joint.si, 3)


def _speech(robot: Any) -> tuple[str, int, int] | None:
    """None where it says nothing, or not yet."""
    said, now = robot.said, robot.time - robot.said_at
    if said is None or now < 0 or not robot.speaking:
        return None
    word = said.word_at(now)
    return (said.text, 0, 0) if word is None else (said.text, word.start, word.end)
