"""A client of /api/rosbridge that sends what roslibjs sends."""

from __future__ import annotations

import json
import time
from itertools import count
from typing import Any

from websockets.sync.client import ClientConnection

from tests.task.layers import LONG


class Page:
    """A client that logs in with a token, if it has one; each operation has an id."""

    def __init__(self, socket: ClientConnection, token: str = "") -> None:
        self.socket, self._numbers = socket, count(1)
        if token:
            self.send(op="auth", mac=token, client="", dest="", rand="", t=0, level="", end=0)

    def send(self, op: str, id: str = "", **fields: Any) -> str:
        """Sends an operation; the id that it has."""
        id = id or f"{op}:{next(self._numbers)}"
        self.socket.send(json.dumps({"op": op, "id": id, **fields}))
        return id

    def wait(self, **wanted: Any) -> dict[str, Any]:
        """The next message with these fields."""
        until = time.monotonic() + LONG
        while time.monotonic() < until:
            message: dict[str, Any] = json.loads(self.socket.recv(LONG))
            if wanted.items() <= message.items():
                return message
        raise AssertionError(wanted)

    def refused(self, op: str, **fields: Any) -> str:
        """Sends what has to be refused; what is said of it."""
        return str(self.wait(op="status", level="error", id=self.send(op, **fields))["msg"])
