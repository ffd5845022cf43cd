"""What a user gets to see of a bug in btlang: a message, and a file with the traceback for those who mend it."""

from __future__ import annotations

import os
import platform
import sys

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.render import render
from btlang.support.user_dirs import user_dir
from btlang.text.source import Source, Span

_KNOWN = {MemoryError: "there is not enough memory for this", RecursionError: "this is nested too deep"}


def crashed(error: Exception) -> str:
    """BT099 as text. The traceback goes to `crash.txt` in the user's folder for states, in place of an older one."""
    reason = _KNOWN.get(type(error)) or f"{type(error).__name__}: {error}".rstrip(": ")
    try:
        advice = f"Please report it with the file {_written(error)}."
    except OSError:
        advice = "To see where, run the command again with BTC_DEBUG=1 before it."
    return render(diagnostic("BT099", Span(Source("", "btc"), 0, 0), error=reason, advice=advice))


def _written(error: Exception) -> str:
    from traceback import format_exception

    path = os.path.join(user_dir("state"), "crash.txt")
    os.makedirs(os.path.dirname(path), 0o700, exist_ok=True)
    head = f"btlang {sys.modules['btlang'].__version__}, Python {sys.version}, {platform.platform()}\n{sys.argv}\n"
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with open(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:
        file.write(head + "".join(format_exception(error)))
    return path
