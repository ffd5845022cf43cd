"""Files to sources; everything that can be wrong with a file becomes a diagnostic, also when it is to be written."""

from __future__ import annotations

import sys
from codecs import BOM_UTF8

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.text.source import Source, Span


def read_source(path: str) -> Source:
    """The text of a file, or of standard input for `-`. Raises MissionError (BT001, BT002)."""
    try:
        if path == "-":
            data = sys.stdin.buffer.read() if sys.stdin is not None else b""
        else:
            with open(path, "rb") as file:
                data = file.read()
    except OSError as error:
        nowhere = Span(Source("", path), 0, 0)
        raise MissionError([diagnostic("BT001", nowhere, file=path, reason=reason_of(error))]) from None
    data = data.removeprefix(BOM_UTF8)
    try:
        return Source(data.decode(), path)
    except UnicodeDecodeError as error:
        readable = data[: error.start].decode("utf-8")
        source = Source(readable + data[error.start :].decode("latin-1"), path)
        raise MissionError([diagnostic("BT002", Span(source, len(readable), len(readable) + 1))]) from None


def unwritable(path: str, reason: str | OSError) -> Diagnostic:
    """BT009: a file cannot be written."""
    told = reason if isinstance(reason, str) else reason_of(reason)
    return diagnostic("BT009", Span(Source("", path), 0, 0), file=path, reason=told)


def reason_of(error: OSError) -> str:
    """The reason in the words of the operating system, to stand in a sentence."""
    return (error.strerror or str(error)).lower()
