"""Texts that take seconds to make, made once for all processes that run tests."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

_FOLDER = "BTLANG_MADE_ONCE"
if _FOLDER not in os.environ:  # the first process, whose workers inherit it
    os.environ[_FOLDER] = tempfile.mkdtemp(prefix="btlang-made-")
    atexit.register(shutil.rmtree, os.environ[_FOLDER], ignore_errors=True)


def made_once(name: str, make: Callable[[], str]) -> str:
    """What `make` makes, which another process may have made already. Names are those of files."""
    folder = Path(os.environ[_FOLDER])
    with (folder / f"{name}.lock").open("w") as lock:
        if os.name != "nt":
            import fcntl

            fcntl.flock(lock, fcntl.LOCK_EX)
        made = folder / name
        if not made.exists():
            made.write_text(make(), encoding="utf-8", newline="\n")
        return made.read_text(encoding="utf-8")
