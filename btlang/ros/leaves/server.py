"""What clients of actions and of services have in common: waiting for the server, and judging what it answers."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator

from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere
from btlang.ros.clients import Clients
from btlang.ros.fields import field_types
from btlang.ros.graph import is_ready, no_server
from btlang.ros.word import Word

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

WAIT = 5.0
"""Real seconds that a server gets to appear, where a table says nothing else."""
ANSWER = 5.0
"""Seconds that the server of an action gets to accept a goal or to reject it."""
_REASONS = ("message", "error_msg", "error_string", "reason", "status_message")
_PAUSE = 0.5  # real seconds between two looks at a server


def awaited(clients: Clients, client: Any, cls: Any, name: str, limit: float) -> Generator[None]:
    """Yields until there is a server; raises ActionFailed when the limit is over."""
    until = time.monotonic() + limit
    while not is_ready(client):
        if time.monotonic() >= until:
            raise ActionFailed(NotThere(no_server(clients.node, cls, name)))
        yield


class Judge:
    """Judges whether an answer is a success, by the fields that the table names.

    If it names none, they are `success`, `error_code` and `message` or `error_msg`, as far as these exist.
    Raises MissionError (BT105).
    """

    def __init__(self, word: Word, cls: Any) -> None:
        types = field_types(cls)

        def named(key: str, usual: tuple[str, ...]) -> str:
            given: str | None = word.ros.get(key)
            if given is None:
                return next((name for name in usual if name in types), "")
            if given and given not in types:
                raise word.no_field(cls, given, given, types)
            return given

        self._failed, self._succeeded = named("failed", ("error_code",)), named("succeeded", ("success",))
        self._reason = named("reason", _REASONS)

    def said(self, answer: Any) -> str:
        """The reason in an answer, "" where it gives none."""
        return str(getattr(answer, self._reason)).strip() if self._reason else ""

    def verdict(self, answer: Any) -> bool | Failed:
        """True, or FAILURE with the reason."""
        if self._failed and getattr(answer, self._failed):
            return Failed(self.said(answer) or f"{self._failed} is {getattr(answer, self._failed)}")
        if self._succeeded and not getattr(answer, self._succeeded):
            return Failed(self.said(answer) or "it was refused")
        return True


class Presence:
    """Whether the server that got a request is still there: another one under its name does not know the request."""

    def __init__(self, there: Callable[[], set[bytes]]) -> None:
        self._there = there
        self._first = there()
        self._next = time.monotonic() + _PAUSE

    def is_lost(self) -> bool:
        """Looks twice a second."""
        if time.monotonic() < self._next:
            return False
        self._next = time.monotonic() + _PAUSE
        now = self._there()
        self._first = self._first or now  # where it was not seen yet
        return bool(self._first) and not self._first & now


def nothing() -> None:
    """In place of the `wake` of a run, if there is none."""
