"""Commands that people speak: said back, and done when they are confirmed."""

from __future__ import annotations

from contextlib import suppress
from inspect import isgenerator
from typing import Protocol

from btlang.actions.conversation import MEANINGS, answers, listened, meaning_of
from btlang.actions.motion import Steps
from btlang.actions.speech import say
from btlang.actions.strokes import Presenting
from btlang.actions.watch import Driving
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import Conversing, RobotError


class Obeying(Conversing, Presenting, Driving, Protocol):
    """A robot that obeys spoken commands."""


def do_what_somebody_says(robot: Obeying) -> Steps:
    """Waits for a command, asks "Shall I ...?" and does it after a yes. Fails after a no, and where nobody answers."""
    commands = robot.ears.commands
    if commands is None:
        raise ActionFailed("the mission has no words that could be spoken")
    act = None

    def reads(text: str) -> bool:
        nonlocal act
        with suppress(RobotError):  # people also say other things
            act = commands.read(text)
        return act is not None

    yield from listened(robot, "", reads, commands.expected(robot))
    assert act is not None
    text = robot.ears.answer
    question = f"Shall I {text.rstrip('.!')}?"
    yield from say(robot, question)
    expected = answers(MEANINGS, robot.body)
    yield from listened(robot, question, lambda text: meaning_of(text) in MEANINGS, expected)
    if meaning_of(robot.ears.answer) == "no":
        raise ActionFailed(f"nobody wants it to {text}")
    steps = act(robot)
    if isgenerator(steps):
        yield from steps
