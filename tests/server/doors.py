"""A server in a process of its own, and a robot in this one; its clients know http.client and websockets alone."""

from __future__ import annotations

import http.client
import io
import json
import os
import re
import socket
import ssl
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from btlang.cli import main
from btlang.task.layer import TaskLayer
from tests.forked import ROOT, Process, popen
from tests.task.layers import LONG, robot_up

PASSWORD = "correct horse battery"


class Program:
    """A command of btlang in a process of its own. Each line that is printed is kept once it has ended."""

    process: Process
    lines: list[str]

    def __init__(self, environment: dict[str, str], *words: str) -> None:
        self.environment, self._command = environment, [sys.executable, "-m", "btlang", *words]

    def start(self, beginning: str) -> None:
        """Until its first line, which has to begin so. Also again, after its end."""
        self.process = popen(
            self._command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        assert self.process.stdout is not None
        self.lines = [self.process.stdout.readline()]
        assert self.lines[0].startswith(beginning), self.lines + self.process.stdout.readlines()

    def kill(self) -> None:
        self.process.kill()
        self._end()

    def close(self) -> None:
        self.process.terminate()
        self._end()

    def _end(self) -> None:
        self.process.wait(LONG)
        assert self.process.stdout is not None
        if not self.process.stdout.closed:  # else it was killed before
            self.lines += self.process.stdout.readlines()
            self.process.stdout.close()


class Door(Program):
    """`btc serve` on a free port, over TLS unless `options` say otherwise. `folder` has to have a short path."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.folder, self.port = folder, free_port()
        environment = {**os.environ, "XDG_DATA_HOME": str(folder), "XDG_RUNTIME_DIR": str(folder)}
        super().__init__(environment, "serve", "--port", str(self.port), *options)
        self.tls = None if "--no-tls" in options else trusting()
        self.start()

    def start(self, beginning: str = "The server is up") -> None:
        """On the same port and folder each time."""
        super().start(beginning)

    @property
    def memory(self) -> float:
        """Megabytes of its process."""
        status = Path(f"/proc/{self.process.pid}/status").read_text(encoding="ascii")
        return int(status.partition("VmRSS:")[2].split()[0]) / 1024

    def user(self, *words: str, password: str = PASSWORD) -> str:
        """What `btc user` prints."""
        return btc(self.environment, "user", *words, typed=f"{password}\n").strip()

    def connection(self) -> http.client.HTTPConnection:
        if self.tls is None:
            return http.client.HTTPConnection("127.0.0.1", self.port, timeout=LONG)
        return http.client.HTTPSConnection("127.0.0.1", self.port, context=self.tls, timeout=LONG)

    def ask(self, method: str, path: str, data: object = None, **headers: str) -> Reply:
        """One request; underscores in the names of headers are dashes."""
        body = data if isinstance(data, bytes) else None if data is None else json.dumps(data).encode()
        named = {
            "content-type": "application/json",
            **{name.replace("_", "-"): value for name, value in headers.items()},
        }
        with closing(self.connection()) as connection:
            connection.request(method, path, body, named)
            with connection.getresponse() as answer:  # else its file stays open when the server hangs up within a body
                return Reply(answer.status, dict(answer.getheaders()), answer.read())

    def log_in(self, name: str = "ann", password: str = PASSWORD) -> dict[str, str]:
        """The headers of somebody who is logged in."""
        reply = self.ask("POST", "/api/login", {"name": name, "password": password})
        assert reply.status == 200, reply.body
        return {"cookie": reply.headers["set-cookie"].partition(";")[0], "x_csrf_token": reply.data["csrf"]}

    def socket(self, path: str = "/api/ws", **headers: str) -> ClientConnection:
        """A WebSocket."""
        scheme = "ws" if self.tls is None else "wss"
        address = f"{scheme}://127.0.0.1:{self.port}{path}"
        return connect(address, ssl=self.tls, additional_headers=headers, proxy=None, open_timeout=LONG)


class LocalDoor(Door):
    """A command with a page for its user, whose `token` lets a browser in, once; "" where the browser was opened."""

    def __init__(self, folder: Path, *words: str, **environment: str) -> None:
        self.folder, self.tls = folder, None
        folders = {"XDG_RUNTIME_DIR": str(folder), "TMPDIR": str(folder), "PYTHONPATH": str(ROOT)}
        self.environment = {**os.environ, **folders, **environment}
        self._command = [sys.executable, "-m", "tests.server.with_page", *words]
        self.start("")
        address = re.search(r"http://127\.0\.0\.1:(\d+)(?:/login#token=(\S+))?", self.lines[0])
        assert address is not None, self.lines
        self.port, self.token = int(address[1]), address[2] or ""

    def enter(self) -> dict[str, str]:
        """The headers of the page."""
        reply = self.ask("POST", "/api/login", {"token": self.token})
        assert reply.status == 200, reply.body
        return {"cookie": reply.headers["set-cookie"].partition(";")[0], "x_csrf_token": reply.data["csrf"]}


class Reply:
    """The answer to a request."""

    def __init__(self, status: int, headers: dict[str, str], body: bytes) -> None:
        self.status, self.headers, self.body = status, headers, body

    @property
    def data(self) -> Any:
        return json.loads(self.body)


def btc(environment: dict[str, str], *words: str, typed: str = "") -> str:
    """What a command prints that ends well. It runs in this process: to start one takes longer than the command."""
    printed, errors = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(printed), redirect_stderr(errors):
        for name in ("XDG_DATA_HOME", "XDG_RUNTIME_DIR"):
            patch.setenv(name, environment[name])
        patch.setattr(sys, "stdin", io.StringIO(typed))
        code = main(words)
    assert code == 0, errors.getvalue()
    return printed.getvalue()


@contextmanager
def robot_in(folder: Path, **options: Any) -> Iterator[TaskLayer]:
    """A robot that is up, for a server that looks for its sockets in the same folder."""
    before = os.environ.get("XDG_RUNTIME_DIR")
    os.environ["XDG_RUNTIME_DIR"] = str(folder)
    try:
        with robot_up(folder / "robot", **options) as layer:
            yield layer
    finally:
        if before is None:
            del os.environ["XDG_RUNTIME_DIR"]
        else:
            os.environ["XDG_RUNTIME_DIR"] = before


class _Locked(ssl.SSLSocket):
    """For websockets.sync, which reads and writes in two threads: ssl has no lock before Python 3.14."""

    def __new__(cls, *arguments: Any, **options: Any) -> _Locked:
        made = super().__new__(cls, *arguments, **options)
        made.lock = threading.Lock()
        return made

    lock: threading.Lock

    def recv(self, *arguments: Any) -> bytes:
        with self.lock:
            return super().recv(*arguments)

    def sendall(self, *arguments: Any) -> None:
        with self.lock:
            super().sendall(*arguments)


def trusting() -> ssl.SSLContext:
    """For tests that are not about whom one speaks to."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.sslsocket_class = _Locked
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return context


def child_of(process: int) -> int:
    """The latest process that a process started."""
    return int(Path(f"/proc/{process}/task/{process}/children").read_text(encoding="ascii").split()[-1])


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


def received(
    connection: ClientConnection, passed_over: list[dict[str, Any]] | None = None, **wanted: Any
) -> dict[str, Any]:
    """The next message with these fields, first among those that were `passed_over`; others are added to these."""
    earlier = passed_over if passed_over is not None else []
    found = next((message for message in earlier if wanted.items() <= message.items()), None)
    if found is not None:
        earlier.remove(found)
        return found
    until = time.monotonic() + LONG
    while time.monotonic() < until:
        message: dict[str, Any] = json.loads(connection.recv(LONG))
        if wanted.items() <= message.items():
            return message
        earlier.append(message)
    raise AssertionError(wanted)


def close_code(connection: ClientConnection) -> int | None:
    """That with which the server ends a socket, after what it still says."""
    with suppress(ConnectionClosed):
        while True:
            connection.recv(LONG)
    return connection.close_code
