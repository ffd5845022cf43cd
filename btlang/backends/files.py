"""Files that are written as a whole: rewritten missions, and what trees are compiled to."""

from __future__ import annotations

import os
import shutil
import sys
from contextlib import nullcontext

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.reading import unwritable
from btlang.text.output import pass_on


def put(made: str | bytes, path: str | None) -> None:
    """Into the file, or else to standard output."""
    if path is not None:
        write_file(path, made)
    elif isinstance(made, bytes):
        sys.stdout.buffer.write(made)
    else:
        pass_on(made)


def replace_text(path: str, text: str) -> None:
    """Gives a file that is there another text, as `write_file`."""
    try:
        with open(path, "r+b"):
            pass
    except OSError as error:
        raise MissionError([unwritable(path, error)]) from None
    write_file(path, text)


def write_file(path: str, content: str | bytes) -> None:
    """Writes a file, new or not, at once. Raises MissionError (BT009) where that fails; the file is then as it was.

    What a mission may hold and UTF-8 does not becomes an escape, which JSON and Python read back.
    """
    data = content.encode(errors="backslashreplace") if isinstance(content, str) else content
    target = os.path.realpath(path)
    new = f"{target}.{os.getpid()}.new"
    try:
        with open(target, "ab") if os.path.exists(target) else nullcontext():  # a protected file stays as it is
            pass
        if os.path.exists(target) and not os.path.isfile(target):  # a device such as /dev/stdout cannot be replaced
            with open(target, "wb") as device:
                device.write(data)
            return
        try:
            with open(new, "xb") as file:
                file.write(data)
            if os.path.exists(target):
                shutil.copymode(target, new)
            os.replace(new, target)
        finally:
            if os.path.exists(new):
                os.remove(new)
    except OSError as error:
        raise MissionError([unwritable(path, error)]) from None
