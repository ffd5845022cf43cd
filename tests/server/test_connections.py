"""Who may be connected to a server, how long without a word, and who goes where there are too many."""

from __future__ import annotations

import asyncio
import http.client
import socket
import ssl
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from ipaddress import ip_network
from pathlib import Path
from typing import Any

import pytest
from starlette.types import Receive, Scope, Send

from btlang.server.accounts.certificate import load_certificate
from btlang.server.http.connections import Connections, group_of
from btlang.server.http.listener import open_listener, web_server
from tests.server.doors import Door, trusting
from tests.task.layers import wait_until


async def hello(scope: Scope, receive: Receive, send: Send) -> None:
    """An application that admits whoever sends a name in its path."""
    if scope["type"] == "lifespan":
        while (message := await receive())["type"] != "lifespan.shutdown":
            await send({"type": f"{message['type']}.complete"})
        await send({"type": "lifespan.shutdown.complete"})
        return
    user = scope["path"].strip("/")
    admitted = not user or scope["state"]["connection"].admit(user)
    await send({"type": "http.response.start", "status": 200 if admitted else 429, "headers": []})
    await send({"type": "http.response.body", "body": scope["client"][0].encode()})


class Server:
    """A server in a thread, with these connections."""

    def __init__(self, tls: Path | None = None, proxies: tuple[str, ...] = (), **limits: Any) -> None:
        self.connections = Connections(proxies=[ip_network(each) for each in proxies], **limits)
        certificate = None if tls is None else load_certificate(str(tls), "127.0.0.1")
        self.listener = open_listener("127.0.0.1", 0)
        self.port = self.listener.getsockname()[1]
        self.server = web_server(hello, certificate, self.connections, proxies)
        self.opened: list[socket.socket] = []

    def connect(self, address: str = "127.0.0.1") -> socket.socket:
        self.opened.append(socket.create_connection(("127.0.0.1", self.port), 5, (address, 0)))
        return self.opened[-1]

    def ask(self, path: str = "/", address: str = "127.0.0.1", **headers: str) -> tuple[int, str]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5, source_address=(address, 0))
        with closing(connection):
            connection.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
            answer = connection.getresponse()
            return answer.status, answer.read().decode()


@contextmanager
def serving(**options: Any) -> Iterator[Server]:
    made = Server(**options)
    thread = threading.Thread(target=lambda: asyncio.run(made.server.serve([made.listener])))
    thread.start()
    try:
        wait_until(lambda: made.server.started)
        yield made
    finally:
        for each in made.opened:
            each.close()
        made.server.should_exit = True
        thread.join()


def is_open(connection: socket.socket) -> bool:
    connection.setblocking(False)
    try:
        return connection.recv(1) != b""
    except BlockingIOError:
        return True
    except OSError:
        return False


def test_who_comes_takes_the_place_of_the_oldest_stranger_of_the_same_address() -> None:
    with serving(of_address=3) as server:
        silent = [server.connect() for _ in range(3)]
        other = server.connect("127.0.0.2")
        wait_until(lambda: len(server.connections) == 4)
        assert server.ask() == (200, "127.0.0.1")
        assert [is_open(each) for each in (*silent, other)] == [False, True, True, True]


def test_where_all_places_are_taken_a_stranger_of_the_address_with_most_goes() -> None:
    with serving(strangers=4, of_address=3) as server:
        first = server.connect("127.0.0.2")
        wait_until(lambda: len(server.connections) == 1)
        many = [server.connect("127.0.0.3") for _ in range(3)]
        wait_until(lambda: len(server.connections) == 4)
        assert server.ask(address="127.0.0.4")[0] == 200
        assert [is_open(each) for each in (first, *many)] == [True, False, True, True]


def test_an_address_at_which_somebody_has_logged_in_keeps_places() -> None:
    with serving(strangers=2, of_address=3) as server:
        assert server.ask("/ann", "127.0.0.9")[0] == 200
        wait_until(lambda: len(server.connections) == 0)
        strangers = [server.connect(f"127.0.0.{number}") for number in (2, 3)]
        wait_until(lambda: len(server.connections) == 2)
        known = server.connect("127.0.0.9")
        wait_until(lambda: len(server.connections) == 3)
        assert all(is_open(each) for each in (*strangers, known))
        server.connect("127.0.0.5")
        wait_until(lambda: not is_open(strangers[0]))
        assert is_open(known)


