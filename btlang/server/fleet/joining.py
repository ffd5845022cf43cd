"""Robots of other computers, which dial in at /api/join: the way to them goes over their WebSocket.

Commands and answers are messages of JSON with an `id`. What happens on the robot are bytes behind the number of a
stream, which both ends know from the message that asked for it. A command that is under way when the connection breaks
is sent again when it's back: the program that dials (`dialer`) does none twice, as long as it is the same `instance`.
An emergency stop is never sent again, since it would come when nobody expects it. What is asked of recordings is sent
to each new instance too.
"""

from __future__ import annotations

import asyncio
import json
import secrets
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from itertools import count

from starlette.websockets import WebSocket, WebSocketDisconnect

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.passwords import Throttle
from btlang.server.fleet.fleet import Fleet, FleetRobot
from btlang.server.http.access import Access, AccessError, address_of, admit, read_object, text_in
from btlang.server.live.robot_connection import LONGEST, STREAM
from btlang.server.live.robot_feeds import RobotFeed, RobotFeeds
from btlang.server.live.sockets import FORBIDDEN, REVOKED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_JOIN = 10.0  # seconds that a robot has to say who it is
_NOTED = 60.0  # seconds between two notes that a robot is here


class Dialed:
    """The way to a robot that dials in; see `btlang.server.live.robot_connection.RobotConnection`."""

    def __init__(self) -> None:
        self.socket: WebSocket | None = None
        self._instance = ""
        self._waiting: dict[str, tuple[dict[str, Any], asyncio.Future[Any]]] = {}
        self._streams: dict[int, asyncio.StreamReader] = {}
        self._numbers = count()
        self._closing: asyncio.Task[None] | None = None

    async def ask(self, message: dict[str, Any]) -> Any:
        """See `Reach`."""
        return await self._answer({"type": "command", "message": message})

    async def stop(self) -> None:
        """See `Reach`."""
        await self._answer({"type": "stop"})

    async def read(self, message: dict[str, Any]) -> Any:
        """See `ReachElsewhere`. It may be asked twice: nothing is done by it."""
        return await self._answer(message)

    @asynccontextmanager
    async def watch(self, request: dict[str, Any]) -> AsyncIterator[asyncio.StreamReader]:
        """See `Reach`."""
        number, reader = next(self._numbers), asyncio.StreamReader(limit=LONGEST)
        self._streams[number] = reader
        try:
            await self._send({"type": "watch", "stream": number, "request": request})
            yield reader
        finally:
            del self._streams[number]
            with suppress(OSError):
                await self._send({"type": "watch", "stream": number, "request": None})

    async def serve(self, socket: WebSocket, instance: str) -> None:
        """Serve the robot as long as it is here.

        A newer socket takes over from an older one, whose other end may be gone.
        """
        before, self.socket = self.socket, socket
        if before is not None:
            self._closing = asyncio.create_task(_close(before, FORBIDDEN))
        try:
            await self._settle(instance)
            while True:
                message = await socket.receive()
                if message["type"] != "websocket.receive" or self.socket is not socket:
                    return
                self._take(message)
        finally:
            if self.socket is socket:
                self.socket = None
                self._refuse_waiting("stop")
                for reader in self._streams.values():
                    reader.feed_eof()

    async def _settle(self, instance: str) -> None:
        """Settle what was under way when the connection broke."""
        if instance != self._instance:
            self._instance = instance
            self._refuse_waiting("command")  # it may have been done: who knew that is gone
        for message, answer in tuple(self._waiting.values()):
            if not answer.done():
                await self._send(message)

    def _refuse_waiting(self, kind: str) -> None:
        for message, answer in self._waiting.values():
            if message["type"] == kind and not answer.done():
                answer.set_exception(ConnectionResetError("the connection broke"))

    def _take(self, message: Any) -> None:
        data = message.get("bytes")
        if data is not None:
            reader = self._streams.get(int.from_bytes(data[:STREAM], "big"))
            if reader is not None:
                reader.feed_data(data[STREAM:])
            return
        answer = read_object(message.get("text") or "")
        if answer.get("type") == "watched":
            for number, reader in self._streams.items():
                if number == answer.get("stream"):
                    reader.feed_eof()
            return
        _, waiting = self._waiting.get(str(answer.get("id")), ({}, None))
        if waiting is None or waiting.done():
            return
        if "answer" in answer:
            waiting.set_result(answer["answer"])
        else:
            waiting.set_exception(ConnectionError("its program there didn't answer"))

    async def _answer(self, message: dict[str, Any]) -> Any:
        if self.socket is None and message["type"] != "recording":  # the next piece waits for the link
            raise ConnectionError("it isn't connected")
        id, answer = secrets.token_hex(8), asyncio.get_running_loop().create_future()
        message = {"id": id, **message}
        self._waiting[id] = message, answer
        try:
            if message["type"] == "stop":
                await self._send(message)
            else:
                with suppress(OSError):  # it is sent again
                    await self._send(message)
            return await answer
        finally:
            del self._waiting[id]

    async def _send(self, message: dict[str, Any]) -> None:
        if self.socket is None:
            raise ConnectionError("it isn't connected")
        try:
            await self.socket.send_text(json.dumps(message))
        except (WebSocketDisconnect, RuntimeError) as error:
            raise ConnectionError("it isn't connected") from error


