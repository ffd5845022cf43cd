"""The words that a robot brings: those of its components and its gestures."""

from __future__ import annotations

from btlang.components.component import ComponentError
from btlang.components.location import words_file
from btlang.robots.body_file import unusable_robot
from btlang.robots.gesture_words import gesture_words
from btlang.robots.registry import body_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.text.source import Source


def robot_words(robot: str | Source) -> list[str]:
    """The keyword files of the components of a robot, as --robot names it, and that of its gestures. Imports no class.

    Raises as btlang.robots.registry.body_of, and MissionError (BT071) for a component that isn't installed, or (BT076)
    for a gesture whose phrase means something else.
    """
    body = body_of(robot)
    try:
        files = [words_file(part.place, body.folder) for part in body.components if part.node is None]
    except ComponentError as problem:
        raise unusable_robot(problem) from None
    return [file for file in dict.fromkeys((*files, gesture_words(body))) if file is not None]
