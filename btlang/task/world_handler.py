"""What people in the robot's world do by commands: they answer its questions, speak to it, and visitors come."""

from __future__ import annotations

from collections.abc import Callable

from btlang.robots.robot import RobotError
from btlang.run.world_input import WorldInput
from btlang.session import Session
from btlang.task import messages
from btlang.task.checks import refused
from btlang.task.messages import Answer, wrong

_HOLD, _RELEASE = "hold", "release"
_LONGEST = 500  # characters of an answer


class WorldHandler:
    """Commands that act on the world of the robot; for any thread. `world_input` is a sink of all runs."""

    def __init__(self, session: Session, world_input: WorldInput) -> None:
        self._session, self._world_input = session, world_input

    def answer(self, command: messages.AnswerQuestion, person: str) -> Answer:
        """What the robot hears after its question."""
        text = command.text.strip()
        if not 0 < len(text) <= _LONGEST:
            raise wrong(command.tag, f"it needs a text of 1 to {_LONGEST} characters")
        question = self._world_input.question
        if not question:
            raise refused("The robot", "isn't asking anything")
        self._world_input.type(text)
        return Answer(True, "The robot hears that.", {"question": question})

    def talk(self, command: messages.Talk, person: str) -> Answer:
        """Somebody holds the button to talk, or lets go of it."""
        if command.act not in (_HOLD, _RELEASE):
            raise wrong(command.tag, f"'act' must be '{_HOLD}' or '{_RELEASE}', not '{command.act}'")
        held = command.act == _HOLD
        push = _button(self._session)
        if push is None:
            raise refused("The robot", 'has no microphone that waits for a button: "push" of its ears')
        push(held)
        return Answer(True, "The robot listens." if held else "The robot has heard it.", {})

    def invite(self, command: messages.InviteVisitor, person: str) -> Answer:
        """Somebody comes into a simulated world."""
        if not takes_visitors(self._session):
            raise refused("The robot", "isn't in a simulated world, so no visitor can be made to come")
        self._world_input.invite()
        return Answer(True, "A visitor comes.", {})


def takes_talk(session: Session) -> bool:
    """Whether somebody who speaks to it has to hold a button."""
    return _button(session) is not None


def takes_visitors(session: Session) -> bool:
    """Whether visitors can be made to come: the robot's world is simulated."""
    return hasattr(session.robot, "invite")


def _button(session: Session) -> Callable[[bool], object] | None:
    try:
        return session.robot.ears.talk  # type: ignore[no-any-return]
    except (AttributeError, RobotError):  # it has no ears
        return None
