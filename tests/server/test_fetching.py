"""The recordings of a robot on another computer, over its link."""

from __future__ import annotations

import asyncio
import http.client
import json
import os
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from btlang.server.live.robot_connection import STREAM
from btlang.server.page.recordings import PIECE, RecordingResponse, fetch
from tests.server.cable import Cable
from tests.server.doors import Door, Reply, received
from tests.server.elsewhere import Elsewhere, asked_to_watch, btc, command, in_background, invited, is_up
from tests.task.layers import LONG, wait_until

LARGE = 30_000_000


@pytest.fixture(scope="module")
def kim(door: Door, joined: Elsewhere) -> Elsewhere:
    wait_until(lambda: is_up(door, "kim"))
    return joined


@pytest.fixture(scope="module")
def folder(door: Door, kim: Elsewhere) -> Path:
    """That of its recordings, with two of them."""
    for _ in range(2):
        assert command(door, "kim", command="submit", text="nod").data["ok"]
    wait_until(lambda: len(list(kim.folder.rglob("*.mcap"))) == 2)
    wait_until(lambda: not command(door, "kim", command="list").data["data"]["tasks"])
    [folder] = {path.parent for path in kim.folder.rglob("*.mcap")}
    return folder


@pytest.fixture(scope="module")
def large(folder: Path) -> bytes:
    """What is in a recording that takes long."""
    data = os.urandom(LARGE)
    (folder / "large.mcap").write_bytes(data)
    return data


def asked(door: Door, path: str) -> Any:
    return door.ask("GET", f"/api/{path}{'&' if '?' in path else '?'}robot=kim", **door.log_in("vic"))


def started(door: Door, name: str) -> tuple[http.client.HTTPConnection, http.client.HTTPResponse]:
    """A download whose first bytes are here."""
    connection = door.connection()
    connection.request("GET", f"/api/recordings/{name}?robot=kim", headers={"cookie": door.log_in("vic")["cookie"]})
    return connection, connection.getresponse()


def test_they_are_like_those_here(door: Door, folder: Path) -> None:
    recordings = asked(door, "recordings").data["recordings"]
    one, other = sorted(path.name for path in folder.glob("2*.mcap"))
    assert {one, other} <= {each["name"] for each in recordings}
    assert {each["task"] for each in recordings} >= {1, 2}
    assert asked(door, f"recordings/{one}").body == (folder / one).read_bytes()
    film = asked(door, f"films/{one}").data
    assert (film["ok"], film["text"], film["failed"]) == (True, "nod", -1)
    assert asked(door, f"trees/{one}").data["xml"].count("<Nod/>") == 1
    assert asked(door, f"comparisons/{one}?with={other}").data["first"] is None
    (folder / "broken.mcap").write_bytes(b"no recording")
    assert asked(door, "films/broken.mcap").data["code"] == "BT084"


def test_only_recordings_are_sent(door: Door, folder: Path) -> None:
    (folder / "notes.txt").write_text("secret")
    for name in ("none.mcap", "..%2Ftasks.db", "%2Fetc%2Fpasswd", "notes.txt", "%00.mcap", "x.mcap%0A", "..mcap"):
        for path in ("recordings", "films", "trees", "comparisons"):
            assert asked(door, f"{path}/{name}").status == 404, name
    assert door.ask("GET", "/api/recordings?robot=kim").status == 401


def test_a_large_one_delays_nothing(door: Door, folder: Path, large: bytes) -> None:
    connection, response = started(door, "large.mcap")
    with closing(connection):
        assert response.headers["content-length"] == str(LARGE)
        before = door.memory
        time.sleep(2.0)  # nobody reads
        assert door.memory - before < 20
        began = time.monotonic()
        assert door.ask("POST", "/api/stop", {"robot": "kim"}, **door.log_in("vic")).status == 200
        thread, replies = in_background(response.read)
        for _ in range(5):
            assert command(door, "kim", command="status").data["ok"]
        assert time.monotonic() - began < 3.0
        thread.join(LONG)
        assert replies == [large]
    assert command(door, "kim", command="release").data["ok"]


