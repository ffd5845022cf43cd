"""What a picture is drawn on, with colours, signs and sizes that colour-blind people can distinguish."""

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
"""The fill and edge of what is said: by the robot, by people, and when it calls for help."""


class Look(Record):
    """The look of a status: its sign, the word for it, a strong colour and a pale one."""

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
"""The looks by the last status of a node; IDLE stands for one that was halted while it ran."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from contextlib import AbstractContextManager
    from typing import Protocol

    Points = Sequence[tuple[float, float]]

    class Surface(Protocol):
        """A sheet, in points from the upper left corner. What is drawn later lies above, unless `z` says otherwise."""

        def text(
            self, x: float, y: float, text: str, *, size: float = TEXT,
            colour: str = INK, bold: bool = False, align: str = "left", z: float = 0, halo: bool = False,
        ) -> object:  # fmt: skip
            """Draw one line whose capitals are centred on `y`.

            `align` says whether it is left, center or right of `x`. A halo keeps it legible above lines.
            """

        def box(
            self, x: float, y: float, width: float, height: float, *, round: float = 0,
            fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
        ) -> object:  # fmt: skip
            """Draw a rectangle with corners rounded to a radius."""

        def polygon(
            self, points: Points, *, fill: str = "none", edge: str = "none", line: float = 1, z: float = 0
        ) -> object:
            """Draw a closed shape."""

        def circle(
            self, x: float, y: float, radius: float, *,
            fill: str = "none", edge: str = "none", line: float = 1, dashed: bool = False, z: float = 0,
        ) -> object:  # fmt: skip
            """Draw a disc or a ring."""

        def line(
            self, points: Points, *,
            colour: str = INK, line: float = 1, dashed: bool = False, round: bool = True, z: float = 0,
        ) -> object:  # fmt: skip
            """Draw a line through the points."""

        def draw_shaded(self, points: Points, colours: Sequence[str], *, line: float = 1, z: float = 0) -> object:
            """Draw a line through the points whose pieces have a colour each."""

        def group(self, title: str) -> AbstractContextManager[object]:
            """Return what is drawn within is one thing, which a viewer that can do so names."""

        def encode(self, kind: str) -> bytes:
            """Return the bytes of a file of a kind that the surface can make, ".svg" or ".png"."""
