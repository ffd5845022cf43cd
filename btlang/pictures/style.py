"""Colours, signs and sizes. Sizes are in points; colour-blind people can distinguish the colours of statuses."""

from __future__ import annotations

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.support.record import Record

INK = "#1f2933"
SOFT = "#6b7680"
LINE = "#8a949e"
PAPER = "#ffffff"

SMALL, TEXT, TITLE = 7.5, 9.0, 11.0
HEADING = 24.0  # room for the title of a picture


BUBBLES = {
    "say": ("#fffdf2", "#9a8f6a"),
    "hear": ("#fdf1f7", "#9c3f74"),
    "call": ("#fde4da", "#c0440c"),
}
"""Fill and edge of what is said: by the robot, by people, and when it calls for help."""


class Look(Record):
    """How a status is shown: its sign, the word for it, a strong colour and a pale one."""

    sign: str
    word: str
    strong: str
    pale: str


SUCCEEDED = Look("✓", "success", "#00785a", "#d3efe4")
FAILED = Look("✗", "failure", "#c0440c", "#fbdccb")
HALTED = Look("‖", "halted", "#9a6a00", "#ffecb8")
UNDER_WAY = Look("▶", "running", "#9a6a00", "#ffecb8")
PASSED_OVER = Look("»", "skipped", "#6b7680", "#e9ecef")
NEVER = Look("", "never reached", "#9aa3ab", "#f6f7f8")

LOOKS = {SUCCESS: SUCCEEDED, FAILURE: FAILED, IDLE: HALTED, RUNNING: UNDER_WAY, SKIPPED: PASSED_OVER}
"""By the last status of a node; IDLE stands for one that was halted while it ran."""
