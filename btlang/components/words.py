"""The words that a robot brings, those of its components and gestures, and whether they fit their classes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

from btlang.components.component import ComponentError
from btlang.components.location import words_file
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.registry import body_of
from btlang.text.source import NOWHERE
from btlang.vocabulary.entry import COMPARISONS, MEASURED
from btlang.vocabulary.load import load_vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body
    from btlang.text.source import Source
    from btlang.vocabulary.entry import Entry

_SERVICES = ("robot", "halted")
"""Parameters of methods that no slot fills."""


def robot_words(robot: str | Source) -> list[str]:
    """Return the keyword files of a robot as --robot names it. Raises as `words_of` and `body_of`."""
    return words_of(body_of(robot))


def words_of(body: Body) -> list[str]:
    """Return the keyword files of the components of a body, and that of its gestures. Imports no class.

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


def check_words(path: str, methods: Mapping[str, Mapping[str, Any]]) -> Iterator[Diagnostic]:
    """Return the problems of a keyword file (BT060 to BT064, BT080) with the methods of each component by its place.

    Methods are as in btlang.components.location.describe.
    """
    try:
        vocabulary = load_vocabulary([path])
    except MissionError as error:
        yield from error.diagnostics
        return
    for entry in chain(*vocabulary.entries.values()):
        reason = _reason(entry, methods) if entry.file == path else ""
        if reason:
            yield diagnostic("BT080", entry.span or NOWHERE, id=entry.id, reason=reason)


def _reason(entry: Entry, methods: Mapping[str, Mapping[str, Any]]) -> str:
    """Return why a component's method can't do a word, "" if it can, or if no component does it."""
    place, _, name = entry.call.rpartition(".") if isinstance(entry.call, str) else ("", "", "")
    if place not in methods:
        modules = {known.partition(":")[0] for known in methods}
        is_near = ":" in place and place.partition(":")[0] in modules
        return f"the robot has no component of the class {place}" if is_near else ""
    if name not in methods[place]:
        return f"{place} has no method {name}"
    takes, required, takes_all = (methods[place][name][key] for key in ("takes", "required", "takes_all"))
    slots = [slot.name for slot in entry.slots if slot.name not in (*COMPARISONS, MEASURED)]
    more = [slot for slot in slots if slot not in takes]
    if more and not takes_all:
        return f"{entry.call} takes no parameter {more[0]}"
    lacks = [each for each in required if each not in (*slots, *_SERVICES)]
    return f"{entry.call} has a parameter {lacks[0]}, which is no slot and has no default" if lacks else ""
