"""How a robot is reached: over the Unix sockets of this computer; `joining` has those of other computers."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from btlang.task.commands.client import socket_path

TYPE_CHECKING = False
if TYPE_CHECKING:
    from contextlib import AbstractAsyncContextManager
    from typing import Any, Protocol

    class RobotConnection(Protocol):
        """A connection to a robot. What it raises is an OSError, or a TimeoutError; who calls sets the time to wait."""

        async def ask(self, message: dict[str, Any]) -> Any:
            """Send a command in JSON; return the answer."""

        async def stop(self) -> None:
            """Send the emergency stop; when it returns, the robot has it."""

        def watch(self, request: dict[str, Any]) -> AbstractAsyncContextManager[asyncio.StreamReader]:
            """Give what happens (see task/live/feed.py), a line of JSON each."""

    class RemoteConnection(RobotConnection, Protocol):
        """A connection to a robot of another computer."""

        async def read(self, message: dict[str, Any]) -> Any:
            """Return what the program beside the robot says of its recordings: see server/fleet/dialer.py."""


LONGEST = 32_000_000
"""The bytes of a line from a robot."""
STREAM = 4
"""The bytes of the number of a stream, before what happens on a robot elsewhere."""


class LocalConnection:
    """A connection to a robot of this computer, over its Unix sockets."""

    def __init__(self, name: str) -> None:
        self._name = name

    async def ask(self, message: dict[str, Any]) -> Any:
        """See `RobotConnection`. Raises ValueError for an answer that isn't JSON."""
        async with _connect(socket_path(self._name)) as (reader, writer):
            writer.write(json.dumps(message).encode() + b"\n")
            return json.loads(await reader.readline())

    async def stop(self) -> None:
        """See `RobotConnection`. The socket is for nothing else."""
        async with _connect(socket_path(self._name, stop=True)) as (reader, _):
            if not await reader.read(16):
                raise ConnectionError("it has hung up")

    @asynccontextmanager
    async def watch(self, request: dict[str, Any]) -> AsyncIterator[asyncio.StreamReader]:
        """See `RobotConnection`."""
        async with _connect(socket_path(self._name)) as (reader, writer):
            writer.write(json.dumps({"watch": request}).encode() + b"\n")
            yield reader


@asynccontextmanager
async def _connect(path: str) -> AsyncIterator[tuple[asyncio.StreamReader, asyncio.StreamWriter]]:
    reader, writer = await asyncio.open_unix_connection(path, limit=LONGEST)
    try:
        yield reader, writer
    finally:
        writer.close()
