"""Asking and listening, and commands that people speak. What was heard last is the answer."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache, lru_cache
from importlib.resources import files
from inspect import isgenerator
from typing import Protocol

from btlang.actions.common import DrivingRobot, Watch, compares
from btlang.actions.motion import Steps
from btlang.actions.speech import PresentingRobot, say
from btlang.engine.leaves.leaf import ActionFailed, Failed, Unknown
from btlang.robots.bodies.body import Body
from btlang.robots.ears import HeardText
from btlang.robots.robot import Conversing, Listening, RobotError
from btlang.robots.worlds.world import said
from btlang.speech.marks import without_marks
from btlang.speech.recogniser import Expected, spoken
from btlang.text.source import Source
from btlang.text.words import split

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


WAITS = 60.0
"""Seconds of the mission in which somebody has to answer."""
MEANINGS = ("yes", "no")


class QuestioningRobot(Conversing, PresentingRobot, Protocol):
    """A robot that asks, with gestures."""


def ask(robot: QuestioningRobot, question: str, person: str | None = None, kept: dict[str, Any] | None = None) -> Steps:
    """Ask a person, or anybody, and wait for the answer. Fails after a minute without one."""
    robot.ears.answer = ""  # the answer to an earlier question is none to this one, even if nobody can be asked
    if person is not None:
        robot.locate(person)  # nobody is asked whom the robot hasn't seen
    yield from say(robot, question, kept)
    expected = answers(robot.ears.choices, robot.body)
    yield from listen(robot, without_marks(question), lambda text: True, expected, person)


def listen_for_yes_or_no(robot: Listening) -> Steps:
    """Wait until somebody says yes or no. Fails after a minute."""
    yield from listen(robot, "", lambda text: meaning_of(text) in MEANINGS, answers(MEANINGS, robot.body))


def listen_for(robot: Listening, text: str) -> Steps:
    """Wait until somebody says these words, maybe among others. Fails after a minute."""
    yield from listen(robot, "", lambda heard: holds(heard, text), answers((text,), robot.body))


def answer_is(robot: Listening, text: str) -> bool | Failed:
    """Return whether the last answer has these words, or means the same: "yes" is also "sure" and "of course"."""
    answer = robot.ears.answer
    if not answer:
        return Failed(lambda: "nobody has answered")
    return holds(answer, text) or Failed(lambda: f'the answer was "{answer}"')


def answer_number(
    robot: Listening,
    at_least: float | None = None,
    above: float | None = None,
    at_most: float | None = None,
    below: float | None = None,
) -> bool | Failed:
    """Return whether the first number in the last answer is as a limit says. Fails if there is none."""
    heard = robot.ears.answer
    if not heard:
        return Failed(lambda: "nobody has answered")
    found = _number_in(heard)
    if found is None:
        raise ActionFailed(f'there is no number in the answer "{heard}"')
    return compares(found, below, above, at_least, at_most, None) or Failed(lambda: f'the answer was "{heard}"')


def _number_in(answer: str) -> float | None:
    """Return the first number of an answer, in figures or in English words."""
    from btlang.vocabulary.load import load_vocabulary  # hardly ever

    vocabulary = load_vocabulary()
    text = split(Source(answer), vocabulary.orthography)
    read = (vocabulary.values.number(text, at) for at in range(len(text.words)))
    return next((number for number, _ in filter(None, read)), None)


def nobody_answered(robot: Listening) -> bool | Failed:
    """Return whether the last question had no answer."""
    heard = robot.ears.answer
    return not heard or Failed(lambda: f'the answer was "{heard}"')


def answer(robot: Listening) -> str:
    """Return the words of the last answer. Fails if there is none."""
    if not robot.ears.answer:
        raise ActionFailed("nobody has answered")
    return robot.ears.answer


def has_heard(robot: Listening, text: str) -> bool:
    """Return whether somebody has said these words, maybe among others.

    Unknown if they weren't heard and hearing fails.
    """
    robot.ears.news(text, robot.time)  # it listens for them
    return _among(robot, robot.ears.since(0), text)


def somebody_says(robot: Listening, text: str) -> bool:
    """Return whether somebody has said these words since the last check. Unknown as in `has_heard`."""
    return _among(robot, robot.ears.news(text, robot.time), text)


def person_says(robot: Listening, person: str, text: str) -> bool:
    """Return the same for one person. A speaker whose voice isn't recognised may be that person."""
    heard = robot.ears.news(text, robot.time)
    return _among(robot, [each for each in heard if each.who in (person, "")], text)


def somebody_speaks(robot: Listening) -> bool:
    """Return whether somebody has said anything since the last check. Unknown as in `has_heard`."""
    return somebody_says(robot, "")


def person_speaks(robot: Listening, person: str) -> bool:
    """Return the same for one person, as in `person_says`."""
    return person_says(robot, person, "")


