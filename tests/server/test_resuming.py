"""Who comes back after a while gets every change that he missed, in order, and each once."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import ClientConnection

from btlang.server.live.client_queue import _MOST
from btlang.task.layer import TaskLayer
from btlang.task.store.records import TaskState
from tests.server.doors import Door, received
from tests.task.layers import LONG, submit, wait_for, wait_until
from tests.task.places import a_task


@pytest.fixture
def own_door(robot: TaskLayer) -> Iterator[Door]:
    """One that may be killed."""
    with closing(Door(robot.folder)) as door:  # type: ignore[attr-defined]
        yield door


@pytest.fixture
def token(own_door: Door, request: pytest.FixtureRequest) -> dict[str, str]:
    own_door.user("add", request.node.name, "--role", "operator")
    return {"authorization": f"Bearer {own_door.user('token', request.node.name, 'program')}"}


def subscribe(connection: ClientConnection, **fields: Any) -> int:
    """The number of the last change before those that come from now on."""
    connection.send(json.dumps({"id": 1, "type": "subscribe", **fields}))
    return int(received(connection, type="up")["change"])


def numbers_until(connection: ClientConnection, last: int) -> list[int]:
    """Those of the changes that come, until the last one; nothing may be left out."""
    numbers: list[int] = []
    while last not in numbers:
        message = json.loads(connection.recv(LONG))
        assert message["type"] != "lost"
        numbers += [message["number"]] if message["type"] == "change" else []
    return numbers


def test_a_server_that_was_killed_is_made_up_for(own_door: Door, token: dict[str, str], robot: TaskLayer) -> None:
    with own_door.socket(**token) as connection:
        first = subscribe(connection)
        wait_for(robot, submit(robot, "wave"), TaskState.COMPLETED)
        known = first + 4
        assert numbers_until(connection, known) == [first + 1, first + 2, first + 3, known]
        own_door.kill()
    wait_for(robot, submit(robot, "nod"), TaskState.COMPLETED)
    own_door.start()
    with own_door.socket(**token) as connection:
        subscribe(connection, after={"robot": known})
        wait_for(robot, submit(robot, "wave"), TaskState.COMPLETED)
        assert numbers_until(connection, known + 8) == list(range(known + 1, known + 9))


def test_a_server_that_was_killed_leaves_no_process(own_door: Door, token: dict[str, str]) -> None:
    assert own_door.ask("POST", "/api/check", {"text": "wave"}, **token).status == 200
    children = Path(f"/proc/{own_door.process.pid}/task/{own_door.process.pid}/children").read_text().split()
    assert children
    own_door.process.kill()
    wait_until(lambda: not any(Path("/proc", child).exists() for child in children))
    own_door.kill()
    own_door.start()


def test_more_was_missed_than_may_wait(own_door: Door, token: dict[str, str], robot: TaskLayer) -> None:
    """While more comes."""
    known, missed = robot.store.latest_change(), 2 * _MOST + 7
    for _ in range(missed):
        robot.store.add(a_task(earliest=1e12))
    with own_door.socket(**token) as slow, own_door.socket(**token) as quick:
        subscribe(slow, after={"robot": known}, rate=5)
        subscribe(quick, after={"robot": known})
        for _ in range(20):
            robot.store.add(a_task(earliest=1e12))
        for connection in (quick, slow):
            assert numbers_until(connection, known + missed + 20) == list(range(known + 1, known + missed + 21))


def test_who_knows_all_or_changes_of_another_store_goes_on(
    own_door: Door, token: dict[str, str], robot: TaskLayer
) -> None:
    latest = robot.store.latest_change()
    for known in (latest, latest + 1000, 2**70):
        with own_door.socket(**token) as connection:
            assert subscribe(connection, after={"robot": known, "other": 1}) == latest
            robot.store.add(a_task(earliest=1e12))
            latest += 1
            assert numbers_until(connection, latest) == [latest]


@pytest.mark.parametrize("after", [7, [1], {"robot": -1}, {"robot": "1"}, {"robot": True}, {"robot": 1.5}, None])
def test_what_is_no_number_is_refused(door: Door, after: object) -> None:
    with door.socket(authorization=f"Bearer {door.user('token', 'vic', repr(after))}") as connection:
        connection.send(json.dumps({"id": 1, "type": "subscribe", "after": after}))
        assert received(connection, id=1)["status"] == 400
        connection.send(json.dumps({"id": 2, "type": "ping"}))
        assert received(connection, id=2)["ok"]
