"""Robots that are up, for the messages of `btc robot` and `btc task`: what a code needs to be shown."""

from __future__ import annotations

import socket
import sqlite3
import tempfile
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.house_rules import read_house_rules
from btlang.session import Session
from btlang.task.commands.client import socket_path
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import read_schedules
from btlang.task.store.records import MissionText, TaskState
from btlang.task.store.task_store import open_store
from tests.ros.declared import Peer
from tests.ros.domains import free_domain
from tests.task.layers import robot_up, submit, wait_for, wait_until

PROFILE = str(Path(__file__).parents[1] / "ros" / "fast_discovery.xml")
REFUSALS = ("BT186", "BT187", "BT192")
"""Codes that a robot answers with: `btc` ends with 1 then, and with 2 if it can't read a command."""
_CODES = ("BT185", "BT190", "BT198", "BT199", "BT200", *REFUSALS)
_STORES = {"BT196": "newer.db", "BT197": "busy.db"}
_SAVED = "wave then nod"


@contextmanager
def robot_for(code: str, patch: pytest.MonkeyPatch) -> Iterator[None]:
    """Puts a robot up for a code that needs one, in folders of its own, and does to it what the code is about."""
    if code in _STORES:
        with _store(code, patch):
            yield
        return
    if code == "BT088":
        with tempfile.TemporaryDirectory() as folder:
            patch.setenv("XDG_STATE_HOME", folder)
            yield
        return
    if code == "BT107":
        with _without_scanner(patch):
            yield
        return
    if code not in _CODES:
        yield
        return
    with tempfile.TemporaryDirectory() as short:  # the path of a socket has to be
        for variable in ("XDG_RUNTIME_DIR", "XDG_DATA_HOME"):
            patch.setenv(variable, short)
        with robot_up(Path(short, "data")) as layer:
            if code == "BT186":
                layer.session.robot.power.set_level(0.0)
                wait_until(lambda: (state := layer.executor.robot_state) is not None and state.battery == 0)
            if code == "BT192":
                number = submit(layer, "wait 20 h")
                wait_for(layer, number, TaskState.UNDERWAY)
                run = layer.executor.run
                assert run is not None
                run.call(lambda: run.nodes.blackboard.set("seen", object()))
            if code == "BT199":
                with _mute("kim"):
                    yield
            else:
                yield


@contextmanager
def _store(code: str, patch: pytest.MonkeyPatch) -> Iterator[None]:
    """A store in this folder: of a newer version, or in use by another process."""
    with tempfile.TemporaryDirectory() as short:
        for variable in ("XDG_RUNTIME_DIR", "XDG_DATA_HOME"):
            patch.setenv(variable, short)
        place = Path(_STORES[code])
        try:
            with open_store(str(place)) as store:
                if code == "BT197":
                    store.own()
                    yield
                    return
            with closing(sqlite3.connect(place)) as database, database:
                database.execute("UPDATE version SET number = number + 1")
            yield
        finally:
            for path in Path().glob(f"{place}*"):
                path.unlink()


@contextmanager
def _without_scanner(patch: pytest.MonkeyPatch) -> Iterator[None]:
    """A robot over ROS 2 whose scanner is off."""
    with free_domain() as domain:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        patch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", PROFILE)
        patch.setattr("btlang.ros.robot.connection._DISCOVERY", 2.0)  # with this profile all are found sooner
        peer = Peer("faulty_robot", "scan=absent", domain=domain)
        peer.expect("ready")
        try:
            yield
        finally:
            peer.close()


@contextmanager
def _mute(name: str) -> Iterator[None]:
    """A robot that hangs up on everybody."""
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(socket_path(name))
        listening.listen()

        def hang_up() -> None:
            with suppress(OSError):
                while True:
                    listening.accept()[0].close()

        thread = threading.Thread(target=hang_up)
        thread.start()
        try:
            yield
        finally:
            listening.shutdown(socket.SHUT_RDWR)
            thread.join()


def read_week(path: str) -> str:
    """What is wrong with a file of schedules, "" for nothing."""
    try:
        read_schedules(path)
    except MissionError as error:
        return str(error)
    return ""


def read_rules(path: str) -> str:
    """What is wrong with a file of house rules, "" for nothing."""
    try:
        read_house_rules(MissionReader().read(MissionText("", file=path)))
    except MissionError as error:
        return str(error)
    return ""


def restored(text: str) -> str:
    """Why a mission can't go on from a saved run of `wave then nod`, "" if it can."""
    with Session() as session:
        saved = session.prepare(parse_tree(_SAVED)).save()
        try:
            session.restore(parse_tree(text), saved)
        except MissionError as error:
            return str(error)
    return ""
