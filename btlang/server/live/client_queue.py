"""What is on its way to one client: bounded, the newest status wins, and a client that reads slowly delays nobody."""

from __future__ import annotations

import asyncio
import json
from collections import deque
from collections.abc import Container
from contextlib import suppress

from btlang.server.live.robot_view import NEWEST, merge_statuses
from btlang.server.live.translation import translate

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 2000
"""The number of messages that may wait, beside statuses. A client that reads so slowly has to subscribe again."""
_MUCH = 4_000_000
"""The characters of answers and topics that may wait until a client has to read first."""
TOPICS = {
    "tree": ("run", "statuses"), "tasks": ("change",), "events": ("event",), "body": ("joints", "speech"),
    "robot": ("robot", "asking", "doing", "values"), "map": ("map", "things", "scan", "way"),
    "components": ("components",),
}  # fmt: skip
"""The topics of a subscription, with the kinds of messages of each. Everybody hears whether a robot is up."""
_TOPIC = {kind: topic for topic, kinds in TOPICS.items() for kind in kinds}


class RobotNews:
    """A message for many clients, which is written as JSON once. So are statuses that were merged for many."""

    __slots__ = ("_merged", "_text", "_translated", "message", "robot")

    def __init__(self, robot: str, message: dict[str, Any]) -> None:
        self.robot, self.message = robot, message
        self._text = ""
        self._merged: tuple[RobotNews, RobotNews] | None = None
        self._translated: dict[str, RobotNews] = {}

    @property
    def text(self) -> str:
        """The message as JSON."""
        if not self._text:
            self._text = json.dumps({"robot": self.robot, **self.message}, separators=(",", ":"), default=str)
        return self._text

    def in_language(self, language: str) -> RobotNews:
        """Return the same with the words of nodes in a language."""
        if language not in self._translated:
            message = translate(self.message, language)
            self._translated[language] = self if message is self.message else RobotNews(self.robot, message)
        return self._translated[language]

    def after(self, before: RobotNews) -> RobotNews:
        """Merge these statuses with earlier ones of the same run, where these count."""
        if self._merged is None or self._merged[0] is not before:
            self._merged = before, RobotNews(self.robot, merge_statuses(before.message, self.message))
        return self._merged[1]


class ClientQueue:
    """A queue of what is on its way to one client, for one event loop.

    `put` never waits; `wait` waits until there is something to `take`.
    """

    def __init__(self) -> None:
        self._queue: deque[str] = deque()
        self._statuses: dict[str, RobotNews] = {}
        self._states: dict[tuple[str, str], RobotNews] = {}
        self.topics: Container[str] = TOPICS
        """The topics whose messages are taken."""
        self.language = ""
        """The language of the words of nodes, "" for that of each mission."""
        self._topics: dict[str, deque[str]] = {}
        self._length = 0  # of answers and topics
        self._full = self._is_closed = False
        self._news, self._answers, self._taken = asyncio.Event(), asyncio.Event(), asyncio.Event()

    def put(self, news: RobotNews) -> None:
        """Add a message of a robot."""
        kind = news.message["type"]
        if kind in _TOPIC and _TOPIC[kind] not in self.topics:
            return
        if self.language and _TOPIC.get(kind) == "tree":
            news = news.in_language(self.language)
        if kind == "statuses":
            self._merge(news)
        elif kind in NEWEST:
            self._states[news.robot, kind] = news
        else:
            if kind in ("run", "away"):  # after the last statuses of the run before
                self._flush(news.robot)
            if kind in ("up", "away"):
                self._settle(news.robot, is_up=kind == "up")
            self._say(news.text)
        self._news.set()

    def say(self, text: str) -> None:
        """Add an answer, which is never left out."""
        self._queue.append(text)
        self._length += len(text)
        self._news.set()
        self._answers.set()

    def keep(self, topic: str, text: str, most: int) -> None:
        """Add a text of a topic. Its newest `most` texts wait; fewer, but at least one, if much waits already."""
        waiting = self._topics.setdefault(topic, deque())
        while waiting and (len(waiting) >= most or self._length > _MUCH):
            self._length -= len(waiting.popleft())
        waiting.append(text)
        self._length += len(text)
        self._news.set()

    async def wait(self) -> None:
        """Wait until there is something."""
        await self._news.wait()

    async def wait_for_answer(self, seconds: float) -> None:
        """Wait until there is an answer, but no longer than that."""
        with suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._answers.wait()

    async def wait_for_room(self) -> None:
        """Wait until a client that asks for much has read most of what it got."""
        while not self._is_closed and (len(self._queue) > _MOST // 2 or self._length > _MUCH):
            self._taken.clear()
            await self._taken.wait()

    def close(self) -> None:
        """Let nobody wait for room any more, as nobody reads; what was asked before is still done."""
        self._is_closed = True
        self._taken.set()

    def take(self) -> list[str]:
        """Take what there is, in the order of its coming; statuses come last, each the newest."""
        self._news.clear()
        self._answers.clear()
        for robot in tuple(self._statuses):
            self._flush(robot)
        taken = [*self._queue, *(state.text for state in self._states.values())]
        for texts in self._topics.values():
            taken += texts
        if self._full:  # what was left out is said
            taken.append('{"type":"lost"}')
        self._queue.clear()
        self._states.clear()
        self._topics.clear()
        self._length, self._full = 0, False
        self._taken.set()
        return taken

    def _say(self, text: str) -> None:
        if len(self._queue) < _MOST:
            self._queue.append(text)
        else:
            self._full = True

    def _merge(self, news: RobotNews) -> None:
        before = self._statuses.get(news.robot)
        same = before is not None and before.message["run"] == news.message["run"]
        self._statuses[news.robot] = news.after(before) if before is not None and same else news

    def _settle(self, robot: str, *, is_up: bool) -> None:
        """Put states before the news that their robot is away; those from before it came up count no more."""
        for key in [key for key in self._states if key[0] == robot]:
            state = self._states.pop(key)
            if not is_up:
                self._say(state.text)

    def _flush(self, robot: str) -> None:
        waiting = self._statuses.pop(robot, None)
        if waiting is not None:
            self._say(waiting.text)
