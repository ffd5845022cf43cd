"""What is on its way to one client: bounded, the newest status wins, and a client that reads slowly delays nobody."""

from __future__ import annotations

import asyncio
import json
from collections import deque

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 2000
"""Messages that may wait, beside statuses. A client that reads so slowly begins anew."""


class News:
    """A message for many clients, which is written as JSON once."""

    __slots__ = ("_text", "message", "robot")

    def __init__(self, robot: str, message: dict[str, Any]) -> None:
        self.robot, self.message = robot, message
        self._text = ""

    @property
    def text(self) -> str:
        """As JSON."""
        if not self._text:
            self._text = as_text(self.robot, self.message)
        return self._text


def as_text(robot: str, message: dict[str, Any]) -> str:
    """A message of a robot as clients get it."""
    return json.dumps({"robot": robot, **message}, separators=(",", ":"), default=str)


class Outlet:
    """Used by one event loop. `put` never waits; `take` waits for what is next."""

    def __init__(self) -> None:
        self._queue: deque[str] = deque()
        self._statuses: dict[str, News | tuple[str, dict[int, str]]] = {}
        self._states: dict[str, News] = {}
        self._full = False
        self._news = asyncio.Event()

    def put(self, news: News) -> None:
        """Adds a message of a robot."""
        kind = news.message["type"]
        if kind == "statuses":
            self._merge(news)
        elif kind == "robot":
            self._states[news.robot] = news
        else:
            if kind == "run":  # after the last statuses of the run before
                self._flush(news.robot)
            self._say(news.text)
        self._news.set()

    def say(self, text: str) -> None:
        """Adds an answer, which is never left out."""
        self._queue.append(text)
        self._news.set()

    async def take(self) -> list[str]:
        """What there is, at least one message, in the order of its coming; statuses come last, each the newest."""
        await self._news.wait()
        self._news.clear()
        for robot in tuple(self._statuses):
            self._flush(robot)
        taken = [*self._queue, *(state.text for state in self._states.values())]
        if self._full:  # what was left out is said
            taken.append('{"type":"lost"}')
        self._queue.clear()
        self._states.clear()
        self._full = False
        return taken

    def _say(self, text: str) -> None:
        if len(self._queue) < _MOST:
            self._queue.append(text)
        else:
            self._full = True

    def _merge(self, news: News) -> None:
        before = self._statuses.get(news.robot)
        if before is None:
            self._statuses[news.robot] = news
            return
        run = news.message["run"]
        if isinstance(before, News):
            before = (before.message["run"], dict(before.message["changes"]))
        if before[0] == run:
            before[1].update(news.message["changes"])
            self._statuses[news.robot] = before
        else:
            self._statuses[news.robot] = news

    def _flush(self, robot: str) -> None:
        waiting = self._statuses.pop(robot, None)
        if isinstance(waiting, News):
            self._say(waiting.text)
        elif waiting is not None:
            run, changes = waiting
            self._say(as_text(robot, {"type": "statuses", "run": run, "changes": [[i, s] for i, s in changes.items()]}))
