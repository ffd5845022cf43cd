"""Reads and checks gesture files (TOML): key frames, names and mirror images. docs/gestures.md has all keys."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence

from btlang.diagnostics.files import is_below, real_path
from btlang.robots.bodies.body import Joint
from btlang.robots.bodies.gesture import BEARING, BEARINGS, OPPOSITE, Gesture, KeyFrame, Step
from btlang.robots.bodies.joint_tables import step
from btlang.robots.files import DataFileError, all_of, load_data
from btlang.text.source import Source
from btlang.text.toml_table import Problem, Problems, Table
from btlang.vocabulary.pattern import Form, PatternError, Slot, forms, spelled

_SIDES = {"left": "right", "right": "left"}
TARGET = "target"
"""The slot of phrases for the target of a gesture."""
ARTICLES = frozenset(("the", "a", "an"))
NEARER = "nearer"
_SHORTEST = 0.05  # seconds to a key frame
_LONGEST = 60.0  # seconds of a gesture
_MOST_FRAMES = 500
_MOST_ROUNDS = 50
_FRAME_KEYS = ("at", "hold")


def swap_sides(words: str) -> str:
    """Return a text with "right" and "left" swapped."""
    return re.sub(r"\b(left|right)\b", lambda match: _SIDES[match[1]], words)


def mirror(gesture: Gesture, joints: Sequence[Joint]) -> Gesture:
    """Return the mirror image of a gesture. Raises ValueError for a joint without another side."""
    known = {joint.name: joint for joint in joints}
    frames = tuple(frame.replace(joints=_step(frame.joints, known)) for frame in gesture.frames)
    made: Gesture = gesture.replace(
        name=swap_sides(gesture.name), frames=frames, phrases=tuple(map(swap_sides, gesture.phrases)),
        help=swap_sides(gesture.help), aim=swap_sides(gesture.aim),
    )  # fmt: skip
    return made


def _step(step: Step, known: Mapping[str, Joint]) -> Step:
    found: dict[str, float | str] = {}
    for name, value in step.items():
        sense, other = _sense(known[name], known), known[swap_sides(name)]
        if value in BEARINGS:  # what it is turned to stays where it is
            found[other.name] = value if sense < 0 else BEARING if value == OPPOSITE else OPPOSITE
        else:
            angle = sense * float(value)
            if not other.low <= angle <= other.high:
                raise ValueError(
                    f'the other side can\'t do this: "{other.name}" goes from {other.low:g} to {other.high:g}'
                )
            found[other.name] = angle
    return found


def _sense(joint: Joint, known: Mapping[str, Joint]) -> float:
    """Return 1 if the mirror image of a movement has the same sign, else -1."""
    other = known.get(swap_sides(joint.name))
    if other is None:
        raise ValueError(f'there is no joint "{swap_sides(joint.name)}" to mirror "{joint.name}"')
    if not (joint.link and other.link):
        if other is joint:
            raise ValueError(f'"{joint.name}" can\'t be mirrored, because it has no axis')
        return 1.0
    (x, y, z), axis = joint.axis, other.axis
    image = (x, -y, z) if joint.slides else (-x, y, -z)
    return 1.0 if sum(one * another for one, another in zip(image, axis, strict=True)) > 0.0 else -1.0


class GestureError(DataFileError):
    """The reason why a gesture file can't be used."""

    code = "BT076"


def load_gestures(file: str | Source, joints: Sequence[Joint]) -> tuple[Gesture, ...]:
    """Return the gesture of a file or a text for a body with these joints, and its mirror image if the file asks for
    it.

    Its name is that of the file, with blanks for `_`, unless the file gives another. Raises GestureError.
    """
    path = file if isinstance(file, str) else file.name
    stem = os.path.splitext(os.path.basename(path))[0].replace("_", " ").strip() or "gesture"
    made = load_data(file, "a gesture", lambda top: _gestures(top, stem, joints), GestureError)
    return tuple(gesture.replace(file=path) for gesture in made)


