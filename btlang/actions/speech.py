"""Saying takes time, printing does not. Gestures keep step with what is said: the stroke of each meets its word."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

from btlang.actions.common import Watch
from btlang.actions.motion import Steps
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point
from btlang.robots.preflight import said_gesture
from btlang.robots.robot import Gesturing, Operation, RobotError, Voice
from btlang.speech.marks import GestureMark, read_marks, sentence_start
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_LOOKS_AHEAD = 4.0  # seconds before a word in which the way to a stroke is planned
_PERIOD = 0.2  # seconds to the next tick, as long as none has shown how long that takes
_MOST_COUNTED = 1000
_LATEST = 2.0  # seconds by which speech may begin later, for its first stroke


class PresentingRobot(Voice, Gesturing, Protocol):
    """A robot that speaks, and moves in step with that."""


class Stroke(Record):
    """A gesture, its target, and the index of the text from which its word is looked for."""

    name: str
    aim: Point | None
    index: int


class Strokes:
    """The gestures of one text, one after the other. Call `step` at each tick, `halt` at the end.

    Raises RobotError if the target of one isn't known.
    """

    def __init__(self, robot: PresentingRobot, marks: Sequence[GestureMark]) -> None:
        self._robot = robot
        self._left = [*_strokes(robot, marks)]
        self._going: list[Operation] = []
        self._free_at = 0.0  # when the gesture before has had its stroke
        self._last: float | None = None
        self._period = _PERIOD

    def delay(self, text: str) -> float:
        """Return the seconds to delay speech, so that the first stroke can meet its word."""
        if not self._left or (needed := self._needed(self._left[0])) is None:
            return 0.0
        return min(_LATEST, max(0.0, needed - self._robot.utterance(text).time_of(self._left[0].index)))

    @property
    def busy(self) -> bool:
        """Whether a gesture is to come, or isn't over."""
        for operation in self._going:
            if operation.done and operation.failure is not None:
                self._warn(operation.failure)
        self._going = [operation for operation in self._going if not operation.done]
        return bool(self._left or self._going)

    def step(self) -> None:
        """Start the gestures that have to start before the next tick."""
        robot, now = self._robot, self._robot.time
        if self._last is not None and now > self._last:
            self._period = now - self._last
        self._last = now
        while self._left and robot.said is not None and now > self._free_at - 1e-9:
            stroke = self._left[0]
            word = robot.said.time_of(stroke.index)
            at = robot.said_at + word
            if at - now > _LOOKS_AHEAD:
                return
            needed = self._needed(stroke)
            if needed is None:
                self._left.pop(0)
                continue
            gesture = robot.body.gestures.get(stroke.name)
            usual = needed if gesture is None else max(needed, gesture.stroke)
            if at - now > usual + self._period:
                return
            self._left.pop(0)
            try:
                self._going.append(robot.gesture(stroke.name, aim=stroke.aim, stroke_at=at))
            except RobotError as problem:
                self._warn(f"{stroke.name}: {problem}")
                continue
            self._free_at = max(at, now + needed)
            if robot.on_event is not None:
                met = self._free_at - robot.said_at
                robot.on_event("stroke", {"name": stroke.name, "stroke": round(met, 3), "word": round(word, 3)})

    def halt(self) -> None:
        """Bring the gestures to rest where they are."""
        for operation in self._going:
            operation.cancel()

    def _needed(self, stroke: Stroke) -> float | None:
        """Return the least seconds to the stroke; None, with a warning, if the body can't do it: speech goes on."""
        try:
            return self._robot.lead(stroke.name, stroke.aim)
        except RobotError as problem:
            self._warn(f"{stroke.name}: {problem}")
            return None

    def _warn(self, text: str) -> None:
        if self._robot.on_event is not None:
            self._robot.on_event("warning", {"text": text})


def _strokes(robot: PresentingRobot, marks: Sequence[GestureMark]) -> Iterator[Stroke]:
    """Return the strokes that the robot has. Raises RobotError if a target isn't known."""
    moves = hasattr(robot, "gesture")  # robots of other people may only speak
    for mark in marks:
        found = said_gesture(robot.body, mark.words) if moves else None
        if found is not None:
            yield Stroke(found.name, robot.locate(found.target) if found.target else None, mark.index)
        elif robot.on_event is not None:  # values of the mission brought it
            robot.on_event("warning", {"text": f'the robot has no gesture "{mark.words}"'})


def count_aloud(
    robot: PresentingRobot, start: float = 1.0, number: float = 1.0, kept: dict[str, Any] | None = None
) -> Steps:
    """Say the whole numbers from `start` to `number`, up or down. Fails if these are more than a thousand."""
    first, last = round(start), round(number)
    if abs(last - first) >= _MOST_COUNTED:
        raise ActionFailed(f"counting from {first} to {last} takes too long")
    step = 1 if last >= first else -1
    yield from say(robot, " ".join(f"{each}." for each in range(first, last + step, step)), kept)


def say(robot: PresentingRobot, text: str, kept: dict[str, Any] | None = None) -> Steps:
    """Speak the text to its end, with the gestures of its marks.

    When halted, it falls silent and joints come to rest. Suspended, it begins again with the sentence in which it was.
    """
    watch, kept = Watch(robot), {} if kept is None else kept
    whole, marks = read_marks(text)
    begin = kept["begin"] if kept.get("text") == whole else 0
    if 0 < begin == len(whole):
        return
    kept.update(text=whole, begin=begin)
    plain = whole[begin:]
    strokes = Strokes(robot, [GestureMark(mark.words, mark.index - begin) for mark in marks if mark.index >= begin])
    robot.say(plain, strokes.delay(plain))
    try:
        while True:
            strokes.step()
            if not (robot.speaking or strokes.busy):
                return
            kept["begin"] = begin + _begun(robot, plain)
            yield
            watch.check_stop()
    finally:
        strokes.halt()
        robot.silence()


def report_back(robot: PresentingRobot) -> Steps:
    """Say that the robot is done."""
    yield from say(robot, "I am done.")


def _begun(robot: Voice, text: str) -> int:
    """Return where the current sentence of a text begins; its end when all is said."""
    if robot.said is None or robot.said.text != text:
        return 0
    if not robot.speaking:
        return len(text)
    word = robot.said.word_at(robot.time - robot.said_at)
    return 0 if word is None else sentence_start(text, word.start)


def speak_language(robot: Voice, language: str) -> None:
    """Speak in this language, such as "es", until the end of the mission."""
    robot.speak_in(language)


def print_text(robot: Voice, text: str) -> None:
    """Show the text."""
    robot.print(text)
