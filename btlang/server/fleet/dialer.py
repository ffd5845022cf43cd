"""What `btc robot up --join` starts: dials a server elsewhere, and does its commands on a robot of this computer.

`python -m btlang.server.fleet.dialer` reads one line of JSON from standard input, the fields of `DialerSettings`. It
ends when its standard input does, with the process of the robot, or when the server doesn't know it (exit code 2).
"""

from __future__ import annotations

import asyncio
import base64
import json
import os
import secrets
import ssl
import sys
import threading
from collections.abc import Callable
from contextlib import suppress

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, WebSocketException

from btlang.diagnostics.files import os_error_reason
from btlang.server.accounts.certificate import pin
from btlang.server.fleet.fleet import pin_in
from btlang.server.http.access import AccessError
from btlang.server.live.robot_connection import STREAM, LocalConnection
from btlang.server.page.recordings import list_recordings, piece
from btlang.support.private_file import write_private
from btlang.support.record import Record
from btlang.text.formatting import one_line
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_FIRST, _LONGEST = 0.5, 30.0  # seconds between two tries, which double
_PATIENCE = 10.0  # seconds for the server's first words
_KEPT = 1000  # answers that are kept, since they may be lost on their way
_PART = 65_536  # bytes of what happens that are sent at once
_REFUSED = 2


class DialerSettings(Record):
    """The settings of a dialer: `robot` is the name on this computer, `kept` the path of a file for the key; `code` may
    be "".
    """

    robot: str
    address: str
    code: str
    kept: str


class Key(Record):
    """A key that makes a robot known to a server: `pin` is in hexadecimal digits, `code` the one it was made with."""

    pin: str
    key: str
    code: str


class RefusedError(Exception):
    """A refusal after which trying again won't help; the reason, in words."""


def key_for(settings: DialerSettings) -> Key:
    """Return the one that was kept, or a new one for a new code, kept before it is used.

    Raises RefusedError and OSError.
    """
    known = _read_key(settings.kept)
    if known is not None and settings.code in ("", known.code):
        return known
    if not settings.code:
        raise RefusedError("it isn't known there yet: it needs a --code, of 'btc robot invite' on that computer")
    try:
        made = Key(pin_in(settings.code).hex(), secrets.token_urlsafe(32), settings.code)
    except ValueError:
        raise RefusedError("a code is what 'btc robot invite' prints, whole") from None
    write_private(settings.kept, json.dumps(made.as_dict()).encode())
    return made


def _read_key(path: str) -> Key | None:
    with suppress(FileNotFoundError, ValueError, TypeError), open(path, encoding="utf-8") as file:
        return Key(**json.load(file))
    return None