def test_a_user_has_so_many_connections() -> None:
    with serving(of_user=2) as server:
        with closing(http.client.HTTPConnection("127.0.0.1", server.port)) as one:
            with closing(http.client.HTTPConnection("127.0.0.1", server.port)) as two:
                for each in (one, two):
                    each.request("GET", "/ann")
                    assert each.getresponse().read() == b"127.0.0.1"
                assert server.ask("/ann")[0] == 429
                assert server.ask("/bo")[0] == 200
            wait_until(lambda: len(server.connections) == 1)
        wait_until(lambda: len(server.connections) == 0)
        assert server.ask("/ann")[0] == 200


def test_a_proxy_is_believed_and_not_limited() -> None:
    with serving(proxies=("127.0.0.7",), of_address=1) as server:
        many = [server.connect("127.0.0.7") for _ in range(5)]
        assert server.ask(address="127.0.0.7", x_forwarded_for="6.6.6.6, 10.1.2.3")[1] == "10.1.2.3"
        assert server.ask(address="127.0.0.1", x_forwarded_for="10.1.2.3")[1] == "127.0.0.1"
        assert all(is_open(each) for each in many)


def test_who_is_silent_is_hung_up_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In each state: before the handshake, in it, in a head, and between two requests."""
    for place in ("connections", "listener"):
        monkeypatch.setattr(f"btlang.server.http.{place}.HEAD", 0.3)
    with serving(tls=tmp_path) as server:
        said = [b"", b"\x16\x03\x01", b"x" * 100]
        plain = [server.connect() for _ in said]
        for connection, text in zip(plain, said, strict=True):
            connection.sendall(text)
        shaken = [trusting().wrap_socket(server.connect()) for _ in range(3)]
        shaken[1].sendall(b"GET / HTTP/1.1\r\nhost: x\r\n")
        shaken[2].sendall(b"GET / HTTP/1.1\r\nhost: x\r\n\r\nGET / HTT")
        for connection in (*plain, *shaken):
            connection.settimeout(5)
            with suppress(ConnectionResetError, ssl.SSLError):
                while connection.recv(1000):
                    pass
            connection.close()
        wait_until(lambda: len(server.connections) == 0)


def test_no_descriptor_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stranger goes then: the next one comes in."""
    with serving() as server:
        silent = server.connect()
        wait_until(lambda: len(server.connections) == 1)
        accept, refusals = server.listener.accept, iter([OSError(24, "Too many open files")])

        class Listener:
            def accept(self) -> Any:
                for refusal in refusals:
                    raise refusal
                return accept()

            def __getattr__(self, name: str) -> Any:
                return getattr(server.listener, name)

        [acceptor] = server.server.servers
        monkeypatch.setattr(acceptor, "_listener", Listener())
        assert server.ask()[0] == 200
        assert not is_open(silent)


@pytest.mark.parametrize(
    ("host", "group"),
    [
        ("10.0.0.1", "10.0.0.1"), ("::ffff:10.0.0.1", "10.0.0.1"), ("2001:db8::1", "2001:db8::/64"),
        ("2001:db8::ffff:1", "2001:db8::/64"), ("::1", "::1"), ("fe80::1%eth0", "fe80::/64"), ("nowhere", "nowhere"),
    ],
)  # fmt: skip
def test_an_ipv6_site_counts_as_one_address(host: str, group: str) -> None:
    assert group_of(host) == group


def test_silent_connections_cost_nothing(door: Door) -> None:
    """Each had cost 280 kB, and more of them than there are descriptors had ended what follows the robots."""
    before, began = door.memory, time.monotonic()
    silent = [socket.create_connection(("127.0.0.1", door.port)) for _ in range(300)]
    assert door.ask("GET", "/live").body == b"live"
    assert door.memory - before < 20
    assert time.monotonic() - began < 10
    for each in silent:
        each.close()
