"""What is to be written to a store that may refuse for a while: a full disk, a server that isn't there."""

from __future__ import annotations

from collections.abc import Callable

from btlang.task.database import StoreError


class Outbox:
    """Keeps the order. Of one thread; `trouble` gets why the store refuses, for people. Before each other attempt
    `make_room` may remove what isn't needed, since a full disk is the usual reason.
    """

    def __init__(self, trouble: Callable[[str], object], make_room: Callable[[], object] = lambda: None) -> None:
        self._trouble, self._make_room = trouble, make_room
        self._waiting: list[Callable[[], object]] = []

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def write(self, change: Callable[[], object]) -> None:
        """Makes a change now, or as soon as the store takes it: what has happened is not lost."""
        if not self._waiting:
            try:
                change()
                return
            except StoreError as error:
                self._trouble(str(error))
        self._waiting.append(change)

    def flush(self) -> None:
        """Makes the changes that wait. Raises StoreError for the first one that is refused again."""
        if self._waiting:
            self._make_room()
        while self._waiting:
            self._waiting[0]()
            self._waiting.pop(0)
