"""The rosbridge protocol at /api/rosbridge, and the process that speaks to ROS 2 for the server."""

from __future__ import annotations

import asyncio
import json
import re
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable, Sequence
from contextlib import suppress
from fnmatch import fnmatchcase
from itertools import count

from starlette.websockets import WebSocketDisconnect

from btlang.ros.bridge.replies import failures, status
from btlang.server.accounts.accounts import Identity, UserRole
from btlang.server.http.access import UNREADABLE, Access, AccessError, read_object
from btlang.server.live.sockets import LOST, ConnectedClient
from btlang.support.record import Record
from btlang.task.store.database import StoreError
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Heard = Callable[[dict[str, Any], str], object]


_LONGEST = 1_000_000  # bytes of a line
_PATIENCE = 10.0  # seconds for it to take what is written
_ENDING = 4.0  # seconds for it to end by itself


class BridgeProcess:
    """The process of `btlang.ros.bridge`, for one event loop.

    `heard` gets both parts of each line that it writes, `ended` its reason, if it gave one, when it is gone.
    """

    def __init__(self, heard: Heard, ended: Callable[[str], object]) -> None:
        self._heard, self._ended = heard, ended
        self._process: Process | None = None
        self._reading: asyncio.Task[None] | None = None
        self._turn = asyncio.Lock()

    async def start(self) -> None:
        """Start it, unless it is up. Raises OSError."""
        async with self._turn:
            if self._process is None:
                command = (sys.executable, "-P", "-m", "btlang.ros.bridge")
                self._process = await asyncio.create_subprocess_exec(
                    *command, stdin=PIPE, stdout=PIPE, limit=_LONGEST, start_new_session=True
                )
                self._reading = asyncio.create_task(self._read(self._process))

    def write(self, data: dict[str, Any]) -> None:
        """Write a line for it; do nothing if it is gone."""
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.write(json.dumps(data).encode() + b"\n")

    async def drain(self) -> None:
        """Wait until it has taken most of what was written. One that takes nothing any more is ended."""
        process = self._process
        if process is None or process.stdin is None:
            return
        try:
            async with asyncio.timeout(_PATIENCE):
                await process.stdin.drain()
        except TimeoutError:
            _kill(process)
        except OSError:
            return

    async def close(self) -> None:
        """End it: it lets go of the robot first."""
        process, reading = self._process, self._reading
        if process is None or process.stdin is None or reading is None:
            return
        process.stdin.close()
        await asyncio.wait({reading}, timeout=_ENDING)
        _kill(process)
        await process.wait()

    async def _read(self, process: Process) -> None:
        assert process.stdout is not None
        problem = ""
        try:
            while line := await process.stdout.readline():
                about, _, text = line.decode().rstrip("\n").partition("\t")
                data = json.loads(about)
                problem = data.get("problem", "")
                if not problem:
                    self._heard(data, text)
        except ValueError:  # a line that is longer than any that it writes
            _kill(process)
        finally:
            self._process = None
            self._ended(problem)
        await process.wait()


def _kill(process: Process) -> None:
    with suppress(ProcessLookupError):
        process.kill()


_NAME = re.compile(r"/?[A-Za-z][A-Za-z0-9_]*(?:/[A-Za-z][A-Za-z0-9_]*)*")
"""The form of names of the graph.

Names with a part that begins with _ are for ROS itself: they would go past the rules of goals.
"""
_LONGEST_NAME = 200  # characters of a name or an id
_SHOWN = 100  # characters of what is refused


class _Operation(Record):
    name: str  # the field that says what it is about
    role: UserRole


OPERATIONS = {
    "subscribe": _Operation("topic", UserRole.VIEWER),
    "unsubscribe": _Operation("topic", UserRole.VIEWER),
    "advertise": _Operation("topic", UserRole.OPERATOR),
    "unadvertise": _Operation("topic", UserRole.VIEWER),
    "publish": _Operation("topic", UserRole.OPERATOR),
    "call_service": _Operation("service", UserRole.OPERATOR),
    "send_action_goal": _Operation("action", UserRole.OPERATOR),
    "cancel_action_goal": _Operation("action", UserRole.VIEWER),
}
"""The operations with the least role for each. To end what one began needs none."""


