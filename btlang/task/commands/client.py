"""Clients of a robot that is up on this computer, and where it keeps its files and sockets."""

from __future__ import annotations

import getpass
import json
import os
import re
import socket
from contextlib import suppress

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import os_error_reason
from btlang.robots.files import socket_folder
from btlang.support.user_dirs import user_dir
from btlang.task.execution.emergency import latch_path, shut_latch
from btlang.task.messages import Answer, Command, EmergencyStop, as_json, wrong
from btlang.text.source import NOWHERE

USUAL_NAME = "robot"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,31}")


def check_name(name: str) -> str:
    """Return the name. Raises MissionError (BT198) if it can't be part of a file name."""
    if _NAME.fullmatch(name) is None:
        raise wrong(name, "it must be up to 32 letters, digits, '-' and '_'")
    return name


def data_folder(name: str) -> str:
    """Return what the robot keeps: its store, its recordings, its latch."""
    return os.path.join(user_dir("data"), "robots", check_name(name))


def robots_known() -> list[str]:
    """Name of robots that were up some time."""
    folder = os.path.join(user_dir("data"), "robots")
    names = os.listdir(folder) if os.path.isdir(folder) else []
    return sorted(name for name in names if _NAME.fullmatch(name))


def socket_path(name: str, stop: bool = False) -> str:
    """Return the socket for commands to a robot; with `stop` the one for the emergency stop alone."""
    return os.path.join(socket_folder(), f"{check_name(name)}{'.stop' if stop else ''}.sock")


def names_up() -> list[str]:
    """List the robots that have a socket. After a crash, it may be that nobody listens there."""
    return sorted(
        entry.removesuffix(".sock")
        for entry in os.listdir(socket_folder())
        if entry.endswith(".sock") and not entry.endswith(".stop.sock")
    )


_PATIENCE = 30.0  # seconds for an answer


class RobotClient:
    """A client of the robot of a name, "" for the only one that is up.

    Raises MissionError (BT185) if there is no such robot, or several.
    """

    def __init__(self, name: str = "") -> None:
        self.name = name or _only_name()
        self._socket = _connect(self.name, socket_path(self.name))
        self._lines = self._socket.makefile("rb")

    def send(self, command: Command) -> Answer:
        """Return what the robot answers. Raises MissionError (BT199) if it doesn't."""
        try:
            self._socket.sendall(json.dumps(as_json(command)).encode() + b"\n")
            answer = json.loads(self._lines.readline())
            return Answer(answer["ok"], answer["text"], answer["data"], answer["code"])
        except (OSError, ValueError, KeyError, TypeError):
            raise MissionError([diagnostic("BT199", NOWHERE, name=self.name)]) from None

    def close(self) -> None:
        """Hang up."""
        self._lines.close()
        self._socket.close()

    def __enter__(self) -> RobotClient:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close()


def emergency_stop(name: str = "", reason: str = "") -> list[str]:
    """Stop a robot at once, over the socket that is for nothing else; without a name all that are up.

    One that doesn't answer, and that was up some time, is stopped by its latch: at once if its process lives, else from
    its next start.

    Returns a line for each. Raises MissionError (BT185) if there is no such robot, BT195 if a latch can't be written.
    """
    names = [name] if name else find_listening() or robots_known()
    lines = [_report_stop(each, reason) for each in names]
    if not names or None in lines:
        raise _nobody(name or USUAL_NAME)
    return [each for each in lines if each is not None]


def _report_stop(name: str, reason: str) -> str | None:
    """Return what to say; None where there never was such a robot."""
    for stop in (True, False):
        with suppress(MissionError, OSError), _connect(name, socket_path(name, stop=stop)) as connection:
            if not stop:
                connection.sendall(json.dumps(as_json(EmergencyStop(reason))).encode() + b"\n")
            if connection.recv(16):
                return f"The robot '{name}' is stopped. Nothing moves it until: btc robot release"
    folder = data_folder(name)
    if not os.path.isdir(folder):
        return None
    try:
        shut_latch(folder, getpass.getuser(), reason)
    except OSError as error:
        raise MissionError(
            [diagnostic("BT195", NOWHERE, place=latch_path(folder), reason=os_error_reason(error))]
        ) from None
    return f"The robot '{name}' doesn't answer. If it is up, it stops in a moment; it stays stopped when it comes up."


def _only_name() -> str:
    listening = find_listening()
    if len(listening) > 1:
        names = ", ".join(listening)
        what = f"Several robots are up: {names}"
        raise MissionError([diagnostic("BT185", NOWHERE, what=what, advice="Say which: --name NAME")])
    known = robots_known()
    return listening[0] if listening else USUAL_NAME if USUAL_NAME in known or len(known) != 1 else known[0]


def find_listening() -> list[str]:
    """List the robots that are up."""
    found = []
    for name in names_up():
        with suppress(MissionError):
            _connect(name, socket_path(name)).close()
            found.append(name)
    return found


def _connect(name: str, path: str) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX)
    connection.settimeout(_PATIENCE)
    try:
        connection.connect(path)
    except OSError:
        connection.close()
        raise _nobody(name) from None
    return connection


def _nobody(name: str) -> MissionError:
    what = "No robot is up" if name == USUAL_NAME else f"No robot '{name}' is up"
    start = "btc robot up" if name == USUAL_NAME else f"btc robot up --name {name}"
    return MissionError([diagnostic("BT185", NOWHERE, what=what, advice=f"Start it with: {start}")])
