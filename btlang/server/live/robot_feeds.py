"""The robots behind a server: commands to them, what happens on them for any number of clients, and figures."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncGenerator, Callable, Iterable
from contextlib import aclosing, suppress

from btlang.editing.words import RobotWords
from btlang.server.live.client_queue import ClientQueue, RobotNews
from btlang.server.live.robot_connection import LocalConnection
from btlang.server.live.robot_view import RobotView
from btlang.server.live.supervision import restarts, supervise
from btlang.task.commands.client import names_up
from btlang.task.messages import Answer, Command, as_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.server.live.robot_connection import RemoteConnection, RobotConnection


_AGAIN = 0.5  # seconds between two looks whether a robot is there
_SILENT = 15.0  # seconds without a word after which a robot counts as gone
_PATIENCE = 35.0  # seconds for an answer
_STOPPED = 3.0  # seconds in which a robot has to say that it has the emergency stop
_PAGE = 500  # changes that are read at once for a client who comes back
_BROKEN = (OSError, ValueError, KeyError, TypeError, AttributeError)  # a robot may say anything
_NO_STORE = "The robot can't read or write its data: its disk may be full. The command wasn't done."
RATE = 20.0


class RobotFeed:
    """The feed of one robot, for one event loop.

    `connection` leads to it, over the sockets of this computer by default.
    """

    def __init__(self, name: str, connection: RemoteConnection | None = None, seen: float | None = None) -> None:
        self.name = name
        self.is_elsewhere = connection is not None
        self.seen = seen
        """The time when it last said something, in seconds since 1970."""
        self.words = RobotWords()
        self.recordings = ""
        """The folder of its recordings, "" if they aren't on this computer."""
        self._connection: RobotConnection = connection or LocalConnection(name)
        self._elsewhere = connection
        self._reading = asyncio.Lock()  # a piece at a time: the rest of what the link carries has to come through
        self._queues: set[ClientQueue] = set()
        self._catching_up: dict[ClientQueue, asyncio.Task[None]] = {}  # those that don't know the latest change yet
        self._paging = asyncio.Lock()  # each is a watcher more for the robot
        self._up = asyncio.Event()
        self._view = RobotView()
        self._ages: tuple[float, dict[str, Any]] | None = None
        """The newest message about the ages of readings, and when it came."""

    @property
    def is_up(self) -> bool:
        """Return whether it can be spoken to."""
        return self._up.is_set()

    @property
    def is_watched(self) -> bool:
        """Return whether a client gets its updates."""
        return bool(self._queues)

    @property
    def latest(self) -> dict[str, Any]:
        """The latest state of the robot itself: pose, battery, what keeps it from working."""
        return self._view.states.get("robot", {})

    async def send(self, command: Command, person: str) -> Answer:
        """Send a command; return the answer. Raises ConnectionError if the robot isn't up, or doesn't answer."""
        try:
            async with asyncio.timeout(_PATIENCE):
                answer = await self._connection.ask({**as_json(command), "as": person})
                return _without_places(Answer(answer["ok"], answer["text"], answer["data"], answer["code"]))
        except _BROKEN as error:
            text = f"The robot '{self.name}' isn't up, or doesn't answer. If it was up, it may have done it."
            raise ConnectionError(text) from error

    async def read(self, message: dict[str, Any]) -> Any:
        """Return what a robot elsewhere says of its recordings, also if the link breaks meanwhile.

        Raises ConnectionError.
        """
        text = f"The robot '{self.name}' isn't up, or doesn't send its recordings."
        if self._elsewhere is None:
            raise ConnectionError(text)
        try:
            async with self._reading, asyncio.timeout(_PATIENCE):
                return await self._elsewhere.read(message)
        except _BROKEN as error:
            raise ConnectionError(text) from error

    async def stop(self) -> None:
        """Send the emergency stop, past all commands.

        Raises ConnectionError if the robot doesn't say that it has it.
        """
        try:
            async with asyncio.timeout(_STOPPED):
                await self._connection.stop()
        except OSError as error:
            text = f"The emergency stop may not have reached the robot '{self.name}': STOP IT WHERE IT STANDS."
            raise ConnectionError(text) from error

    def add(self, queue: ClientQueue, after: int | None = None) -> None:
        """Add a client that gets the present state, then all updates.

        One that was here before first gets the changes of tasks `after` the last one that it knows.
        """
        for message in self._view.messages():
            queue.put(RobotNews(self.name, message))
        if self.is_up and self._ages is not None:
            queue.put(RobotNews(self.name, _older(self._ages[1], time.monotonic() - self._ages[0])))
        self._queues.add(queue)
        if after is not None:
            self._catching_up[queue] = asyncio.create_task(self._catch_up(queue, after))

    def discard(self, queue: ClientQueue) -> None:
        """Remove a client: it gets no more updates."""
        self._queues.discard(queue)
        catching_up = self._catching_up.pop(queue, None)
        if catching_up is not None:
            catching_up.cancel()

    async def follow(self) -> None:
        """Read what happens, until it is cancelled; go on after the last change when the robot is up again."""
        while True:
            try:
                with suppress(*_BROKEN):
                    async with aclosing(self._messages(self._view.change)) as messages:
                        async for message in messages:
                            self._take(message)
            finally:
                self.leave()
            await asyncio.sleep(_AGAIN)

    def leave(self) -> None:
        """Mark the robot as no longer up."""
        if self.is_up:
            self._up.clear()
            self._ages = None
            self._publish({"type": "away"})

    async def _messages(self, after: int | None) -> AsyncGenerator[dict[str, Any]]:
        """Yield what the robot sends to a watcher, until it ends."""
        async with self._connection.watch({"rate": RATE, "after": after}) as reader:
            while True:
                async with asyncio.timeout(_SILENT):  # which, unlike wait_for, takes all that is there in one go
                    line = await reader.readline()
                if not line:
                    return
                yield json.loads(line)

    async def _catch_up(self, queue: ClientQueue, after: int) -> None:
        """Send a client the changes after one, until it has all that were sent to others."""
        while True:
            await self._up.wait()
            latest = self._view.change or 0
            if after >= latest:
                break
            await queue.wait_for_room()
            async with self._paging:
                last, is_all = await self._page(queue, after)
            if not is_all and last == after:
                await asyncio.sleep(_AGAIN)
            after = max(last, latest) if is_all else last  # the task of a change may be deleted by now
        del self._catching_up[queue]

    async def _page(self, queue: ClientQueue, after: int) -> tuple[int, bool]:
        """Send a client some changes after one; return the number of the last, and whether others have no more."""
        end = after + _PAGE
        with suppress(*_BROKEN):
            async with aclosing(self._messages(after)) as messages:
                async for message in messages:
                    if message["type"] == "hello":
                        after = int(message["change"])
                    elif message["type"] != "change" or message["number"] > (self._view.change or 0):
                        return after, True
                    else:
                        after = int(message["number"])
                        queue.put(RobotNews(self.name, message))
                        if after >= end:
                            break
        return after, False

    def _take(self, message: dict[str, Any]) -> None:
        self.seen = time.time()
        kind = message["type"]
        if kind == "hello":
            if not self.is_elsewhere:  # its files are not on this computer
                self.words = RobotWords(**message.get("words", {}))
                self.recordings = str(message.get("recordings", ""))
            self._publish({"type": "up", "change": message["change"]})
            self._up.set()
        else:
            if kind == "ages":
                self._ages = time.monotonic(), message
            self._publish(message)

    def _publish(self, message: dict[str, Any]) -> None:
        self._view.take(message)
        news = RobotNews(self.name, message)
        for queue in self._queues:
            if message["type"] != "change" or queue not in self._catching_up:
                queue.put(news)


