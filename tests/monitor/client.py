"""A client of Groot2's protocol, written from its description: over real ZeroMQ, as Groot2 itself asks."""

from __future__ import annotations

import json
import random
import struct
from types import TracebackType
from typing import Any
from xml.etree import ElementTree

import msgpack
import zmq

NAMES = {0: "IDLE", 1: "RUNNING", 2: "SUCCESS", 3: "FAILURE", 4: "SKIPPED"}


class GrootClient:
    """Asks a server on this machine."""

    def __init__(self, port: int, patience: float = 10.0) -> None:
        self._context = zmq.Context()
        self.socket = self._context.socket(zmq.REQ)
        self.socket.setsockopt(zmq.RCVTIMEO, int(patience * 1000))
        self.socket.setsockopt(zmq.LINGER, 0)
        self.socket.connect(f"tcp://127.0.0.1:{port}")
        self.news = self._context.socket(zmq.SUB)
        self.news.setsockopt(zmq.RCVTIMEO, int(patience * 1000))
        self.news.setsockopt(zmq.SUBSCRIBE, b"")
        self.news.connect(f"tcp://127.0.0.1:{port + 1}")

    def __enter__(self) -> GrootClient:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._context.destroy(linger=0)

    def ask(self, letter: str, content: bytes | None = None) -> list[bytes]:
        """The frames of the reply to a question."""
        number = random.getrandbits(32)
        head = struct.pack("<BcI", 2, letter.encode(), number)
        self.socket.send_multipart([head] if content is None else [head, content])
        frames: list[bytes] = self.socket.recv_multipart()
        if frames[0] != b"error":
            assert frames[0][:6] == head
            assert len(frames[0]) == 22
        return frames

    def error(self, *frames: bytes) -> str:
        """The error that the server answers."""
        self.socket.send_multipart(frames)
        kind, text = self.socket.recv_multipart()
        assert kind == b"error"
        return str(text.decode())

    def tree(self) -> ElementTree.Element:
        return ElementTree.fromstring(self.ask("T")[1])

    def uids(self) -> dict[str, int]:
        """The numbers of all nodes by their names; of those with the same name the first."""
        found: dict[str, int] = {}
        for element in self.tree().iter():
            if "_uid" in element.attrib:
                found.setdefault(element.attrib["name"], int(element.attrib["_uid"]))
        return found

    def statuses(self) -> dict[int, str]:
        """The status of each node by its number; `IDLE (RUNNING)` was reset."""
        data = self.ask("S")[1]
        found = {}
        for uid, code in struct.iter_unpack("<HB", data):
            found[uid] = NAMES[code] if code < 10 else f"IDLE ({NAMES[code - 10]})"
        return found

    def values(self, *names: str) -> dict[str, dict[str, Any]]:
        """The blackboards of these names."""
        values: dict[str, dict[str, Any]] = msgpack.unpackb(self.ask("B", ";".join(names).encode())[1])
        return values

    def hook(self, uid: int, **changes: Any) -> list[bytes]:
        """Sets a breakpoint before a node, or what else the changes say."""
        data = {"enabled": True, "uid": uid, "mode": 0, "once": False, "desired_status": "SKIPPED", "position": 0}
        return self.ask("I", json.dumps({**data, **changes}).encode())

    def unlock(self, uid: int, status: str = "SKIPPED", *, remove: bool = True, position: int = 0) -> list[bytes]:
        data = {"uid": uid, "position": position, "desired_status": status, "remove_when_done": remove}
        return self.ask("U", json.dumps(data).encode())

    def reached(self) -> int:
        """Waits for the news that a breakpoint was reached; returns its number."""
        head, uid = self.news.recv_multipart()
        assert head[1:2] == b"N"
        return int(uid)
