"""Saying takes time, printing does not."""

from __future__ import annotations

from btlang.actions.motion import Steps
from btlang.actions.strokes import Presenting, Strokes
from btlang.actions.watch import Watch
from btlang.robots.robot import Voice
from btlang.speech.marks import Mark, read_marks, sentence_start

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def say(robot: Presenting, text: str, kept: dict[str, Any] | None = None) -> Steps:
    """Speaks the text to its end, with the gestures of its marks; halted, falls silent and lets its joints rest.

    Suspended, it begins again with the sentence in which it was.
    """
    watch, kept = Watch(robot), {} if kept is None else kept
    whole, marks = read_marks(text)
    begin = kept["begin"] if kept.get("text") == whole else 0
    if 0 < begin == len(whole):
        return
    kept.update(text=whole, begin=begin)
    plain = whole[begin:]
    strokes = Strokes(robot, [Mark(mark.words, mark.index - begin) for mark in marks if mark.index >= begin])
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


def report_back(robot: Presenting) -> Steps:
    """Says that the robot is done."""
    yield from say(robot, "I am done.")


def _begun(robot: Voice, text: str) -> int:
    """Where the sentence of a text begins that it is in; behind the last one when all is said."""
    if robot.said is None or robot.said.text != text:
        return 0
    if not robot.speaking:
        return len(text)
    word = robot.said.word_at(robot.time - robot.said_at)
    return 0 if word is None else sentence_start(text, word.start)


def speak_language(robot: Voice, language: str) -> None:
    """What is said from now on is in this language, such as "es", to the end of the mission."""
    robot.speak_in(language)


def print_text(robot: Voice, text: str) -> None:
    """Shows the text."""
    robot.print(text)