def answers(texts: Iterable[str], body: Body) -> Expected:
    """Return what to listen for as one of these answers: the words, politely or not, and all that means yes or no.

    Without any answers, it is whatever is said.
    """
    language = body.ears.settings.language.partition("-")[0] if body.ears is not None else ""
    forms = _answers().get(language, _answers()["en"])
    phrases: dict[str, None] = {}
    others: dict[str, None] = {}
    for text in texts:
        meaning = meaning_of(text)
        if meaning in MEANINGS:  # both: who says no to ears that only know forms of yes would be heard to say one
            phrases.update(dict.fromkeys(spoken(form) for each in MEANINGS for form in forms[each]))
            others.update(dict.fromkeys(spoken(form) for each in MEANINGS for form in forms.get(f"written_{each}", ())))
        elif words := spoken(text):
            phrases[f"[i would like/want] [a/an/the/some] {words} [please]"] = None
            phrases[f"i'd like [a/an/the/some] {words} [please]"] = None
    return Expected(tuple(phrases), anything=not phrases, others=tuple(others))


def holds(heard: str, text: str) -> bool:
    """Return whether what was heard has the words of a text in their order, or means the same yes or no."""
    meaning = meaning_of(text)
    if meaning in MEANINGS:
        return meaning_of(heard) == meaning
    words, wanted = _words(heard), _words(text)
    return any(words[at : at + len(wanted)] == wanted for at in range(len(words) - len(wanted) + 1))


@lru_cache(maxsize=256)
def meaning_of(text: str) -> str:
    """Return "yes" or "no" for a text that means that, else the text.

    The longest phrase counts: "I do" is yes, "I do not" isn't.
    """
    words = _words(text)
    found = [(len(phrase), meaning) for phrase, meaning in _forms() if words[: len(phrase)] == phrase]
    return max(found)[1] if found else text


def _among(robot: Listening, heard: Iterable[HeardText], text: str) -> bool:
    found = any(holds(each.text, text) for each in heard)
    if not found and robot.ears.problem:
        raise Unknown(f"the ears don't work: {robot.ears.problem}")
    return found


@cache
def _forms() -> list[tuple[list[str], str]]:
    """Return the words of what means yes or no, in all languages."""
    meanings = (each for by_language in _answers().values() for each in by_language.items())
    return [(phrase.split(), key.removeprefix("written_")) for key, phrases in meanings for phrase in phrases]


@cache
def _answers() -> dict[str, dict[str, list[str]]]:
    """Return the phrases by language, then by "yes", "no", "written_yes" and "written_no"."""
    return tomllib.loads(files("btlang.actions").joinpath("answers.toml").read_text(encoding="utf-8"))


def _words(text: str) -> list[str]:
    return "".join(letter if letter.isalnum() or letter == "'" else " " for letter in text.lower()).split()


def listen(
    robot: Listening,
    question: str,
    wanted: Callable[[str], bool],
    expected: Expected,
    person: str | None = None,
) -> Steps:
    """Wait for the first text that is wanted, which is then the answer. Fails after a minute without one."""
    watch, ears = Watch(robot), robot.ears
    ears.answer = ""
    count, until = ears.count, robot.time + WAITS
    robot.ask(question, person or "")
    try:
        with ears.expect(expected):
            while True:
                for heard in ears.since(count):
                    if wanted(heard.text) and (person is None or heard.who in (person, "")):
                        ears.answer = heard.text
                        return
                if robot.time > until:
                    raise ActionFailed(f"{said(person)} didn't answer" if person else "nobody answered")
                count = ears.count
                yield
                watch.check_stop()
    finally:
        ears.asking = ""


class ObeyingRobot(Conversing, PresentingRobot, DrivingRobot, Protocol):
    """A robot that obeys spoken commands."""


def do_what_somebody_says(robot: ObeyingRobot) -> Steps:
    """Wait for a command, ask "Shall I ...?" and do it after a yes. Fails after a no, and without an answer."""
    commands = robot.ears.commands
    if commands is None:
        raise ActionFailed("the mission has no words that could be spoken")
    act = None

    def reads(text: str) -> bool:
        nonlocal act
        with suppress(RobotError):  # people also say other things
            act = commands.read(text)
        return act is not None

    yield from listen(robot, "", reads, commands.expected(robot))
    assert act is not None
    text = robot.ears.answer
    question = f"Shall I {text.rstrip('.!')}?"
    yield from say(robot, question)
    expected = answers(MEANINGS, robot.body)
    yield from listen(robot, question, lambda text: meaning_of(text) in MEANINGS, expected)
    if meaning_of(robot.ears.answer) == "no":
        raise ActionFailed(f"nobody wants it to {text}")
    steps = act(robot)
    if isgenerator(steps):
        yield from steps
