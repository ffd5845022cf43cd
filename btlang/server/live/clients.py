"""Clients at /api/ws: log-in, commands with ids, what happens on the robots, and who is here."""

from __future__ import annotations

import asyncio
import itertools
import json
from collections.abc import Awaitable, Callable

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.accounts import Identity
from btlang.server.http.access import UNREADABLE, AccessError, read_object, text_in
from btlang.server.live.client_queue import TOPICS
from btlang.server.live.robot_feeds import RobotFeed, RobotFeeds
from btlang.server.live.sockets import ConnectedClient
from btlang.support.record import Record
from btlang.task.live.feed import Allowance
from btlang.task.messages import Answer, Command, read_command
from btlang.task.store.database import StoreError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Do = Callable[[Identity, str, Command, str], Awaitable[Answer]]


SCREENS = ("robots", "watch", "tasks", "write", "runs")
MOST_PAGES, MOST_PAGES_OF_USER = 200, 20
LONGEST = 200
"""The characters of the name of a robot or mission."""
_PAUSE = 0.2  # seconds between two lists of people


class PageView(Record):
    """The view of a page.

    `mission` is the name of the one that is open, "" for none; `is_changing` says that it isn't saved.
    """

    robot: str
    screen: str
    mission: str
    is_changing: bool


class PagePresence:
    """The people who are here, for one event loop.

    All pages that say what they show get the list whenever it changes.
    """

    def __init__(self) -> None:
        self._pages: dict[ConnectedClient, tuple[int, PageView]] = {}
        self._numbers = itertools.count(1)
        self._sending: asyncio.TimerHandle | None = None

    def show(self, client: ConnectedClient, data: dict[str, Any]) -> int:
        """Note that a page shows something else. Returns its number in the list. Raises AccessError (400, 403, 429)."""
        if not client.identity.is_session:
            raise AccessError(403, "Only pages say what they show: a program isn't a person.")
        place = _place_in(data)
        number, before = self._pages.get(client, (0, None))
        if before is None:
            self._make_room(client)
            number = next(self._numbers)
        if place != before:
            self._pages[client] = number, place
            self._send_presence()
        return number

    def leave(self, client: ConnectedClient) -> None:
        """Forget a page whose socket has ended."""
        if self._pages.pop(client, None) is not None:
            self._send_presence()

    def _make_room(self, client: ConnectedClient) -> None:
        user = client.identity.user
        own = sum(page.identity.user == user for page in self._pages)
        if own >= MOST_PAGES_OF_USER or len(self._pages) >= MOST_PAGES:
            raise AccessError(429, "Too many pages are open to list them all.")

    def _send_presence(self) -> None:
        if self._sending is None:
            self._sending = asyncio.get_running_loop().call_later(_PAUSE, self._send)

    def _send(self) -> None:
        self._sending = None
        people = [
            {
                "page": number, "user": page.identity.user, "robot": place.robot, "screen": place.screen,
                "mission": place.mission, "changing": place.is_changing,
            }
            for page, (number, place) in self._pages.items()
        ]  # fmt: skip
        text = json.dumps({"type": "people", "people": people}, separators=(",", ":"))
        for page in self._pages:
            page.queue.keep("people", text, 1)


def _place_in(data: dict[str, Any]) -> PageView:
    robot, screen, mission = (text_in(data, name) for name in ("robot", "screen", "mission"))
    is_changing = data.get("changing")
    if screen not in SCREENS:
        raise AccessError(400, f"'screen' must be one of these: {', '.join(SCREENS)}.")
    if max(len(robot), len(mission)) > LONGEST:
        raise AccessError(400, f"'robot' and 'mission' must have at most {LONGEST} characters.")
    if not isinstance(is_changing, bool):
        raise AccessError(400, "'changing' must be true or false.")
    return PageView(robot, screen, mission, is_changing)


_MOST_AT_ONCE = 8  # commands of a client that wait for their answers


