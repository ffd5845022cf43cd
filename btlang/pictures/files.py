"""Files of pictures: what keeps one from being made is known before the robot moves."""

from __future__ import annotations

import os
from importlib.util import find_spec

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import unwritable
from btlang.text.formatting import joined
from btlang.text.source import Source, Span

STILL = (".svg", ".png")
MOVING = (".gif",)


def picture_ending(path: str, allowed: tuple[str, ...]) -> str:
    """Return the ending of a file in small letters. Raises ValueError where it is not one of those allowed."""
    found = os.path.splitext(path)[1].lower()
    if found not in allowed:
        raise ValueError(f"expected a file that ends in {joined(allowed, 'or')}, not '{path}'")
    return found


def check_picture(path: str) -> None:
    """Raise MissionError where the picture cannot be drawn (BT081) or the file cannot be written (BT009)."""
    if picture_ending(path, STILL + MOVING) != ".svg" and find_spec("matplotlib") is None:
        raise matplotlib_error(path)
    is_new = not os.path.lexists(path)
    try:
        open(path, "ab").close()
        if is_new:
            os.remove(path)
    except OSError as error:
        raise MissionError([unwritable(path, error)]) from None


def matplotlib_error(path: str) -> MissionError:
    """Make the error BT081: matplotlib is not there."""
    return MissionError([diagnostic("BT081", Span(Source("", path), 0, 0))])
