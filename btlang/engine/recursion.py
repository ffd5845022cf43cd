"""The recursion limit of Python while a deep tree is ticked."""

from __future__ import annotations

import sys
from _thread import allocate_lock  # `threading` takes longer to import
from collections.abc import Callable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_lock = allocate_lock()
_asked: list[int] = []  # the frames that those ask for who run now
_usual = 0  # the limit while nobody does


def allow_depth(frames: int, do: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a function so that so many frames are allowed while it runs, in whatever thread.

    The limit doesn't stay raised: what recurses in C, as Python's JSON does, would crash where it says now that
    something is nested too deep.
    """

    def done(*args: Any) -> Any:
        _raise(frames)
        try:
            return do(*args)
        finally:
            _lower(frames)

    return done


def _raise(frames: int) -> None:
    global _usual
    with _lock:
        if not _asked:
            _usual = sys.getrecursionlimit()
        _asked.append(frames)
        sys.setrecursionlimit(max([_usual, *_asked]))


def _lower(frames: int) -> None:
    with _lock:
        _asked.remove(frames)
        sys.setrecursionlimit(max([_usual, *_asked]))
