"""The process of the emergency stop: who may stop robots there, and that nothing keeps it from that."""

from __future__ import annotations

import http.client
import json
import os
import signal
import socket
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from btlang.task.layer import TaskLayer
from tests.server.doors import Door
from tests.task.layers import LONG, wait_until


class Stop:
    """The process of the emergency stop beside a server, as a page and as a program use it."""

    def __init__(self, door: Door, who: dict[str, str]) -> None:
        self.door, self.who = door, who
        self.port: int = door.ask("GET", "/api/me", **who).data["stop"]

    def ask(self, data: dict[str, Any], **headers: str) -> tuple[int, dict[str, Any], dict[str, str]]:
        connection = http.client.HTTPSConnection("127.0.0.1", self.port, context=self.door.tls, timeout=LONG)
        with closing(connection):
            named = {name.replace("_", "-"): value for name, value in headers.items()}
            connection.request("POST", "/api/stop", json.dumps(data), {"content-type": "text/plain", **named})
            answer = connection.getresponse()
            return answer.status, json.loads(answer.read()), {k.lower(): v for k, v in answer.getheaders()}

    def by_page(self, origin: str = "", **data: str) -> tuple[int, dict[str, Any], dict[str, str]]:
        given = {"csrf": self.who["x_csrf_token"], **data}
        return self.ask(given, cookie=self.who["cookie"], origin=origin or f"https://127.0.0.1:{self.door.port}")


@pytest.fixture
def stop(door: Door, robot: TaskLayer) -> Iterator[Stop]:
    yield Stop(door, door.log_in("vic"))
    robot.emergency.release()


def test_a_page_stops_the_robot_at_another_port(stop: Stop, robot: TaskLayer) -> None:
    status, answer, headers = stop.by_page(robot="robot", reason="smoke")
    assert (status, answer["ok"], answer["text"]) == (200, True, "The robot 'robot' is stopped.")
    assert headers["access-control-allow-origin"] == f"https://127.0.0.1:{stop.door.port}"
    assert headers["access-control-allow-credentials"] == "true"
    assert robot.emergency.is_latched
    wait_until(lambda: "emergency stop by vic: smoke" in robot.emergency.stops)


def test_a_program_stops_the_only_robot(stop: Stop, robot: TaskLayer) -> None:
    token = stop.door.user("token", "vic", "stopper")
    assert stop.ask({}, authorization=f"Bearer {token}")[0] == 200
    assert robot.emergency.is_latched


def test_nobody_else_stops_it(stop: Stop, robot: TaskLayer) -> None:
    own = stop.who["cookie"]
    refused = [
        stop.ask({"robot": "robot"}),
        stop.ask({"robot": "robot"}, authorization="Bearer btl_wrong"),
        stop.ask({"robot": "robot"}, cookie=own),
        stop.ask({"robot": "robot", "csrf": "AAAA"}, cookie=own, origin=f"https://127.0.0.1:{stop.door.port}"),
        stop.by_page(origin="https://evil.example", robot="robot"),
        stop.by_page(origin=f"http://127.0.0.1:{stop.door.port}", robot="robot"),
        stop.by_page(origin="https://[::1", robot="robot"),
    ]
    assert [status for status, *_ in refused] == [401, 401, 403, 403, 403, 403, 403]
    assert "access-control-allow-origin" not in refused[4][2]
    assert not robot.emergency.is_latched


@pytest.mark.parametrize(
    ("data", "status"),
    [({"robot": "nobody"}, 404), ({"robot": "../x"}, 404), ({"robot": 7}, 404), ({"reason": "x" * 20_000}, 413)],
)
def test_what_cannot_be_done(stop: Stop, data: dict[str, Any], status: int) -> None:
    assert stop.by_page(**data)[0] == status


def test_a_session_is_known_at_once_and_until_it_ends(stop: Stop, robot: TaskLayer) -> None:
    fresh = Stop(stop.door, stop.door.log_in("olga"))
    assert fresh.by_page()[0] == 200
    robot.emergency.release()
    stop.door.user("logout", "olga")
    wait_until(lambda: fresh.by_page(robot="nobody")[0] == 401)


def test_connections_keep_nobody_from_it(stop: Stop) -> None:
    silent = [socket.create_connection(("127.0.0.1", stop.port)) for _ in range(200)]
    assert stop.by_page()[0] == 200
    for each in silent:
        each.close()


def test_it_begins_again_when_it_is_killed(stop: Stop) -> None:
    os.kill(_process_of(stop.door), signal.SIGKILL)
    assert stop.by_page()[0] == 200  # the connection waits meanwhile


def test_it_outlives_a_server_that_is_killed(robot: TaskLayer, tmp_path: Path) -> None:
    folder = robot.folder  # type: ignore[attr-defined]
    with closing(Door(folder)) as door:
        stop = Stop(door, door.log_in("vic") if "vic" in door.user("list") else _new(door))
        door.kill()
        assert stop.by_page(robot="robot")[0] == 200
        robot.emergency.release()
        door.start()
        wait_until(lambda: stop.door.ask("GET", "/api/me", **stop.who).data["stop"])
        assert Stop(door, stop.who).by_page(robot="robot")[0] == 200
    robot.emergency.release()


def _new(door: Door) -> dict[str, str]:
    door.user("add", "vic")
    return door.log_in("vic")


def _process_of(door: Door) -> int:
    for task in Path(f"/proc/{door.process.pid}/task").iterdir():
        for child in (task / "children").read_text(encoding="ascii").split():
            if b"stop_server" in Path(f"/proc/{child}/cmdline").read_bytes():
                return int(child)
    raise AssertionError
