"""The lines of a user's Python script that call btlang, as places for messages."""

from __future__ import annotations

import sys

from btlang.text.source import PythonSource, Span

_sources: dict[str, tuple[list[str], PythonSource]] = {}  # by file names, with the lines that linecache gave


def calling_line() -> Span | None:
    """Return the line, outside this package, of the innermost call into it. None if the text of its file isn't known.

    Of a call of several lines it is the first.
    """
    from linecache import getlines

    frame = sys._getframe(1)
    while frame.f_globals.get("__name__", "").startswith("btlang."):
        if frame.f_back is None:
            return None
        frame = frame.f_back
    file, number = frame.f_code.co_filename, frame.f_lineno
    lines = getlines(file)
    if not 0 < number <= len(lines):
        return None
    known = _sources.get(file)
    if known is None or known[0] is not lines:  # linecache has read a newer text
        known = _sources[file] = lines, PythonSource("".join(lines), file)
    source = known[1]
    words = lines[number - 1].strip()
    start = source.offset(number, 1 + lines[number - 1].find(words))
    return Span(source, start, start + len(words))
