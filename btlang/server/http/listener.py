"""The server's process: TLS, the socket it listens on, and what a client may take of its time and memory."""

from __future__ import annotations

import asyncio
import ctypes
import gc
import logging
import os
import resource
import secrets
import socket
import ssl
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from ipaddress import ip_network

import h11
import uvicorn
from uvicorn.config import STARTUP_FAILURE
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import os_error_reason
from btlang.server.http.connections import HEAD, Acceptor, Connection, Connections
from btlang.support.private_file import write_private
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from starlette.types import ASGIApp

    from btlang.server.accounts.certificate import Certificate

MOST_HEAD = 16 * 1024
"""The bytes of the head of a request."""
_REFUSED = 1.0  # seconds
_MOST_FRAME = 256 * 1024  # bytes
_BUFFER = 64 * 1024  # bytes that wait for a client until its sender waits, too
_MOST_DESCRIPTORS = 8192
_RESERVED = 256  # descriptors for robots, files and databases
_MANY, _TIDY = 50, 30  # connections that have ended, and tenths of a second, after which memory is given back


class _Protocol(H11Protocol):
    """The protocol of one connection over HTTP, which hangs up on who is silent; uvicorn would wait forever."""

    def __init__(self, connection: Connection, **options: Any) -> None:
        super().__init__(**options)
        self._connection = connection
        self.app_state = {**self.app_state, "connection": connection}
        self.ws_protocol_class = partial(_WebSocketProtocol, connection)  # type: ignore[assignment]

    def connection_made(self, transport: Any) -> None:
        self._connection.transport = transport
        transport.set_write_buffer_limits(_BUFFER)
        super().connection_made(transport)

    def connection_lost(self, exc: Exception | None) -> None:
        self._connection.gone()
        super().connection_lost(exc)

    def handle_events(self) -> None:
        before = self.cycle
        super().handle_events()
        if self.cycle is not before or self.transport.get_protocol() is not self:
            self._connection.met()

    def on_response_complete(self) -> None:
        # who is answered before all was sent was refused, and may go on sending for ever
        self._connection.expect(_REFUSED if self.conn.their_state is h11.SEND_BODY else HEAD)
        super().on_response_complete()


class _WebSocketProtocol(WebSocketsSansIOProtocol):
    """The protocol of one connection over WebSocket."""

    def __init__(self, connection: Connection, **options: Any) -> None:
        super().__init__(**options)
        self._connection = connection

    def connection_lost(self, exc: Exception | None) -> None:
        self._connection.gone()
        super().connection_lost(exc)


class WebServer(uvicorn.Server):
    """A server of an ASGI application, whose connections are limited before they cost anything."""

    def __init__(self, config: uvicorn.Config, connections: Connections) -> None:
        super().__init__(config)
        self.connections = connections

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await self.lifespan.startup()
        if self.lifespan.should_exit:
            sys.exit(STARTUP_FAILURE)
        acceptors: list[Any] = [
            Acceptor(each, self.connections, self._protocol, self.config.ssl) for each in sockets or ()
        ]
        self.servers = acceptors
        self.started = True

    async def on_tick(self, counter: int) -> bool:
        """See `uvicorn.Server`; called ten times a second."""
        if self.connections.ended > _MANY and counter % _TIDY == 0:
            self.connections.ended = 0
            _return_memory()
        return await super().on_tick(counter)

    def _protocol(self, connection: Connection) -> asyncio.Protocol:
        return _Protocol(connection, config=self.config, server_state=self.server_state, app_state=self.lifespan.state)


def open_listener(host: str, port: int) -> socket.socket:
    """Open a socket that others can connect to. Raises MissionError (BT201)."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listener = socket.create_server((host, port), family=family, backlog=4096)
        # asyncio does it where sockets name their protocol, which these don't; without it each answer took 44 ms
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return listener
    except (OSError, UnicodeError, OverflowError) as error:
        reason = os_error_reason(error) if isinstance(error, OSError) else str(error)
        raise MissionError([diagnostic("BT201", NOWHERE, place=f"{host}:{port}", reason=reason)]) from None


def web_server(
    app: ASGIApp, certificate: Certificate | None, connections: Connections | None = None, proxies: Sequence[str] = ()
) -> WebServer:
    """Make the server of an application, with the limits that strangers need.

    `proxies` are the addresses and networks of proxies whose X-Forwarded-For and X-Forwarded-Proto are believed.
    """
    config = uvicorn.Config(
        app, http=_Protocol, ws=_WebSocketProtocol, lifespan="on", access_log=False, log_level="error",
        server_header=False, proxy_headers=bool(proxies), forwarded_allow_ips=[*proxies], timeout_keep_alive=int(HEAD),
        h11_max_incomplete_event_size=MOST_HEAD, ws_max_size=_MOST_FRAME, ws_per_message_deflate=False,
        ws_ping_interval=20, ws_ping_timeout=20, timeout_graceful_shutdown=3,
        ssl_context_factory=None if certificate is None else lambda config, usual: tls(certificate),
    )  # fmt: skip
    # each write to a client that vanished while its questions are answered is a warning otherwise: a full log, or a
    # pipe that nobody reads, which holds up the end of the server
    logging.getLogger("asyncio").setLevel(logging.ERROR)
    if connections is None:
        connections = Connections(proxies=[ip_network(each) for each in proxies])
    return WebServer(config, connections)


def most_connections() -> int:
    """Return how many connections this process may have, once it has asked for as many descriptors as it may get."""
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _MOST_DESCRIPTORS if most == resource.RLIM_INFINITY else min(most, _MOST_DESCRIPTORS)
    with suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, most))
    limit = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return max(limit - _RESERVED, limit // 2)


def serve(server: WebServer, listener: socket.socket, ready: Callable[[], object]) -> None:
    """Serve until SIGINT or SIGTERM; call `ready` once others can connect."""
    asyncio.run(_serve(server, listener, ready))


async def _serve(server: WebServer, listener: socket.socket, ready: Callable[[], object]) -> None:
    serving = asyncio.create_task(server.serve([listener]))
    while not server.started and not serving.done():
        await asyncio.sleep(0.01)
    ready()
    await serving


def _return_memory() -> None:
    """Give the memory of connections that have ended back to the system: what asyncio has for TLS refers to itself."""
    gc.collect()
    with suppress(OSError, AttributeError):  # it isn't glibc
        ctypes.CDLL(None).malloc_trim(0)


def tls(certificate: Certificate) -> ssl.SSLContext:
    """Make a context for TLS 1.2 and later. Raises OSError or ssl.SSLError for files that can't be used."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    # A client that reads in one thread and writes in another (websockets.sync) may lose its request to a ticket that
    # comes at the same time: ssl has no lock before Python 3.14 (python/cpython#134698).
    context.num_tickets = 0
    context.load_cert_chain(certificate.certificate, certificate.key)
    return context


def load_key(folder: str) -> str:
    """Load a secret of the server, made when it is first asked for. Raises OSError."""
    path = os.path.join(folder, "secret.key")
    if not os.path.exists(path) or os.path.getsize(path) == 0:  # an empty one would be no secret
        write_private(path, secrets.token_hex(32).encode())
    with open(path, encoding="ascii") as kept:
        return kept.read()