class Joins:
    """The robots of a fleet among those behind the server."""

    def __init__(self, fleet: Fleet, robots: RobotFeeds, access: Access) -> None:
        self._fleet, self._robots, self._access = fleet, robots, access
        self._ways: dict[str, tuple[FleetRobot, Dialed]] = {}
        self._throttle = Throttle()  # of the trail: nobody guesses a code

    async def check(self) -> None:
        """Look again which robots may be here; the sockets of others are closed."""
        try:
            now = {robot.name: robot for robot in await asyncio.to_thread(self._fleet.robots)}
        except MissionError:
            return
        for name, (known, way) in tuple(self._ways.items()):
            if name not in now or (known.key and now[name].key != known.key):
                del self._ways[name]
                self._robots.remove(name)
                if way.socket is not None:
                    await _close(way.socket, REVOKED)
        for name, robot in now.items():
            if name in self._ways:
                self._ways[name] = robot, self._ways[name][1]
            elif name not in self._robots.feeds:
                way = Dialed()
                self._ways[name] = robot, way
                self._robots.add(RobotFeed(name, way, robot.seen))

    async def serve(self, socket: WebSocket) -> None:
        """Serve one robot that dials in, until it is gone."""
        address = address_of(socket)
        await socket.accept()
        with suppress(WebSocketDisconnect, RuntimeError, OSError):
            async with asyncio.timeout(_JOIN):
                robot, instance = await self._admit(socket, address)
            way = None if robot is None else await self._way(robot)
            if robot is None or way is None:
                reason = "it isn't known here, its code is too old, or it was revoked"
                if robot is not None:
                    reason = "a robot of this name is up on the server's own computer"
                await socket.send_json({"type": "refused", "text": reason})
                await socket.close(FORBIDDEN)
                return
            admit(socket, f"robot {robot.name}")
            await socket.send_json({"type": "joined", "name": robot.name})
            noting = asyncio.create_task(self._note(robot.name))
            try:
                await way.serve(socket, instance)
            except AccessError:  # it sent what isn't JSON
                await _close(socket, FORBIDDEN)
            finally:
                noting.cancel()

    async def _admit(self, socket: WebSocket, address: str) -> tuple[FleetRobot | None, str]:
        try:
            data = read_object(await socket.receive_text())
            key, code, instance = (text_in(data, name) for name in ("key", "code", "instance"))
            robot = await asyncio.to_thread(self._fleet.admit, key, code) if len(key) >= 32 else None
        except (MissionError, AccessError):
            robot, instance = None, ""
        if robot is not None:
            await self._access.note(robot.name, address, "join", "ok")
        elif not self._throttle.wait(address):
            self._throttle.wrong(address)
            await self._access.note("", address, "join", "refused")
        return robot, instance

    async def _way(self, robot: FleetRobot) -> Dialed | None:
        await self.check()
        return self._ways[robot.name][1] if robot.name in self._ways else None

    async def _note(self, name: str) -> None:
        while True:
            with suppress(MissionError):
                await asyncio.to_thread(self._fleet.saw, name)
            await asyncio.sleep(_NOTED)


async def _close(socket: WebSocket, code: int) -> None:
    with suppress(WebSocketDisconnect, RuntimeError, OSError):
        await socket.close(code)