def test_one_whose_link_breaks_goes_on(door: Door, cable: Cable, folder: Path, large: bytes) -> None:
    connection, response = started(door, "large.mcap")
    with closing(connection):
        parts = [response.read(3 * PIECE)]
        cable.cut()
        parts.append(response.read())
        assert b"".join(parts) == large


def test_one_that_is_gone_is_cut_off(door: Door, cable: Cable, folder: Path, large: bytes) -> None:
    wait_until(lambda: is_up(door, "kim"))
    connection, response = started(door, "large.mcap")
    with closing(connection):
        response.read(PIECE)
        (folder / "large.mcap").unlink()
        with pytest.raises((http.client.IncompleteRead, ConnectionError)):
            response.read()
    assert door.process.poll() is None


def test_a_robot_may_say_anything(door: Door) -> None:
    code = invited(door, "eve")
    good = {"name": "a.mcap", "bytes": 1, "time": float("nan"), "task": 0, "mission": "x"}
    lists: list[Any] = [5, {}, {"recordings": 5}, {"recordings": [5]}, {"recordings": [{**good, "bytes": "x"}]}]
    parts: list[Any] = [
        5, {}, {"size": -1, "data": ""}, {"size": 1, "data": 5}, {"size": 1, "data": "\u00e9"},
        {"size": 10**6, "data": "A" * 4 * PIECE},
    ]  # fmt: skip
    with door.socket(path="/api/join") as socket:
        socket.send(json.dumps({"type": "join", "key": "e" * 40, "code": code, "instance": "1"}))
        stream = asked_to_watch(socket)
        hello = json.dumps({"type": "hello", "change": 0, "recordings": "/etc"}).encode() + b"\n"
        socket.send(stream.to_bytes(STREAM, "big") + hello)
        wait_until(lambda: is_up(door, "eve"))

        def answered(path: str, *answers: Any) -> Reply:
            thread, replies = in_background(lambda: door.ask("GET", f"/api/{path}?robot=eve", **door.log_in("vic")))
            for answer in answers:
                asking = received(socket)
                while asking["type"] not in ("recordings", "recording"):
                    asking = received(socket)
                socket.send(json.dumps({"id": asking["id"], "answer": answer}))
            thread.join(LONG)
            reply: Reply = replies[0]
            return reply

        assert [answered("recordings", each).status for each in lists] == [503] * len(lists)
        assert [answered("films/a.mcap", each).status for each in parts] == [503] * len(parts)
        found = answered("recordings", {"recordings": [{**good, "name": "../a.mcap"}, good]}).data["recordings"]
        assert found == [{**good, "time": 0.0}]
        assert answered("recordings/a.mcap", {"size": 3, "data": "QUFBQUFB"}).body == b"AAA"
        assert answered("films/a.mcap", {"size": 10**12, "data": "QUFB"}).status == 413
        assert answered("films/a.mcap", {"missing": True}).status == 404
    wait_until(lambda: not is_up(door, "eve"))
    assert door.ask("GET", "/api/recordings?robot=eve", **door.log_in("vic")).status == 503
    btc(door, "robot", "revoke", "eve")


@pytest.mark.parametrize("then", [{"missing": True}, {"size": 9, "data": ""}, 5])
def test_a_part_is_never_the_whole(then: Any) -> None:
    """The answer isn't ended, so that the server hangs up; and nothing is raised, which it would print."""
    sent: list[Any] = []

    async def read(message: dict[str, Any]) -> Any:
        return then if message["at"] else {"size": 9, "data": "QUFB"}

    async def send(message: Any) -> None:
        sent.append(message)

    async def answer() -> None:
        await RecordingResponse(await fetch(read, "a.mcap")).stream_response(send)

    asyncio.run(answer())
    assert [each.get("body") for each in sent] == [None, b"AAA"]
    assert sent[-1]["more_body"]
