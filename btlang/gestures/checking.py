"""What a body can't do of a gesture, or not as fast as its file says, at the key frame where that begins."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.files import read_source
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture
from btlang.robots.bodies.gesture_file import GestureError, load_gestures
from btlang.robots.files import as_mission_error, locate_problems
from btlang.robots.simulation.rehearsal import Rehearsal, rehearse
from btlang.text.source import Source, Span
from btlang.text.toml import find_positions
from btlang.text.toml_table import Problem

_SLOWED = 1.02  # times as long


def check_file(path: str, body: Body) -> Iterator[Diagnostic]:
    """Return what is wrong with a gesture file for a body (BT076), and what would be slowed (BT077)."""
    source = read_source(path)
    try:
        gestures = load_gestures(source, body.joints)
    except GestureError as error:
        yield from as_mission_error(error).diagnostics
        return
    for gesture in gestures:
        yield from check_gesture(gesture, body, source)


def check_gesture(gesture: Gesture, body: Body, source: Source) -> Iterator[Diagnostic]:
    """Return what is wrong with a gesture that was read, like `check_file`."""
    rehearsal = rehearse(body, gesture)
    if not rehearsal.problem and rehearsal.slower <= _SLOWED:
        return
    index = _first(gesture, body, rehearsal)
    if rehearsal.problem:
        says = f"{gesture.name}: {rehearsal.problem}"
        for error in locate_problems([Problem(says, "frame", index, "at")], source, source.name, GestureError):
            yield from as_mission_error(error).diagnostics
        return
    found = find_positions(source.text)
    start = found.get(("frame", index, "at"), 0)
    end = start + len(source.text[start:].partition("\n")[0])
    slower = f"{rehearsal.slower:.2g}"
    yield diagnostic("BT077", Span(source, start, end), name=gesture.name, slower=slower)


def _first(gesture: Gesture, body: Body, whole: Rehearsal) -> int:
    """Return the number in the file of the first key frame up to which it goes wrong as the whole gesture does."""
    for count in range(1, len(gesture.frames)):
        part = rehearse(body, _until(gesture, count))
        if part.problem if whole.problem else part.slower > _SLOWED:
            return _written(gesture, count - 1)
    return _written(gesture, len(gesture.frames) - 1)


def _until(gesture: Gesture, count: int) -> Gesture:
    frames = gesture.frames[:count]
    made: Gesture = gesture.replace(frames=frames, stroke=min(gesture.stroke, frames[-1].at))
    return made


def _written(gesture: Gesture, index: int) -> int:
    """Return the place of a repeated key frame, which is in the file once."""
    written = list(dict.fromkeys(id(frame.joints) for frame in gesture.frames))
    return written.index(id(gesture.frames[index].joints))
