"""A server for a robot on its own computer: Unix sockets that only its user can open, with a line of JSON a message.

The emergency stop has a socket of its own, whose thread does nothing else: no number of other commands delays it.
"""

from __future__ import annotations

import fcntl
import json
import os
import socket
import struct
import threading
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, contextmanager, suppress

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.robots.files import socket_folder
from btlang.task.commands.client import socket_path
from btlang.task.messages import Answer, EmergencyStop
from btlang.text.json_text import load_json
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Handle = Callable[[Any, str], Answer]

MOST_BYTES = 4_000_000
"""The limit of one message: a line without an end would fill the memory."""
_LEAVE = 2.0  # seconds that the last answers get
_RATE = 20.0  # messages of one kind in a second, if nobody says another one
_UNREADABLE = object()
_LOOK = 0.5  # seconds between two looks whether a socket is still there
_WAITING = 128  # connections that may wait to be taken


class SocketServer:
    """A server for one robot on Unix sockets, until `close`.

    `handle` does a command in JSON for a person: the user of the process that sent it, or the one whom that names as
    "as". `stop` is the emergency stop. `watch` reports what happens (see live/feed.py) to a client that sends
    {"watch": {...}}. Raises MissionError (BT190) if a robot of this name is up.
    """

    def __init__(
        self,
        name: str,
        handle: Handle,
        stop: Callable[[str], object],
        watch: Callable[..., Generator[dict[str, Any]]] | None = None,
    ) -> None:
        self._handle, self._stop, self._watch = handle, stop, watch
        self._busy, self._answered = 0, threading.Condition()
        self._paths = [socket_path(name), socket_path(name, stop=True)]
        self._lock = os.open(f"{self._paths[0]}.lock", os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # which ends with the process, however it ends
        except OSError:
            os.close(self._lock)
            raise MissionError([diagnostic("BT190", NOWHERE, name=name)]) from None
        self._closed = False
        self._sockets = [_listen(path) for path in self._paths]
        self._threads = [
            threading.Thread(target=self._accept, args=(0, self._begin), daemon=True, name="btlang door"),
            threading.Thread(target=self._accept, args=(1, self._be_stopped), daemon=True, name="btlang stop"),
        ]

    def start(self) -> None:
        """Begin to take commands."""
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Take no more commands; those under way are answered first. May be called twice."""
        with self._answered:
            self._answered.wait_for(lambda: not self._busy, _LEAVE)
            self._closed = True
        for each, path in zip(self._sockets, self._paths, strict=True):
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()
            with suppress(OSError):
                os.unlink(path)
        with suppress(OSError):
            os.close(self._lock)

    def _accept(self, which: int, take: Callable[[socket.socket], object]) -> None:
        """Hand on who connects. A socket that somebody took away is made again: the robot can always be reached."""
        while not self._closed:
            try:
                connection, _ = self._sockets[which].accept()
            except TimeoutError:
                self._look(which)
                continue
            except OSError:
                if self._closed:
                    return
                continue
            connection.settimeout(None)
            take(connection)

    def _look(self, which: int) -> None:
        with self._answered:  # so that nothing is made again once it is closed
            if not self._closed and not os.path.exists(self._paths[which]):
                with suppress(OSError, MissionError):
                    socket_folder()
                    self._sockets[which].close()
                    self._sockets[which] = _listen(self._paths[which])

    def _begin(self, connection: socket.socket) -> None:
        threading.Thread(target=self._serve, args=(connection,), daemon=True, name="btlang caller").start()

    def _be_stopped(self, connection: socket.socket) -> None:
        """Stop the robot for whoever connects. Nothing that they do afterwards delays it."""
        self._stop(_person(connection))
        with suppress(OSError), connection:
            connection.settimeout(0.0)
            connection.sendall(b"stopped\n")

    def _serve(self, connection: socket.socket) -> None:
        person = _person(connection)
        with suppress(OSError), connection, connection.makefile("rb") as lines:
            while line := lines.readline(MOST_BYTES):
                data = _read(line)
                if isinstance(data, dict) and "watch" in data and self._watch is not None:
                    self._stream(connection, data["watch"])
                    return
                with self._at_work():
                    answer = self._answer(data, person)
                    connection.sendall(json.dumps(answer.as_json(), default=str).encode() + b"\n")
                if not line.endswith(b"\n"):
                    return

    @contextmanager
    def _at_work(self) -> Iterator[None]:
        with self._answered:
            self._busy += 1
        try:
            yield
        finally:
            with self._answered:
                self._busy -= 1
                self._answered.notify_all()

    def _stream(self, connection: socket.socket, wanted: object) -> None:
        """Send what happens, until one side ends."""
        assert self._watch is not None
        known = wanted if isinstance(wanted, dict) else {}
        rate, after = known.get("rate", _RATE), known.get("after")
        if not isinstance(rate, int | float) or not isinstance(after, int | None):
            rate, after = _RATE, None
        with closing(self._watch(rate, after)) as messages, suppress(MissionError):
            for message in messages:
                connection.sendall(json.dumps(message, default=str).encode() + b"\n")

    def _answer(self, data: object, person: str) -> Answer:
        if data is _UNREADABLE:
            return Answer(False, "That isn't a line of JSON.", {}, "BT198")
        if isinstance(data, dict):
            other = data.pop("as", "")
            person = other if isinstance(other, str) and other else person
            if data.get("command") == EmergencyStop.tag:
                self._stop(person)  # first of all; what follows writes it down
        return self._handle(data, person)


def _read(line: bytes) -> object:
    try:
        return load_json(line)
    except ValueError:
        return _UNREADABLE


def _listen(path: str) -> socket.socket:
    with suppress(FileNotFoundError):
        os.unlink(path)  # nobody listens there: the lock is ours
    listening = socket.socket(socket.AF_UNIX)
    before = os.umask(0o177)
    try:
        listening.bind(path)
    finally:
        os.umask(before)
    listening.listen(_WAITING)
    listening.settimeout(_LOOK)
    return listening


def _person(connection: socket.socket) -> str:
    """Return the name of the user whose process is at the other end."""
    try:
        _, user, _ = struct.unpack("3i", connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))
    except (OSError, AttributeError):  # only this user can open it anyway
        user = os.getuid()
    import pwd

    try:
        return pwd.getpwuid(user).pw_name
    except KeyError:
        return str(user)
