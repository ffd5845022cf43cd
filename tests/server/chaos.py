"""What goes wrong around a server, on purpose: each fault begins and ends, and a robot that is up meanwhile."""

from __future__ import annotations

import http.client
import json
import os
import resource
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from tests.server.doors import Door, Program, trusting
from tests.task.layers import LONG

NAME = "robot"
_CLOCKED = """
import sys, time
from contextlib import suppress
now, file = time.time, sys.argv.pop(1)
def clock():
    with suppress(OSError, ValueError), open(file) as ahead:
        return now() + float(ahead.read())
    return now()
time.time = clock
from btlang.cli import main
sys.exit(main(sys.argv[1:]))
"""
FILES = 1024
"""The descriptors that the server may have."""


class ClockedDoor(Door):
    """A server whose clock is as many seconds ahead as a file says."""

    def start(self, beginning: str = "The server is up") -> None:
        words = ["serve", "--port", str(self.port)]
        self._command = [sys.executable, "-c", _CLOCKED, str(self.folder / "ahead"), *words]
        super().start(beginning)


class World:
    """A robot and its server, in processes of their own."""

    def __init__(self, folder: Path, *options: str) -> None:
        (folder / "btlang").mkdir(0o700)
        self.folder = folder
        environment = {**os.environ, "XDG_DATA_HOME": str(folder), "XDG_RUNTIME_DIR": str(folder)}
        self.robot = Program(environment, "robot", "up", "--name", NAME, *options)
        self.robot.start(f"The robot '{NAME}' is up")
        self.door = ClockedDoor(folder)
        self.limit()
        for name, role in (("ann", "administrator"), ("vic", "viewer")):
            self.door.user("add", name, "--role", role)
        self.ann, self.vic = self.door.log_in("ann"), self.door.log_in("vic")
        self.stop_port: int = self.door.ask("GET", "/api/me", **self.ann).data["stop"]

    def limit(self) -> None:
        """Leave the server few descriptors."""
        resource.prlimit(self.door.process.pid, resource.RLIMIT_NOFILE, (FILES, FILES))

    def close(self) -> None:
        for each in (self.door, self.robot):
            with suppress(ProcessLookupError):
                os.kill(each.process.pid, signal.SIGCONT)
            each.close()

    def command(self, tag: str, **fields: Any) -> dict[str, Any]:
        """What the robot answers, past the server."""
        with socket.socket(socket.AF_UNIX) as connection:
            connection.settimeout(LONG)
            connection.connect(str(self.folder / "btlang" / f"{NAME}.sock"))
            connection.sendall(json.dumps({"command": tag, **fields}).encode() + b"\n")
            with connection.makefile("rb") as lines:
                answer: dict[str, Any] = json.loads(lines.readline())
                return answer

    def stop(self) -> float:
        """Press the button of a page: over both ways at once. Returns after how many seconds one has confirmed it."""
        began, confirmed, ended = time.monotonic(), threading.Event(), []

        def press(port: int) -> None:
            connection = http.client.HTTPSConnection("127.0.0.1", port, context=trusting(), timeout=3)
            with suppress(OSError, http.client.HTTPException), closing(connection):
                headers = {
                    "cookie": self.ann["cookie"], "x-csrf-token": self.ann["x_csrf_token"],
                    "content-type": "application/json", "origin": f"https://127.0.0.1:{self.door.port}",
                }  # fmt: skip
                connection.request("POST", "/api/stop", json.dumps({"robot": NAME}), headers)
                if connection.getresponse().status == 200:
                    ended.append(time.monotonic() - began)
                    confirmed.set()

        for port in (self.door.port, self.stop_port):
            threading.Thread(target=press, args=(port,), daemon=True).start()
        assert confirmed.wait(3), "nobody has confirmed the stop"
        return min(ended)


@contextmanager
def no_descriptors(world: World) -> Iterator[None]:
    """More silent connections than there are descriptors."""
    with ExitStack() as stack:
        for _ in range(FILES + 36):
            with suppress(OSError):
                stack.enter_context(socket.create_connection(("127.0.0.1", world.door.port), 1))
        yield


