"""Keeps what else a program prints from being written into the middle of the live view."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TextIO


class Capture(io.TextIOBase):
    """Stands in for a stream: hands on each line that is written to it, without its end.

    All else that is asked of the stream, such as its encoding, is that of the real one.
    """

    def __init__(self, real: TextIO, line: Callable[[str], object]) -> None:
        self._real = real
        self._line = line
        self._begun = ""

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """That of the real stream."""
        return self._real.encoding

    @property
    def errors(self) -> str | None:  # type: ignore[override]
        """That of the real stream."""
        return self._real.errors

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def fileno(self) -> int:
        """That of the real stream."""
        return self._real.fileno()

    def isatty(self) -> bool:
        """As the real stream says."""
        return self._real.isatty()

    def writable(self) -> bool:
        """True."""
        return True

    def write(self, text: str) -> int:
        """Hands on the lines that are complete now."""
        *lines, self._begun = (self._begun + text).split("\n")
        for line in lines:
            self._line(line)
        return len(text)

    def finish(self) -> None:
        """Hands on a line that has no end yet."""
        if self._begun:
            self._line(self._begun)
            self._begun = ""


@contextmanager
def captured(output: TextIO, line: Callable[[str], object]) -> Iterator[None]:
    """Standard output, and standard error where it is a terminal, go to `line`; `output` is the real output."""
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
