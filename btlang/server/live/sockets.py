"""WebSockets: who comes in, whatever is spoken there, and who has to leave."""

from __future__ import annotations

import asyncio
from contextlib import suppress

from starlette.websockets import WebSocket, WebSocketDisconnect

from btlang.server.accounts.accounts import Identity
from btlang.server.http.access import Access, AccessError, address_of, admit, is_same_site, read_object
from btlang.server.live.client_queue import ClientQueue
from btlang.task.live.feed import Allowance

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    class Subprotocol(Protocol):
        """A protocol spoken over a socket. A message of None isn't sent."""

        greeting: dict[str, Any] | None
        """For somebody who isn't logged in yet."""
        refusal: dict[str, Any]
        """For somebody whose first message doesn't log him in."""

        def token(self, data: dict[str, Any]) -> object:
            """Return the token that a first message logs in with."""

        def welcome(self, identity: Identity) -> dict[str, Any] | None:
            """Return the message for somebody who is logged in now."""

        async def talk(self, client: ConnectedClient) -> None:
            """Talk until the client leaves (WebSocketDisconnect), or has to (CancelledError)."""


_LOG_IN = 10.0  # seconds that somebody has for that
REVOKED, FORBIDDEN, TOO_MANY, LOST = 4001, 4003, 4029, 1011
"""The codes with which a socket is closed."""
MOST_OF_USER = 100
"""The sockets that a user may have."""
_UNSUPPORTED = 1003  # the code for what isn't text


class ConnectedClient:
    """A client that is logged in, on one socket, with what is on its way to it."""

    def __init__(self, socket: WebSocket, identity: Identity) -> None:
        self.socket, self.identity = socket, identity
        self.queue = ClientQueue()
        self.allowance = Allowance(0.0)
        self._talk: asyncio.Task[None] | None = None
        self._code, self._last = 0, ""

    @property
    def address(self) -> str:
        """The address of the client."""
        return address_of(self.socket)

    async def receive(self) -> str:
        """Return the next text. Raises WebSocketDisconnect."""
        return await _text(self.socket)

    async def talk(self, subprotocol: Subprotocol) -> None:
        """Talk until one of both ends it."""
        sending = asyncio.create_task(self._send())
        self._talk = asyncio.create_task(subprotocol.talk(self))
        if self._code:
            self._talk.cancel()
        try:
            await asyncio.wait({self._talk})
        finally:
            sending.cancel()
            self._talk.cancel()
        if not self._talk.cancelled():
            self._talk.result()
            return
        with suppress(OSError):
            if self._last:
                await self.socket.send_text(self._last)
            await self.socket.close(self._code)

    async def leave(self, code: int, last: str = "") -> None:
        """End what the client does; its socket is closed with a code, after a last text."""
        self._code, self._last = code, last
        if self._talk is not None:
            self._talk.cancel()
            await asyncio.wait({self._talk})

    async def _send(self) -> None:
        now, queue = asyncio.get_running_loop().time, self.queue
        with suppress(WebSocketDisconnect, RuntimeError, OSError):
            while True:
                await queue.wait()
                early = self.allowance.wait(now())
                if early:
                    await queue.wait_for_answer(early)
                self.allowance.use(now())
                for text in queue.take():
                    await self.socket.send_text(text)
        queue.close()


class Sockets:
    """The sockets that are open."""

    def __init__(self, access: Access) -> None:
        self._access = access
        self._clients: set[ConnectedClient] = set()

    def __len__(self) -> int:
        return len(self._clients)

    async def serve(self, subprotocol: Subprotocol, socket: WebSocket) -> None:
        """Serve one socket, until it ends."""
        if not is_same_site(socket.headers, socket.scope["scheme"]):  # a page of another site, with our cookie
            await socket.close(FORBIDDEN)
            return
        await socket.accept()
        try:
            identity = await self._log_in(subprotocol, socket)
            if identity is None:
                return
            if sum(each.identity.user == identity.user for each in self._clients) >= MOST_OF_USER:
                await socket.close(TOO_MANY)
                return
            client = ConnectedClient(socket, identity)
            self._clients.add(client)
            try:
                await self._look(client)  # while he was welcomed, his token may have been revoked
                await client.talk(subprotocol)
            finally:
                self._clients.discard(client)
        except (WebSocketDisconnect, RuntimeError, TimeoutError):
            return

    async def check(self) -> None:
        """End the sockets of those who may no longer be here, and give the others their present role."""
        if not self._clients:
            return
        now = await asyncio.to_thread(self._access.accounts.generations)
        for client in tuple(self._clients):
            if now.get(client.identity.user) != client.identity.generation:
                await self._look(client)

    async def _look(self, client: ConnectedClient) -> None:
        now = await asyncio.to_thread(self._access.accounts.still, client.identity)
        if now is None:
            await client.leave(REVOKED)
        else:
            client.identity = now

    async def _log_in(self, subprotocol: Subprotocol, socket: WebSocket) -> Identity | None:
        with suppress(AccessError):
            identity = await self._access.identify(socket.headers, changes=False)
            admit(socket, identity.user)
            return await _welcome(subprotocol, socket, identity)
        if subprotocol.greeting is not None:
            await socket.send_json(subprotocol.greeting)
        async with asyncio.timeout(_LOG_IN):
            text = await _text(socket)
        with suppress(AccessError):
            token = subprotocol.token(read_object(text))
            found = await self._access.by_token(token) if isinstance(token, str) else None
            if found is not None:
                admit(socket, found.user)
                return await _welcome(subprotocol, socket, found)
        await socket.send_json(subprotocol.refusal)
        await socket.close(FORBIDDEN)
        return None


async def _welcome(subprotocol: Subprotocol, socket: WebSocket, identity: Identity) -> Identity:
    message = subprotocol.welcome(identity)
    if message is not None:
        await socket.send_json(message)
    return identity


async def _text(socket: WebSocket) -> str:
    try:
        return await socket.receive_text()
    except KeyError:  # bytes
        await socket.close(_UNSUPPORTED)
        raise WebSocketDisconnect(_UNSUPPORTED) from None
