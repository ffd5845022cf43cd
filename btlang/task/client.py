"""Speaks to a robot that is up on this computer."""

from __future__ import annotations

import json
import socket
from contextlib import suppress

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.task.messages import Answer, Command, as_json
from btlang.task.paths import USUAL_NAME, names_up, socket_path
from btlang.text.source import NOWHERE

_PATIENCE = 30.0  # seconds for an answer


class Client:
    """Sends commands to the robot of a name, "" for the only one that is up. Raises MissionError (BT185) if there is
    no such robot, or several.
    """

    def __init__(self, name: str = "") -> None:
        self.name = name or _only_name()
        self._socket = _connected(self.name, socket_path(self.name))
        self._lines = self._socket.makefile("rb")

    def send(self, command: Command) -> Answer:
        """What the robot answers. Raises MissionError (BT199) if it doesn't."""
        try:
            self._socket.sendall(json.dumps(as_json(command)).encode() + b"\n")
            answer = json.loads(self._lines.readline())
            return Answer(answer["ok"], answer["text"], answer["data"], answer["code"])
        except (OSError, ValueError, KeyError, TypeError):
            raise MissionError([diagnostic("BT199", NOWHERE, name=self.name)]) from None

    def close(self) -> None:
        """Hangs up."""
        self._lines.close()
        self._socket.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close()


def emergency_stop(name: str = "") -> None:
    """Stops a robot at once, over the socket that is for nothing else. Raises MissionError (BT185, BT199)."""
    name = name or _only_name()
    with _connected(name, socket_path(name, stop=True)) as connection:
        try:
            done = connection.recv(16)
        except OSError:
            done = b""
    if not done:
        raise MissionError([diagnostic("BT199", NOWHERE, name=name)])


def _only_name() -> str:
    listening = []
    for name in names_up():
        with suppress(MissionError):
            _connected(name, socket_path(name)).close()
            listening.append(name)
    if len(listening) > 1:
        names = ", ".join(listening)
        what = f"Several robots are up: {names}"
        raise MissionError([diagnostic("BT185", NOWHERE, what=what, advice="Say which: --name NAME")])
    return listening[0] if listening else USUAL_NAME


def _connected(name: str, path: str) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX)
    connection.settimeout(_PATIENCE)
    try:
        connection.connect(path)
    except OSError:
        connection.close()
        what = "No robot is up" if name == USUAL_NAME else f"No robot '{name}' is up"
        start = "btc robot up" if name == USUAL_NAME else f"btc robot up --name {name}"
        raise MissionError([diagnostic("BT185", NOWHERE, what=what, advice=f"Start it with: {start}")]) from None
    return connection
