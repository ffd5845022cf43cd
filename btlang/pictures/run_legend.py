"""The list of commands beside the map: number, words, time and how each ended."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.pictures import letters
from btlang.pictures.run_record import Command, RunRecord
from btlang.pictures.style import HALTED, LOOKS, SMALL, SOFT, TEXT, TITLE, Look

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.pictures.surface import Surface

WIDTH = 270.0
FIRST, LAST = 20, 6  # of many commands, so many are listed
_ROW, _MORE = 15.0, 10.5  # height of a row, and of each further line in it
_LEFT, _RIGHT = 42.0, 46.0  # room for number and sign, and for the time
_ENDINGS = {SUCCESS: "Succeeded", FAILURE: "Failed", IDLE: "Stopped", RUNNING: "Stopped", SKIPPED: "Nothing to do"}


def listed(commands: Sequence[Command]) -> list[Command]:
    """Those that the legend names: all, or the first and the last of them."""
    return list(commands) if len(commands) <= FIRST + LAST else [*commands[:FIRST], *commands[-LAST:]]


def outcome(record: RunRecord) -> tuple[Look, str]:
    """How the run ended, in a few words."""
    status, t = record.ended or (IDLE, record.track[-1].t)
    return LOOKS[status], f"{_ENDINGS[status]} after {t:.1f} s"


class Legend:
    """`height` is known before it is drawn."""

    def __init__(self, record: RunRecord) -> None:
        self._record = record
        self._rows = [(command, *_lines(command)) for command in listed(record.commands)]
        self._hidden = len(record.commands) - len(self._rows)
        self.height = 62.0 + sum(_height(text, why) for _, text, why in self._rows) + (_ROW if self._hidden else 0)

    def draw(self, canvas: Surface, x: float, y: float) -> None:
        """Draws it with its upper left corner there."""
        record = self._record
        look, heading = outcome(record)
        canvas.text(x, y + 8, look.sign, size=TITLE + 2, colour=look.strong, bold=True)
        canvas.text(x + 17, y + 8, heading, size=TITLE, colour=look.strong, bold=True)
        canvas.text(x, y + 25, self._summary(), size=SMALL, colour=SOFT)
        y += 46
        if not self._rows:
            canvas.text(x, y + 4, "The robot got no commands.", colour=SOFT)
        else:
            canvas.text(x + _LEFT, y, "command", size=SMALL, colour=SOFT)
            canvas.text(x + WIDTH, y, "began", size=SMALL, colour=SOFT, align="right")
            canvas.line([(x, y + 7), (x + WIDTH, y + 7)], colour="#d5dade", line=0.8)
            y += 10
        for number, (command, text, why) in enumerate(self._rows):
            if self._hidden and number == FIRST:
                canvas.text(x + _LEFT, y + _ROW / 2, f"… and {self._hidden} more", colour=SOFT)
                y += _ROW
            self._row(canvas, x, y, command, text, why)
            y += _height(text, why)

    def _row(self, canvas: Surface, x: float, y: float, command: Command, text: list[str], why: list[str]) -> None:
        look, y = LOOKS[command.status], y + _ROW / 2
        canvas.text(x + 22, y, str(command.number), bold=True, align="right")
        canvas.text(x + 32, y, look.sign, bold=True, colour=look.strong, align="center")
        canvas.text(x + WIDTH, y, f"{command.start.t:.1f} s", size=SMALL, colour=SOFT, align="right")
        for line in text:
            canvas.text(x + _LEFT, y, line)
            y += _MORE
        for line in why:
            canvas.text(x + _LEFT, y, line, size=SMALL, colour=look.strong)
            y += _MORE

    def _summary(self) -> str:
        track = self._record.track
        metres = sum(a.pose.distance_to((b.pose.x, b.pose.y)) for a, b in pairwise(track))
        bumps = sum(mark.kind == "bump" for mark in self._record.marks)
        parts = [f"{metres:.1f} m", f"battery {track[0].battery:.0f} % → {track[-1].battery:.0f} %"]
        if bumps:
            parts.append("1 bump" if bumps == 1 else f"{bumps} bumps")
        return "   ·   ".join(parts)


def _lines(command: Command) -> tuple[list[str], list[str]]:
    room = WIDTH - _LEFT - _RIGHT
    text = letters.wrapped(letters.shown(command.text), room, 2, TEXT, False)
    reason = command.reason or ("halted before its end" if LOOKS[command.status] is HALTED else "")
    why = letters.wrapped(letters.shown(reason), room, 2, SMALL, False) if reason else []
    return text, why


def _height(text: list[str], why: list[str]) -> float:
    return _ROW + (len(text) + len(why) - 1) * _MORE