def read_gestures(top: Table, joints: Sequence[Joint], file: str) -> dict[str, Gesture]:
    """Return the gestures that a robot file names, by their names; `file` is its path, "" for a text from outside.

    Raises Problem for the key, and GestureError for everything that is wrong in the files.
    """
    found: dict[str, Gesture] = {}
    said: dict[Form, str] = {}
    wrong: list[DataFileError] = []
    for index, name in enumerate(top.texts("gestures")):
        for path in _files(name, file, index):
            try:
                made = load_gestures(path, joints)
                for gesture in made:
                    _check_unique(gesture, path, found, said)
                    found[gesture.name] = gesture
            except GestureError as error:
                wrong += [error, *error.more]
    if wrong:
        raise all_of(wrong)
    return found


def phrase_forms(gesture: Gesture) -> Iterator[Form]:
    """Return all ways to say it, without articles."""
    for phrase in gesture.phrases:
        yield from forms(phrase, ARTICLES)


def _files(name: str, file: str, index: int) -> Sequence[str]:
    folder = os.path.dirname(file)
    path = os.path.join(folder, name)
    if file and is_below(real_path(path), folder):
        path = os.path.relpath(path) if is_below(path, "") else path  # as people see it
        if os.path.isfile(path):
            return [path]
        if os.path.isdir(path):
            return [os.path.join(path, each) for each in sorted(os.listdir(path)) if each.endswith(".toml")]
    raise Problem('"gestures" must be files and folders in the folder of the robot file', "gestures", index)


def _check_unique(gesture: Gesture, path: str, found: Mapping[str, Gesture], said: dict[Form, str]) -> None:
    if gesture.name in found:
        raise GestureError(f'there is another gesture "{gesture.name}"; give one of them another "name"', path)
    for form in phrase_forms(gesture):
        if said.setdefault(form, gesture.name) != gesture.name:
            raise GestureError(
                f'"{spelled(form)}" is said for the gesture "{said[form]}" too; change one of them', path
            )


def _gestures(top: Table, stem: str, joints: Sequence[Joint]) -> tuple[Gesture, ...]:
    problems = Problems()
    name = problems.part(lambda: top.text("name"), stem) if top.has("name") else stem
    usual: tuple[str, ...] = (name,)
    phrases = problems.part(lambda: _phrases(top, name), usual)
    about = problems.part(lambda: top.text("help"), "") if top.has("help") else ""
    known = {joint.name: joint for joint in joints if joint.name not in _FRAME_KEYS}
    frames = [frame for frame in problems.rows(top, "frame", lambda table: _frame(table, known)) if frame is not None]
    problems.end()
    if not frames:
        raise Problem("a gesture needs key frames; write [[frame]] and below it at = 0.5 and joints with their angles")
    _check_times(frames, problems)
    rounds = problems.part(lambda: _repeat(top, frames), None)
    stroke = problems.part(lambda: top.number("stroke", frames[0].at, low=0.0, high=_end(frames)), 0.0)
    least = problems.part(lambda: top.number("least", 0.7, low=0.2, high=1.0), 0.7)
    most = problems.part(lambda: top.number("most", 1.5, low=1.0, high=10.0), 1.5)
    aim = problems.part(lambda: _aim(top, joints), "")
    problems.end()
    if rounds is not None:
        begin, end, times = rounds
        more = (times - 1) * (end - begin)
        stroke += more if stroke > end else 0.0
        frames = _repeat_frames(frames, begin, end, times)
    if len(frames) > _MOST_FRAMES or _end(frames) > _LONGEST:
        raise Problem(f"a gesture takes at most {_LONGEST:g} seconds and has at most {_MOST_FRAMES} key frames")
    made = Gesture(name, tuple(frames), stroke, phrases, about, aim, least, most)
    _check_target(top, made)
    return top.finish(_both_sides(top, made, joints))


def _phrases(top: Table, name: str) -> tuple[str, ...]:
    found: tuple[str, ...] = (name,)
    if top.has("phrase"):
        found = top.texts("phrase") if top.is_list("phrase") else (top.text("phrase"),)
    try:
        parts = {part for text in found for form in forms(text, ARTICLES) for part in form}
    except PatternError as error:
        raise top.problem("phrase", str(error)) from None
    if any(isinstance(part, Slot) and part.name != TARGET for part in parts):
        raise top.problem("phrase", f'the slot of a gesture is {{{TARGET}}}; write phrase = "point at {{{TARGET}}}"')
    if not found:
        raise top.problem("phrase", f'"phrase" must be one phrase or a list of them; write phrase = "{name}"')
    return found