class RobotFeeds:
    """The feeds of all robots that are up on this computer, as long as `follow` goes on, and of those that joined.

    `came` is called with one that is new.
    """

    def __init__(self, came: Callable[[RobotFeed], object] = lambda feed: None) -> None:
        self.feeds: dict[str, RobotFeed] = {}
        self.came = came
        self._following: dict[str, asyncio.Task[None]] = {}

    def get(self, name: str) -> RobotFeed | None:
        """Return the feed of a name; "" for the only one that is up."""
        if name:
            return self.feeds.get(name)
        up = [feed for feed in self.feeds.values() if feed.is_up]
        return up[0] if len(up) == 1 else None

    def add(self, feed: RobotFeed) -> None:
        """Follow a robot from now on."""
        self.feeds[feed.name] = feed
        self._following[feed.name] = asyncio.create_task(supervise(f"follow the robot '{feed.name}'", feed.follow))
        self.came(feed)

    def remove(self, name: str) -> None:
        """Remove a robot that is no longer there."""
        self._following.pop(name).cancel()
        self.feeds.pop(name).leave()

    def look(self) -> None:
        """Add the robots that are up on this computer."""
        for name in names_up():
            if name not in self.feeds:
                self.add(RobotFeed(name))

    async def follow(self) -> None:
        """Look for robots again and again, until it is cancelled."""
        try:
            while True:
                with suppress(OSError):  # no descriptor is left for the folder
                    self.look()
                await asyncio.sleep(_AGAIN)
        except asyncio.CancelledError:
            for task in self._following.values():
                task.cancel()
            raise


def _without_places(answer: Answer) -> Answer:
    """Return an answer without the paths of a computer, which a message about a store has."""
    return answer.replace(text=_NO_STORE) if answer.code == "BT195" else answer


def _older(ages: dict[str, Any], seconds: float) -> dict[str, Any]:
    """Return a message about ages as it would be some seconds later, if nothing was read meanwhile."""
    return {name: value + seconds if isinstance(value, int | float) else value for name, value in ages.items()}


def metrics(feeds: Iterable[RobotFeed], clients: int) -> str:
    """Write the figures of the robots, and how many sockets are open."""
    rows: list[tuple[str, str, str, float]] = []
    for feed in feeds:
        known = feed.latest
        rows.append(("btlang_robot_up", "Whether the robot is up.", feed.name, float(feed.is_up)))
        rows.append(
            ("btlang_robot_stopped", "Whether its emergency stop is shut.", feed.name, bool(known.get("stopped")))
        )
        if known.get("battery") is not None:
            rows.append(("btlang_robot_battery_percent", "The charge of its battery.", feed.name, known["battery"]))
        if feed.seen is not None:
            rows.append(("btlang_robot_seen_seconds", "When it last said something.", feed.name, feed.seen))
    lines: list[str] = []
    for name, text, robot, value in sorted(rows):
        if not lines or name not in lines[-1]:
            lines += [f"# HELP {name} {text}", f"# TYPE {name} gauge"]
        lines.append(f'{name}{{robot="{robot}"}} {float(value):g}')
    lines += ["# HELP btlang_restarts_total Tasks of the server that had to be begun again."]
    lines += ["# TYPE btlang_restarts_total counter", f"btlang_restarts_total {restarts.total()}"]
    lines += ["# HELP btlang_clients Open WebSockets.", "# TYPE btlang_clients gauge", f"btlang_clients {clients}"]
    return "\n".join(lines) + "\n"
