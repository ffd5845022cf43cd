"""The user's folders for what btlang keeps between runs."""

from __future__ import annotations

import os
import sys

_LINUX = {
    "cache": ("XDG_CACHE_HOME", "~/.cache"),
    "data": ("XDG_DATA_HOME", "~/.local/share"),
    "state": ("XDG_STATE_HOME", "~/.local/state"),
}


def user_dir(kind: str) -> str:
    """Return the platform's folder for files, "cache", "data" or "state": $XDG_CACHE_HOME/btlang on Linux."""
    if sys.platform in ("linux", "emscripten"):  # platformdirs takes longer to import than a cache may save
        variable, usual = _LINUX[kind]
        set_to = os.environ.get(variable, "")
        return os.path.join(set_to if os.path.isabs(set_to) else os.path.expanduser(usual), "btlang")
    import platformdirs

    return str(getattr(platformdirs, f"user_{kind}_dir")("btlang"))
