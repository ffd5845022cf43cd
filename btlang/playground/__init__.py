"""btlang in a browser without a server: in one thread, and without packages that are compiled."""

from __future__ import annotations

import os
import sys


def prepare(home: str) -> None:
    """Let imports find stand-ins of packages that aren't installed, and make a home that was unpacked the user's own.

    The cache of words takes nothing from a folder or a file that others may write to, and archives keep no modes.
    """
    sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "stand_ins"))
    for folder, _, names in os.walk(home):
        for path in (folder, *(os.path.join(folder, name) for name in names)):
            os.chmod(path, 0o700)
