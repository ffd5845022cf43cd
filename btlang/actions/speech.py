"""Saying takes time, printing does not."""

from __future__ import annotations

from btlang.actions.motion import Steps
from btlang.actions.watch import Watch
from btlang.robots.capabilities import Voice


def say(robot: Voice, text: str) -> Steps:
    """Speaks the text to its end; halted, falls silent."""
    watch = Watch(robot)
    robot.say(text)
    try:
        while robot.speaking:
            yield
            watch.check_stop()
    finally:
        robot.silence()


def print_text(robot: Voice, text: str) -> None:
    """Shows the text."""
    robot.print(text)