class Dialer:
    """A program that keeps one connection to a server. `report` gets each change of its state, as a line."""

    def __init__(self, settings: DialerSettings, key: Key, report: Callable[[str], object]) -> None:
        self._settings, self._key, self._report = settings, key, report
        self._sockets = LocalConnection(settings.robot)
        self._instance = secrets.token_hex(8)
        self._connection: ClientConnection | None = None
        self._answers: dict[str, dict[str, Any] | None] = {}
        self._folder: str | None = None  # that of the recordings, where it is known
        self._tasks: set[asyncio.Task[None]] = set()
        self._watching: dict[int, asyncio.Task[None]] = {}

    async def dial(self) -> None:
        """Keep the connection until cancelled. Raises RefusedError if the server doesn't want it."""
        wait, problem = _FIRST, ""
        while True:
            try:
                await self._talk()
                wait, problem = _FIRST, ""
            except (OSError, ValueError, KeyError, TypeError, AttributeError, WebSocketException) as error:
                if problem != (problem := one_line(str(error)) or type(error).__name__):
                    self._report(f"No connection to {self._settings.address}: {problem}")
            await asyncio.sleep(wait)
            wait = min(2 * wait, _LONGEST)

    async def _talk(self) -> None:
        """Serve one connection, until it ends."""
        async with connect(f"{self._settings.address}/api/join", ssl=_tls()) as connection:
            self._check_pin(connection)
            join = {"type": "join", "key": self._key.key, "code": self._key.code, "instance": self._instance}
            await connection.send(json.dumps(join))
            async with asyncio.timeout(_PATIENCE):
                answer = json.loads(await connection.recv())
            if answer.get("type") != "joined":
                raise RefusedError(f"the server refuses it: {one_line(str(answer.get('text', '')))}")
            self._report(f"Joined {self._settings.address} as '{one_line(str(answer.get('name', '')))}'.")
            self._connection = connection
            try:
                with suppress(ConnectionClosed):
                    async for text in connection:
                        self._take(json.loads(text))
            finally:
                self._connection = None
                for watching in self._watching.values():
                    watching.cancel()
                self._watching.clear()
        self._report(f"The connection to {self._settings.address} broke.")

    def _check_pin(self, connection: ClientConnection) -> None:
        """Check the server's key before anything secret is sent."""
        channel = connection.transport.get_extra_info("ssl_object")
        if pin(channel.getpeercert(binary_form=True)).hex() != self._key.pin:
            raise ConnectionError("its certificate isn't that of the server which invited this robot; nothing was sent")

    def _take(self, message: dict[str, Any]) -> None:
        kind, id = message.get("type"), str(message.get("id", ""))
        if kind == "watch":
            self._watch(int(message["stream"]), message["request"])
        elif kind in ("recordings", "recording"):
            self._start(self._read(id, message))
        elif kind == "stop":
            self._start(self._stop(id))
        elif kind == "command":
            if id not in self._answers:
                self._answers[id] = None
                self._start(self._do(id, message["message"]))
            elif self._answers[id] is not None:
                self._start(self._send(self._answers[id]))

    def _start(self, work: Any) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _watch(self, stream: int, request: dict[str, Any] | None) -> None:
        if request is not None:
            self._watching[stream] = asyncio.create_task(self._forward_all(stream, request))
        elif stream in self._watching:
            self._watching.pop(stream).cancel()

    async def _do(self, id: str, message: dict[str, Any]) -> None:
        try:
            answer = {"id": id, "answer": await self._sockets.ask(message)}
        except (OSError, ValueError):
            answer = {"id": id}
        self._answers[id] = answer
        while len(self._answers) > _KEPT:
            del self._answers[next(iter(self._answers))]
        await self._send(answer)

    async def _read(self, id: str, message: dict[str, Any]) -> None:
        """Send which recordings the robot has, or a piece of one: only files that are in its folder by their names."""
        answer: dict[str, Any] = {}
        try:
            if message["type"] == "recordings" or self._folder is None:
                self._folder = await self._recordings()
            if message["type"] == "recordings":
                answer["recordings"] = await asyncio.to_thread(list_recordings, self._folder) if self._folder else []
            else:
                size, data = await asyncio.to_thread(piece, self._folder, str(message["name"]), int(message["at"]))
                answer |= {"size": size, "data": base64.b64encode(data).decode()}
        except AccessError:
            answer["missing"] = True
        except (OSError, ValueError, KeyError, TypeError):
            await self._send({"id": id})
            return
        await self._send({"id": id, "answer": answer})

    async def _recordings(self) -> str:
        """Return the folder of the recordings, "" if the robot makes none."""
        async with asyncio.timeout(_PATIENCE), self._sockets.watch({"rate": 1.0}) as reader:
            return str(json.loads(await reader.readline())["recordings"])

    async def _stop(self, id: str) -> None:
        try:
            await self._sockets.stop()
            await self._send({"id": id, "answer": True})
        except OSError:
            await self._send({"id": id})

    async def _forward_all(self, stream: int, request: dict[str, Any]) -> None:
        """Forward what happens on the robot, as fast as the connection takes it."""
        number = stream.to_bytes(STREAM, "big")
        with suppress(OSError, WebSocketException):
            async with self._sockets.watch(request) as reader:
                while (data := await reader.read(_PART)) and self._connection is not None:
                    await self._connection.send(number + data)
        await self._send({"type": "watched", "stream": stream})

    async def _send(self, message: dict[str, Any] | None) -> None:
        with suppress(WebSocketException):  # what is lost is asked for again
            if self._connection is not None:
                await self._connection.send(json.dumps(message))


def _tls() -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE  # the pin says whom we speak to
    return context


def main() -> int:
    """Dial until standard input ends; return the exit code if the server doesn't want the robot."""
    settings = DialerSettings(**json.loads(sys.stdin.readline()))
    threading.Thread(target=_end_with_robot, daemon=True).start()
    try:
        asyncio.run(Dialer(settings, key_for(settings), show).dial())
    except RefusedError as error:
        show(f"It can't join {settings.address}: {error}.")
    except OSError as error:
        show(f"It can't join {settings.address}: its key can't be kept: {os_error_reason(error)}")
    return _REFUSED


def _end_with_robot() -> None:
    sys.stdin.read()
    os._exit(0)


if __name__ == "__main__":
    sys.exit(main())
