"""The one source of time of a running mission: somebody drives it, nothing in a tree sleeps."""

from __future__ import annotations


class Clock:
    """Seconds since the mission began, moved on by the runner (or a test). Never goes back."""

    __slots__ = ("now",)

    def __init__(self, now: float = 0.0) -> None:
        self.now = now

    def advance(self, seconds: float) -> None:
        """Raises ValueError for a negative step."""
        if seconds < 0:
            raise ValueError(f"time does not go back: {seconds}")
        self.now += seconds