class Rosbridge:
    """The subprotocol of rosbridge (see Subprotocol). `allowed` are names, with * and ? as in file names."""

    def __init__(self, access: Access, allowed: Sequence[str]) -> None:
        self.greeting: dict[str, Any] | None = None
        self.refusal = status('Log in first: {"op": "auth", "mac": TOKEN}, with a token of this server.')
        self._access, self._allowed = access, tuple(allowed)
        self._clients: dict[int, ConnectedClient] = {}
        self._numbers = count(1)
        self._bridge = BridgeProcess(self._heard, self._ended)
        self._leaving: set[asyncio.Task[None]] = set()

    def token(self, data: dict[str, Any]) -> object:
        """See `Subprotocol`."""
        return data.get("mac") if data.get("op") == "auth" else None

    def welcome(self, identity: Identity) -> None:
        """See `Subprotocol`: rosbridge has no answer for that."""

    async def talk(self, client: ConnectedClient) -> None:
        """See `Subprotocol`. What he began ends with him."""
        number = next(self._numbers)
        self._clients[number] = client
        try:
            try:
                await self._bridge.start()
            except OSError:
                raise WebSocketDisconnect(LOST) from None
            while True:
                await client.queue.wait_for_room()
                for message in await self._take(client, number, await client.receive()):
                    client.queue.say(json.dumps(message))
        finally:
            self._clients.pop(number, None)
            self._bridge.write({"client": number, "op": "leave"})

    async def close(self) -> None:
        """End the process."""
        await self._bridge.close()

    async def _take(self, client: ConnectedClient, number: int, text: str) -> list[dict[str, Any]]:
        """Hand an operation on; what to answer at once."""
        try:
            data = read_object(text)
            if data.get("op") == "auth":  # a page with a cookie may send that, too
                return [status(f"You're logged in as {client.identity.user}.", level="info")]
            _check_form(data)
            client.identity = await self._access.still(client.identity)
        except AccessError as error:
            return [status(error.reason)]
        except StoreError:
            return [status(UNREADABLE)]
        reason = self._refusal(client, data)
        if reason:
            name = str(data.get(OPERATIONS[data["op"]].name))
            what = f"{data['op']} {one_line(name[:_SHOWN])}"
            await self._access.note(client.identity.user, client.address, what, "refused")
            return failures(data, reason)
        self._bridge.write({**data, "client": number})
        await self._bridge.drain()
        return []

    def _refusal(self, client: ConnectedClient, data: dict[str, Any]) -> str:
        operation = OPERATIONS[data["op"]]
        name = data.get(operation.name)
        if not isinstance(name, str) or len(name) > _LONGEST_NAME or not _NAME.fullmatch(name):
            return f"'{operation.name}' must be a name such as /btlang/tasks, whose parts begin with letters."
        if not any(fnmatchcase(f"/{name.removeprefix('/')}", pattern) for pattern in self._allowed):
            return f"{name} isn't one of the names that this server lets through: {', '.join(self._allowed)}."
        if not client.identity.role.covers(operation.role):
            return f"Only {operation.role}s may do this: {data['op']}."
        return ""

    def _heard(self, about: dict[str, Any], text: str) -> None:
        client = self._clients.get(about["client"])
        if client is None:
            return
        if about["topic"]:
            client.queue.keep(about["topic"], text, about["most"])
        else:
            client.queue.say(text)

    def _ended(self, problem: str) -> None:
        text = json.dumps(status(problem or "The connection to ROS 2 has ended. Connect again."))
        for client in self._clients.values():
            task = asyncio.ensure_future(client.leave(LOST, text))
            self._leaving.add(task)
            task.add_done_callback(self._leaving.discard)


def _check_form(data: dict[str, Any]) -> None:
    """Raise AccessError (400) for what isn't an operation of rosbridge."""
    op = data.get("op")
    if not isinstance(op, str) or op not in OPERATIONS:
        shown = one_line(str(op)[:_SHOWN])
        raise AccessError(400, f"This server doesn't have the op '{shown}'. It has: {', '.join(OPERATIONS)}.")
    id = data.get("id")
    if not (id is None or isinstance(id, int) or (isinstance(id, str) and len(id) <= _LONGEST_NAME)):
        raise AccessError(400, f"'id' must be a text of at most {_LONGEST_NAME} characters or a whole number.")
