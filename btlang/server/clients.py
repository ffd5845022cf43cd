"""The WebSocket at /api/ws: log-in, commands with ids, and what happens on the robots."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from contextlib import suppress

from starlette.websockets import WebSocket, WebSocketDisconnect

from btlang.diagnostics.errors import MissionError
from btlang.server.access import Access, AccessError, is_same_site
from btlang.server.accounts import Identity
from btlang.server.bodies import read_object
from btlang.server.links import RobotLink, Robots
from btlang.server.outlet import Outlet
from btlang.task.allowance import Allowance
from btlang.task.messages import Answer, Command, read_command

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Do = Callable[[Identity, str, Command, str], Awaitable[Answer]]

_LOG_IN = 10.0  # seconds that somebody has for that
_MOST_AT_ONCE = 8  # commands of a client that wait for their answers
REVOKED, FORBIDDEN = 4001, 4003
"""Codes with which a socket is closed."""


class _Client:
    """A socket of somebody who is logged in."""

    def __init__(self, socket: WebSocket, identity: Identity) -> None:
        self.socket, self.identity = socket, identity
        self.outlet = Outlet()
        self.allowance = Allowance(0.0)
        self.robots: frozenset[str] | None = None
        self.after: dict[str, int] = {}
        self.watches = False
        self.waiting: set[asyncio.Task[None]] = set()


class Clients:
    """All sockets. `do` does a command of somebody for a robot."""

    def __init__(self, access: Access, robots: Robots, do: Do) -> None:
        self._access, self._robots, self._do = access, robots, do
        self._clients: set[_Client] = set()
        robots.came = self._came

    async def serve(self, socket: WebSocket) -> None:
        """One socket, until it ends."""
        if not is_same_site(socket.headers):  # a page of another site, with our cookie
            await socket.close(FORBIDDEN)
            return
        await socket.accept()
        try:
            identity = await self._log_in(socket)
            if identity is None:
                return
            client = _Client(socket, identity)
            self._clients.add(client)
            try:
                await self._talk(client)
            finally:
                self._forget(client)
        except (WebSocketDisconnect, RuntimeError, TimeoutError):
            return

    def __len__(self) -> int:
        return len(self._clients)

    async def check(self) -> None:
        """Ends the sockets of those who may no longer be here, and gives the others their present role."""
        self._access.forget()
        for client in tuple(self._clients):
            now = await asyncio.to_thread(self._access.accounts.still, client.identity)
            if now is None:
                self._forget(client)
                task = asyncio.ensure_future(_closed(client.socket))
                client.waiting.add(task)
            else:
                client.identity = now

    async def _log_in(self, socket: WebSocket) -> Identity | None:
        with suppress(AccessError):
            identity = await self._access.identify(socket.headers, changes=False)
            await socket.send_json({"type": "auth_ok", "user": identity.user, "role": identity.role})
            return identity
        await socket.send_json({"type": "auth_required"})
        async with asyncio.timeout(_LOG_IN):
            text = await socket.receive_text()
        with suppress(AccessError):
            data = read_object(text)
            token = data.get("token")
            is_auth = data.get("type") == "auth" and isinstance(token, str)
            found = await self._access.by_token(str(token)) if is_auth else None
            if found is not None:
                await socket.send_json({"type": "auth_ok", "user": found.user, "role": found.role})
                return found
        await socket.send_json({"type": "auth_invalid", "text": "This token isn't valid."})
        await socket.close(FORBIDDEN)
        return None

    async def _talk(self, client: _Client) -> None:
        sending = asyncio.create_task(self._send(client))
        try:
            while True:
                text = await client.socket.receive_text()
                while len(client.waiting) >= _MOST_AT_ONCE:
                    await asyncio.wait(client.waiting, return_when=asyncio.FIRST_COMPLETED)
                task = asyncio.create_task(self._answer(client, text))
                client.waiting.add(task)
                task.add_done_callback(client.waiting.discard)
        finally:
            sending.cancel()
            for task in client.waiting:
                task.cancel()

    async def _send(self, client: _Client) -> None:
        now, outlet = asyncio.get_running_loop().time, client.outlet
        with suppress(WebSocketDisconnect, RuntimeError, OSError):
            while True:
                await outlet.wait()
                early = client.allowance.wait(now())
                if early:
                    await outlet.wait_for_answer(early)
                client.allowance.use(now())
                for text in outlet.take():
                    await client.socket.send_text(text)

    async def _answer(self, client: _Client, text: str) -> None:
        number: Any = None
        try:
            data = read_object(text)
            number = data.pop("id", None)
            result = await self._result(client, data)
        except AccessError as error:
            result = {"ok": False, "text": error.reason, "status": error.status, "code": ""}
        except MissionError as error:
            result = {"ok": False, "text": str(error), "code": error.diagnostics[0].code}
        client.outlet.say(json.dumps({"id": number, "type": "result", **result}, default=str))

    async def _result(self, client: _Client, data: dict[str, Any]) -> dict[str, Any]:
        kind = data.pop("type", "command")
        if kind == "ping":
            return {"ok": True}
        if kind == "subscribe":
            return self._subscribe(client, data)
        if kind == "unsubscribe":
            self._unsubscribe(client)
            return {"ok": True}
        if kind != "command":
            raise AccessError(400, "'type' must be command, subscribe, unsubscribe or ping.")
        robot = data.pop("robot", "")
        host = client.socket.client.host if client.socket.client is not None else ""
        answer = await self._do(client.identity, str(robot), read_command(data), host)
        return answer.as_json()

    def _subscribe(self, client: _Client, data: dict[str, Any]) -> dict[str, Any]:
        """{"robots": [...], "rate": N, "after": {...}}: by default all robots, at the rate at which they tell, and only
        what is to come.
        """
        robots, rate, after = data.get("robots"), data.get("rate", 0), data.get("after", {})
        if robots is not None and not (isinstance(robots, list) and all(isinstance(name, str) for name in robots)):
            raise AccessError(400, "'robots' must be a list of names.")
        if not isinstance(rate, int | float) or isinstance(rate, bool) or not 0 <= rate <= 100:
            raise AccessError(400, "'rate' must be a number up to 100.")
        if not isinstance(after, dict) or not all(type(number) is int and number >= 0 for number in after.values()):
            raise AccessError(400, "'after' must have the number of a change for each robot.")
        self._unsubscribe(client)
        client.watches, client.allowance = True, Allowance(1.0 / rate if rate else 0.0)
        client.robots, client.after = None if robots is None else frozenset(robots), after
        for link in self._robots.links.values():
            self._watch(client, link)
        return {"ok": True}

    def _unsubscribe(self, client: _Client) -> None:
        client.watches = False
        for link in self._robots.links.values():
            link.discard(client.outlet)

    def _came(self, link: RobotLink) -> None:
        for client in self._clients:
            if client.watches:
                self._watch(client, link)

    def _watch(self, client: _Client, link: RobotLink) -> None:
        if client.robots is None or link.name in client.robots:
            link.add(client.outlet, client.after.get(link.name))

    def _forget(self, client: _Client) -> None:
        self._clients.discard(client)
        self._unsubscribe(client)


async def _closed(socket: WebSocket) -> None:
    with suppress(WebSocketDisconnect, RuntimeError, OSError):
        await socket.close(REVOKED)
