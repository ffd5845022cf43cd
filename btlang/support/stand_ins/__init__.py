"""Stand-ins for compiled packages where none can be installed, as in a browser: what btlang uses of them, in Python."""

from __future__ import annotations

import os
import sys


def allow_stand_ins() -> None:
    """Let imports find the stand-in of a package that isn't installed: the real ones come first."""
    folder = os.path.dirname(os.path.abspath(__file__))
    if folder not in sys.path:
        sys.path.append(folder)