class ClientProtocol:
    """The subprotocol of clients (see Subprotocol). `do` does a command of somebody for a robot."""

    def __init__(self, robots: RobotFeeds, do: Do) -> None:
        self.greeting: dict[str, Any] | None = {"type": "auth_required"}
        self.refusal: dict[str, Any] = {"type": "auth_invalid", "text": "This token isn't valid."}
        self._robots, self._do, self._presence = robots, do, PagePresence()
        self._watchers: dict[ConnectedClient, tuple[frozenset[str] | None, dict[str, int]]] = {}
        """The clients with the robots that they watch, None for all, and the last changes that they know."""
        robots.came = self._came

    def token(self, data: dict[str, Any]) -> object:
        """See `Subprotocol`."""
        return data.get("token") if data.get("type") == "auth" else None

    def welcome(self, identity: Identity) -> dict[str, Any]:
        """See `Subprotocol`."""
        return {"type": "auth_ok", "user": identity.user, "role": identity.role}

    async def talk(self, client: ConnectedClient) -> None:
        """See `Subprotocol`."""
        waiting: set[asyncio.Task[None]] = set()
        try:
            while True:
                text = await client.receive()
                await client.queue.wait_for_room()  # else who asks, but never reads, would fill the memory
                while len(waiting) >= _MOST_AT_ONCE:
                    await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
                task = asyncio.create_task(self._answer(client, text))
                waiting.add(task)
                task.add_done_callback(waiting.discard)
        finally:
            self._unsubscribe(client)
            for task in waiting:
                task.cancel()
            self._presence.leave(client)

    async def _answer(self, client: ConnectedClient, text: str) -> None:
        number: Any = None
        try:
            data = read_object(text)
            number = data.pop("id", None)
            result = await self._result(client, data)
        except AccessError as error:
            result = {"ok": False, "text": error.reason, "status": error.status, "code": ""}
        except StoreError:
            result = {"ok": False, "text": UNREADABLE, "status": 503, "code": ""}
        except MissionError as error:
            result = {"ok": False, "text": str(error), "code": error.diagnostics[0].code}
        client.queue.say(json.dumps({"id": number, "type": "result", **result}, default=str))

    async def _result(self, client: ConnectedClient, data: dict[str, Any]) -> dict[str, Any]:
        kind = data.pop("type", "command")
        if kind == "ping":
            return {"ok": True}
        if kind == "subscribe":
            return self._subscribe(client, data)
        if kind == "unsubscribe":
            self._unsubscribe(client)
            return {"ok": True}
        if kind == "presence":
            return {"ok": True, "page": self._presence.show(client, data)}
        if kind != "command":
            raise AccessError(400, "'type' must be command, subscribe, unsubscribe, presence or ping.")
        robot = data.pop("robot", "")
        answer = await self._do(client.identity, str(robot), read_command(data), client.address)
        return answer.as_json()

    def _subscribe(self, client: ConnectedClient, data: dict[str, Any]) -> dict[str, Any]:
        """Subscribe to {"robots": [...], "topics": [...], "rate": N, "after": {...}, "language": "es"}: by default all
        that all robots publish, at their rate, only what comes from now on, and in the words of the missions.
        """
        robots, rate, after = data.get("robots"), data.get("rate", 0), data.get("after", {})
        topics, language = data.get("topics", list(TOPICS)), data.get("language", "")
        if robots is not None and not (isinstance(robots, list) and all(isinstance(name, str) for name in robots)):
            raise AccessError(400, "'robots' must be a list of names.")
        if not isinstance(rate, int | float) or isinstance(rate, bool) or not 0 <= rate <= 100:
            raise AccessError(400, "'rate' must be a number up to 100.")
        if not isinstance(after, dict) or not all(type(number) is int and number >= 0 for number in after.values()):
            raise AccessError(400, "'after' must have the number of a change for each robot.")
        if not isinstance(topics, list) or not all(isinstance(topic, str) and topic in TOPICS for topic in topics):
            raise AccessError(400, f"'topics' must be a list of these: {', '.join(TOPICS)}.")
        if not isinstance(language, str):
            raise AccessError(400, "'language' must be a text.")
        self._unsubscribe(client)
        client.queue.language = language
        client.allowance = Allowance(1.0 / rate if rate else 0.0)
        client.queue.topics = frozenset(topics)
        self._watchers[client] = None if robots is None else frozenset(robots), after
        for feed in self._robots.feeds.values():
            self._watch(client, feed)
        return {"ok": True}

    def _unsubscribe(self, client: ConnectedClient) -> None:
        self._watchers.pop(client, None)
        for feed in self._robots.feeds.values():
            feed.discard(client.queue)

    def _came(self, feed: RobotFeed) -> None:
        for client in self._watchers:
            self._watch(client, feed)

    def _watch(self, client: ConnectedClient, feed: RobotFeed) -> None:
        robots, after = self._watchers[client]
        if robots is None or feed.name in robots:
            feed.add(client.queue, after.get(feed.name))
