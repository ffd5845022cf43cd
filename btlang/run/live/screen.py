"""A part of the terminal that is redrawn in place, and what else a program prints meanwhile."""

from __future__ import annotations

import io
import os
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TextIO

    from btlang.run.live.frame import Line


class Capture(io.TextIOBase):
    """A stand-in for a stream: it hands on each line that is written to it, without its end.

    All else that is asked of the stream, such as its encoding, is that of the real one.
    """

    def __init__(self, real: TextIO, line: Callable[[str], object]) -> None:
        self._real = real
        self._line = line
        self._begun = ""

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """The encoding of the real stream."""
        return self._real.encoding

    @property
    def errors(self) -> str | None:  # type: ignore[override]
        """The error handling of the real stream."""
        return self._real.errors

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def fileno(self) -> int:
        """Return the number of the real stream."""
        return self._real.fileno()

    def isatty(self) -> bool:
        """Return what the real stream does."""
        return self._real.isatty()

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, text: str) -> int:
        """Hand on the lines that are complete now."""
        *lines, self._begun = (self._begun + text).split("\n")
        for line in lines:
            self._line(line)
        return len(text)

    def finish(self) -> None:
        """Hand on a line that has no end yet."""
        if self._begun:
            self._line(self._begun)
            self._begun = ""


@contextmanager
def capture_output(output: TextIO, line: Callable[[str], object]) -> Iterator[None]:
    """Let standard output, and standard error where it is a terminal, go to `line`; `output` is the real output."""
    out, err = sys.stdout, sys.stderr
    captures = [Capture(output, line)]
    sys.stdout = captures[0]
    if err is not None and err.isatty():
        captures.append(Capture(err, line))
        sys.stderr = captures[1]
    try:
        yield
    finally:
        sys.stdout, sys.stderr = out, err
        for capture in captures:
            capture.finish()


# Asks the terminal to show what comes between the two at once; one that does not know it ignores it.
_BEGIN, _END = "\x1b[?2026h", "\x1b[?2026l"
_HIDE_CURSOR, _SHOW_CURSOR = "\x1b[?25l", "\x1b[?25h"
_ERASE_LINE, _ERASE_BELOW = "\x1b[K", "\x1b[J"
_CONTROL = re.compile("\x1b\\[[0-9;]*m")


class LiveScreen:
    """A part of a terminal, below what it shows, in which frames are drawn.

    Lines that did not change are not written again.

    Not by rich.live, which erases every line before it writes the frame: measured at 120 x 50, two of five reads of the
    terminal end in a frame with lines missing, and 20 frames a second cost 9% of a core (here: none, and 4%). Used by
    one thread at a time.
    """

    def __init__(self, output: TextIO, size: Callable[[], os.terminal_size]) -> None:
        self._output = output
        self._size = size
        self._console = Console(file=output, width=1000, highlight=False, markup=False, emoji=False)
        self._drawn: list[str] = []
        self._width = 0
        self._known: dict[tuple[Line, int], str] = {}

    def size(self) -> tuple[int, int]:
        """Return columns that may be used, and rows.

        The last column stays free: some terminals wrap when it is written.
        """
        columns, rows = self._size()
        return max(columns - 1, 1), max(rows, 1)

    def begin(self) -> None:
        """Hide the cursor."""
        self._write(_HIDE_CURSOR)

    def draw(self, above: Sequence[str], frame: Sequence[Line]) -> None:
        """Show a frame in place of the one before, and further lines that stay above it."""
        width, rows = self.size()
        known, self._known = self._known, {}
        lines: list[str] = []
        for line in frame[: rows - 1]:
            drawn = known.get((line, width)) or self._render(line, width)
            self._known[line, width] = drawn
            lines.append(drawn)
        redraw = bool(above) or width != self._width
        if lines == self._drawn and not redraw:
            return
        parts = [_BEGIN, self._to_the_top(width)]
        parts += [_staying_line(part.expandtabs(), width + 1) for line in above for part in line.split("\n")]
        parts += self._changes(lines, redraw)
        parts.append(_END)
        self._drawn, self._width = lines, width
        self._write("".join(parts))

    def leave(self) -> None:
        """Let what is shown now stay; the next frame begins on a line of its own."""
        if self._drawn:
            self._write("\r\n")
        self._drawn, self._known = [], {}

    def end(self) -> None:
        """Show the cursor again; do nothing where the terminal is gone."""
        with suppress(OSError, ValueError):
            self._write(_SHOW_CURSOR)

    def _changes(self, lines: list[str], redraw: bool) -> Iterator[str]:
        """Yield what to write from the first line of the frame to its last; what is as before is passed over."""
        for at, line in enumerate(lines):
            if at:
                yield "\r\n"
            if redraw or at >= len(self._drawn) or line != self._drawn[at]:
                yield line + _ERASE_LINE
        if redraw or len(lines) < len(self._drawn):
            yield _ERASE_BELOW

    def _to_the_top(self, width: int) -> str:
        """Move to the first line of the frame. A terminal that became narrower has wrapped its lines, as most do."""
        if not self._drawn:
            return "\r"
        columns = width + 1
        rows = [max(1, -(-cell_len(_CONTROL.sub("", line)) // columns)) for line in self._drawn]
        up = sum(rows) - 1
        return f"\r\x1b[{up}A" if up else "\r"

    def _render(self, line: Line, width: int) -> str:
        text = Text.assemble(*line, no_wrap=True, end="")
        text.truncate(width, overflow="ellipsis" if self._console.encoding.startswith("utf") else "crop")
        with self._console.capture() as captured:
            self._console.print(text, end="", crop=False, soft_wrap=True)
        return captured.get()

    def _write(self, text: str) -> None:
        self._output.write(text)
        self._output.flush()


def _staying_line(line: str, columns: int) -> str:
    """Return a line above the frame.

    It erases what it is written over: what is erased at once, tmux keeps in its history.

    Nothing is erased after a line that fills the last column, where the cursor still stands on its last character.
    """
    full = cell_len(_CONTROL.sub("", line)) % columns == 0 and line
    return f"{_ERASE_LINE}{line}{'' if full else _ERASE_LINE}\r\n"