@contextmanager
def half_handshakes(world: World) -> Iterator[None]:
    """Handshakes that nobody goes on with, from many addresses."""
    with ExitStack() as stack:
        for number in range(400):
            with suppress(OSError):
                each = socket.create_connection(("127.0.0.1", world.door.port), 1, (f"127.0.1.{number % 100}", 0))
                stack.enter_context(each).sendall(b"\x16\x03\x01")
        yield


@contextmanager
def full_disk(world: World) -> Iterator[None]:
    """A disk that takes nothing more from the server."""
    pid, free = world.door.process.pid, resource.RLIM_INFINITY
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (1000, free))
    try:
        yield
    finally:
        with suppress(ProcessLookupError):
            resource.prlimit(pid, resource.RLIMIT_FSIZE, (free, free))


@contextmanager
def wrong_clock(world: World) -> Iterator[None]:
    """A clock that jumps a day ahead, and back again."""
    ahead = world.folder / "ahead"
    ahead.write_text("86400", encoding="ascii")
    try:
        yield
    finally:
        ahead.unlink()


@contextmanager
def half_bodies(world: World) -> Iterator[None]:
    """Large bodies that don't end, from somebody who is logged in."""
    head = (
        f"POST /api/commands HTTP/1.1\r\nhost: 127.0.0.1:{world.door.port}\r\ncookie: {world.vic['cookie']}\r\n"
        f"x-csrf-token: {world.vic['x_csrf_token']}\r\ncontent-type: application/json\r\n"
        "content-length: 1000000\r\n\r\n"
    )
    yield from _flood(world, head.encode() + b" " * 900_000, 100)


@contextmanager
def never_read(world: World) -> Iterator[None]:
    """Sockets that ask for everything, and read nothing of it."""
    head = (
        f"GET /api/ws HTTP/1.1\r\nhost: 127.0.0.1:{world.door.port}\r\ncookie: {world.vic['cookie']}\r\n"
        "connection: upgrade\r\nupgrade: websocket\r\nsec-websocket-version: 13\r\n"
        "sec-websocket-key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )
    asks = json.dumps({"id": "x" * 60_000, "type": "subscribe"}).encode()
    frame = b"\x81\xff" + len(asks).to_bytes(8, "big") + bytes(4) + asks  # masked, with zeros
    yield from _flood(world, head.encode() + frame * 3, 150)


def _flood(world: World, said: bytes, count: int) -> Iterator[None]:
    with ExitStack() as stack:
        for _ in range(count):
            with suppress(OSError):
                plain = stack.enter_context(socket.create_connection(("127.0.0.1", world.door.port), 1))
                shaken = stack.enter_context(world.door.tls.wrap_socket(plain))  # type: ignore[union-attr]
                shaken.settimeout(0.3)
                shaken.sendall(said)
        yield


@contextmanager
def hung_server(world: World) -> Iterator[None]:
    """A server that neither answers nor ends."""
    pid = world.door.process.pid
    os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGCONT)


@contextmanager
def killed_server(world: World) -> Iterator[None]:
    """A server that is killed, and comes back."""
    world.door.kill()
    try:
        yield
    finally:
        world.door.start()
        world.limit()


@contextmanager
def killed_robot(world: World) -> Iterator[None]:
    """A robot whose process is killed, and comes back."""
    world.robot.kill()
    try:
        yield
    finally:
        world.robot.start(f"The robot '{NAME}' is up")


@contextmanager
def hung_robot(world: World) -> Iterator[None]:
    """A robot that neither answers nor ends."""
    os.kill(world.robot.process.pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(world.robot.process.pid, signal.SIGCONT)


Fault = Callable[[World], Any]
HARMLESS: tuple[Fault, ...] = (
    no_descriptors, half_handshakes, full_disk, wrong_clock, half_bodies, never_read, hung_server, killed_server,
)  # fmt: skip
"""The faults that leave the robot as it is: it is stopped within a second."""
FAULTS: tuple[Fault, ...] = (*HARMLESS, killed_robot, hung_robot)
