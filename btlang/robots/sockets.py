"""Where the sockets of robots are: in a folder of this user alone."""

from __future__ import annotations

import os
import stat
import tempfile

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.text.source import NOWHERE

_LONGEST = 100
"""Bytes of the path of a Unix socket; Linux takes 107, macOS 103."""


def socket_folder() -> str:
    """A folder of this user alone for sockets. Raises MissionError (BT195) if there can't be one."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    folder = os.path.join(runtime, "btlang")
    if not os.path.isdir(runtime) or len(os.fsencode(folder)) > _LONGEST - len("/.sock") - 38:
        folder = os.path.join(tempfile.gettempdir(), f"btlang-{os.getuid()}")
    try:
        os.makedirs(folder, mode=0o700, exist_ok=True)
        status = os.lstat(folder)
    except OSError as error:
        raise MissionError([diagnostic("BT195", NOWHERE, place=folder, reason=str(error))]) from None
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        reason = "it belongs to somebody else, or others may use it"
        raise MissionError([diagnostic("BT195", NOWHERE, place=folder, reason=reason)])
    return folder
