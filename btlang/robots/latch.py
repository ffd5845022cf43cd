"""What keeps a robot that was stopped from taking commands."""

from __future__ import annotations


class Latch:
    """Open at first. `shut` and `stop` may be called from any thread and from handlers of signals: there is no lock.

    `stop` refuses commands until the next `step`, so that a tick in flight cannot undo it; `shut` until `open`, which
    nothing but the beginning of a run, or its going on after a pause, may call.
    """

    __slots__ = ("_shut", "_stopping")

    def __init__(self) -> None:
        self._shut = self._stopping = False

    @property
    def refuses(self) -> bool:
        """Whether commands are refused now."""
        return self._shut or self._stopping

    def stop(self) -> None:
        """Refuses commands until the next step."""
        self._stopping = True

    def shut(self) -> None:
        """Refuses commands until it is opened."""
        self._shut = True

    def step(self) -> None:
        """A step begins."""
        self._stopping = False

    def open(self) -> None:
        """Lets commands through again."""
        self._shut = self._stopping = False
