"""A server whose disk takes nothing any more: whoever has an account still logs in and leads the robot."""

from __future__ import annotations

import resource
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tests.server.doors import Door, robot_in
from tests.task.layers import wait_until


@pytest.fixture
def door() -> Iterator[Door]:
    with tempfile.TemporaryDirectory(prefix="bt") as name:
        folder = Path(name)
        (folder / "btlang").mkdir(0o700)  # for the data and the sockets both
        with robot_in(folder), closing(Door(folder)) as door:
            door.user("add", "ann", "--role", "operator")
            wait_until(lambda: door.ask("POST", "/api/commands", {"command": "status"}, **door.log_in()).data["ok"])
            yield door
        assert not any("Traceback" in line for line in door.lines)


def test_a_full_disk_keeps_nobody_from_the_robot(door: Door) -> None:
    page, token = door.log_in(), {"authorization": f"Bearer {door.user('token', 'ann', 'program').split()[-1]}"}
    resource.prlimit(door.process.pid, resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
    for who in (page, token):
        for command in ("emergency_stop", "release"):
            assert door.ask("POST", "/api/commands", {"command": command}, **who).data["ok"]
        assert door.ask("POST", "/api/stop", {}, **who).data["ok"]
        assert door.ask("POST", "/api/commands", {"command": "release"}, **who).data["ok"]
    new = door.log_in()
    assert door.ask("POST", "/api/stop", {}, **new).data["ok"]
    assert door.ask("POST", "/api/commands", {"command": "release"}, **new).data["ok"]
    refused = door.ask("POST", "/api/logout", {}, **page)
    assert refused.status == 503
    assert refused.data["text"] == "The server can't read or write its data: the disk may be full."
    assert door.ask("POST", "/api/login", {"name": "ann", "password": "wrong horse"}).status == 401
    resource.prlimit(door.process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    assert door.ask("GET", "/api/me", **new).status == 200
    door.user("passwd", "ann")
    assert door.ask("GET", "/api/me", **new).status == 401
    assert door.log_in()
