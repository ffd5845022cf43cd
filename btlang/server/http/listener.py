"""The server's process: TLS, the socket it listens on, and connections that say nothing."""

from __future__ import annotations

import asyncio
import logging
import os
import secrets
import socket
import ssl
from collections.abc import Callable
from contextlib import suppress

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import os_error_reason
from btlang.server.http.app import MOST_HEAD, Api
from btlang.support.private_file import write_private
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.server.accounts.certificate import Certificate

_HEAD = 10.0  # seconds for the head of the first request
_MOST_CONNECTIONS = 4000
_MOST_FRAME = 256 * 1024  # bytes


class _Protocol(H11Protocol):
    """A protocol that hangs up on who connects and says nothing: uvicorn would wait for ever."""

    def connection_made(self, transport: Any) -> None:
        super().connection_made(transport)
        self._silence = self.loop.call_later(_HEAD, self._hang_up)

    def connection_lost(self, exc: Exception | None) -> None:
        self._silence.cancel()
        super().connection_lost(exc)

    def handle_events(self) -> None:
        super().handle_events()
        if self.cycle is not None or self.transport.get_protocol() is not self:
            self._silence.cancel()

    def _hang_up(self) -> None:
        if self.cycle is None and self.transport.get_protocol() is self:
            self.transport.close()


def open_listener(host: str, port: int) -> socket.socket:
    """Open a socket that others can connect to. Raises MissionError (BT201)."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listener = socket.create_server((host, port), family=family, backlog=1024)
        # asyncio does it where sockets name their protocol, which these don't; without it each answer took 44 ms
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return listener
    except (OSError, UnicodeError, OverflowError) as error:
        reason = os_error_reason(error) if isinstance(error, OSError) else str(error)
        raise MissionError([diagnostic("BT201", NOWHERE, place=f"{host}:{port}", reason=reason)]) from None


def serve(
    api: Api, listener: socket.socket, certificate: Certificate | None, control: str, ready: Callable[[], object]
) -> None:
    """Serve until SIGINT or SIGTERM.

    Whoever connects to the Unix socket `control` says that the accounts have changed.
    """
    asyncio.run(_serve(api, web_server(api, certificate), listener, control, ready))


def web_server(api: Api, certificate: Certificate | None) -> uvicorn.Server:
    """Make the server of an API, with the limits that strangers need."""
    config = uvicorn.Config(
        api.app(), http=_Protocol, ws="websockets-sansio", lifespan="on", access_log=False, log_level="error",
        server_header=False, proxy_headers=False, limit_concurrency=_MOST_CONNECTIONS, timeout_keep_alive=10,
        h11_max_incomplete_event_size=MOST_HEAD, ws_max_size=_MOST_FRAME, ws_per_message_deflate=False,
        ws_ping_interval=20, ws_ping_timeout=20, timeout_graceful_shutdown=3,
        ssl_context_factory=None if certificate is None else lambda config, usual: tls(certificate),
    )  # fmt: skip
    # each write to a client that vanished while its questions are answered is a warning otherwise: a full log, or a
    # pipe that nobody reads, which holds up the end of the server
    logging.getLogger("asyncio").setLevel(logging.ERROR)
    return uvicorn.Server(config)


async def _serve(
    api: Api, server: uvicorn.Server, listener: socket.socket, control: str, ready: Callable[[], object]
) -> None:
    async def changed(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await api.check()
        writer.close()  # so that the caller knows that the change is in effect

    with suppress(FileNotFoundError):
        os.unlink(control)
    control_server = await asyncio.start_unix_server(changed, control)
    os.chmod(control, 0o600)
    serving = asyncio.create_task(server.serve([listener]))
    while not server.started and not serving.done():
        await asyncio.sleep(0.01)
    ready()
    try:
        await serving
    finally:
        control_server.close()
        with suppress(FileNotFoundError):
            os.unlink(control)


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