def _frame(table: Table, known: Mapping[str, Joint]) -> KeyFrame:
    at = table.number("at", low=_SHORTEST, high=_LONGEST)
    hold = table.number("hold", 0.0, low=0.0, high=_LONGEST)
    joints = step(table, known, _FRAME_KEYS)
    if not joints:
        raise table.problem("at", 'a key frame needs joints; write "head tilt" = -15, or the like')
    return KeyFrame(at, joints, hold)


def _end(frames: Sequence[KeyFrame]) -> float:
    return frames[-1].at + frames[-1].hold


def _check_times(frames: Sequence[KeyFrame], problems: Problems) -> None:
    for index, frame in enumerate(frames[1:], 1):
        earliest = frames[index - 1].at + frames[index - 1].hold + _SHORTEST
        if frame.at < earliest - 1e-9:
            says = f"key frames follow each other: this one must be at {earliest:g} or later, not at {frame.at:g}"
            problems.found.append(Problem(says, "frame", index, "at"))


def _repeat(top: Table, frames: Sequence[KeyFrame]) -> tuple[float, float, int] | None:
    """Return the part of the gesture to repeat: from a time to a time, and how often."""
    if not top.has("repeat"):
        return None
    table = top.table("repeat")
    begin = table.number("from", low=0.0, high=_end(frames))
    end = table.number("to", low=begin + _SHORTEST, high=_end(frames))
    times = table.number("times", low=1, high=_MOST_ROUNDS)
    if not times.is_integer():
        raise table.problem("times", '"times" must be a whole number; write times = 2')
    if not any(begin < frame.at <= end for frame in frames):
        raise table.problem("from", "there is no key frame between these times")
    cut = next((frame for frame in frames if frame.at <= end < frame.at + frame.hold), None)
    if cut is not None:
        raise table.problem("to", f"the key frame at {cut.at:g} is held until {cut.at + cut.hold:g}; repeat up to then")
    return table.finish((begin, end, int(times)))


def _repeat_frames(frames: Sequence[KeyFrame], begin: float, end: float, times: int) -> list[KeyFrame]:
    long = end - begin
    before = [frame for frame in frames if frame.at <= begin]
    inside = [frame for frame in frames if begin < frame.at <= end]
    after = [frame for frame in frames if frame.at > end]
    rounds = [frame.replace(at=frame.at + turn * long) for turn in range(times) for frame in inside]
    return [*before, *rounds, *(frame.replace(at=frame.at + (times - 1) * long) for frame in after)]


def _aim(top: Table, joints: Sequence[Joint]) -> str:
    parts = tuple(dict.fromkeys(joint.part for joint in joints if joint.link))
    return top.choice("aim", parts) if top.has("aim") else ""


def _check_target(top: Table, gesture: Gesture) -> None:
    turns = any(value in BEARINGS for frame in gesture.frames for value in frame.joints.values())
    if any(Slot(TARGET) in form for form in phrase_forms(gesture)) and not (gesture.aim or turns):
        says = f'a gesture with a {{{TARGET}}} needs to know what points at it; write aim = "right arm"'
        raise top.problem("phrase", says)


def _both_sides(top: Table, gesture: Gesture, joints: Sequence[Joint]) -> tuple[Gesture, ...]:
    if not top.has("mirror"):
        return (gesture,)
    nearer = top.is_text("mirror") and top.choice("mirror", (NEARER,)) == NEARER
    if not (nearer or top.flag("mirror")):
        return (gesture,)
    try:
        image = mirror(gesture, joints)
    except ValueError as problem:
        raise top.problem("mirror", str(problem)) from None
    if nearer:
        if not gesture.aim or swap_sides(gesture.aim) == gesture.aim:
            raise top.problem("mirror", f'mirror = "{NEARER}" is for an "aim" that is left or right')
        return (gesture.replace(other=image),)
    if image.name == gesture.name:
        raise top.problem("mirror", f'mirror = true needs "left" or "right" in the name, not "{gesture.name}"')
    return gesture, image
