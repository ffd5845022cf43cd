"""The words that a robot brings: those of its components and its gestures."""

from __future__ import annotations

from btlang.components.component import ComponentError
from btlang.components.location import words_file
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.registry import body_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.bodies.body import Body
    from btlang.text.source import Source


def robot_words(robot: str | Source) -> list[str]:
    """As `words_of`, of a robot as --robot names it. Raises as btlang.robots.registry.body_of, too."""
    return words_of(body_of(robot))


def words_of(body: Body) -> list[str]:
    """The keyword files of the components of a body, and that of its gestures. Imports no class.

    Raises MissionError (BT071) for a component that isn't installed, or (BT076) for a gesture whose phrase means
    something else.
    """
    try:
        files = [words_file(part.place, body.folder) for part in body.components if part.node is None]
    except ComponentError as problem:
        raise unusable_robot(problem) from None
    if body.gestures:
        from btlang.robots.bodies.gesture_words import gesture_words  # most robots have none

        files.append(gesture_words(body))
    return [file for file in dict.fromkeys(files) if file is not None]
