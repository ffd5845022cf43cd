"""A server keeps its word: who is revoked is out, what is shown has an age, and what fails begins again."""

from __future__ import annotations

import asyncio
import json
import tempfile
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack, asynccontextmanager, closing
from typing import Any

import pytest

from btlang.server.live import sockets
from btlang.server.live.client_queue import ClientQueue
from btlang.server.live.robot_feeds import RobotFeed, RobotFeeds
from btlang.server.live.supervision import restarts, supervise
from btlang.task.layer import TaskLayer
from tests.server.doors import Door, close_code, received
from tests.task.layers import wait_until


@pytest.fixture
def elsewhere() -> Iterator[str]:
    """A runtime directory that isn't the server's, as a shell of another log-in has it."""
    with tempfile.TemporaryDirectory(prefix="bt") as folder:
        yield folder


def test_a_token_that_is_revoked_from_any_shell_ends_its_socket(door: Door, elsewhere: str) -> None:
    """The notice had gone over a socket in the runtime directory: the open one went on commanding."""
    token = door.user("token", "olga", "shell")
    here = door.environment
    with door.socket(authorization=f"Bearer {token}") as socket:
        received(socket, type="auth_ok")
        door.environment = {**here, "XDG_RUNTIME_DIR": elsewhere}
        try:
            assert door.user("revoke", "olga", "shell") == "The token 'shell' is no longer valid."
        finally:
            door.environment = here
        socket.send(json.dumps({"id": 1, "command": "pause"}))
        began = time.monotonic()
        assert close_code(socket) == 4001
        assert time.monotonic() - began < 3
    assert door.ask("GET", "/api/me", authorization=f"Bearer {token}").status == 401


def test_a_command_of_a_revoked_token_is_refused_before_its_socket_ends(door: Door) -> None:
    token = door.user("token", "olga", "quick")
    with door.socket(authorization=f"Bearer {token}") as socket:
        received(socket, type="auth_ok")
        door.user("revoke", "olga", "quick")
        socket.send(json.dumps({"id": 1, "command": "pause"}))
        message = json.loads(socket.recv(5))
        assert (message.get("status"), message.get("ok")) == (401, False)


def test_two_servers_on_one_folder_send_the_same_people_away(door: Door, robot: TaskLayer) -> None:
    """The second one had taken over the control socket: a removed editor saved through the first."""
    with closing(Door(robot.folder)) as other:  # type: ignore[attr-defined]
        door.user("add", "eve", "--role", "editor")
        who = door.log_in("eve")
        with ExitStack() as stack:
            open_ones = [stack.enter_context(each.socket(cookie=who["cookie"])) for each in (door, other)]
            for each in open_ones:
                received(each, type="auth_ok")
            door.user("remove", "eve")
            for server in (door, other):
                put = server.ask("PUT", "/api/missions/mine", {"text": "wave"}, **who)
                assert put.status == 401
            assert [close_code(each) for each in open_ones] == [4001, 4001]


def test_a_user_has_so_many_sockets(door: Door) -> None:
    token = {"authorization": f"Bearer {door.user('token', 'vic', 'many')}"}
    with ExitStack() as stack:
        for _ in range(sockets.MOST_OF_USER):
            stack.enter_context(door.socket(**token))
        with door.socket(**token) as one_more:
            assert close_code(one_more) == sockets.TOO_MANY
        assert door.ask("GET", "/api/me", **token).status == 200


def test_a_stop_reason_is_cut(door: Door, robot: TaskLayer) -> None:
    who = door.log_in("vic")
    assert door.ask("POST", "/api/stop", {"reason": "x" * 900_000}, **who).data["ok"]
    status = door.ask("POST", "/api/commands", {"command": "status"}, **who)
    assert len(status.body) < 5_000
    robot.emergency.release()


def test_a_browser_finds_an_icon(door: Door) -> None:
    reply = door.ask("GET", "/favicon.ico")
    assert (reply.status, reply.body[:5]) == (200, b"<svg ")


class Connection:
    """A way to a robot that says some lines, then nothing."""

    def __init__(self, *messages: dict[str, Any], code: str = "") -> None:
        self._lines = b"".join(json.dumps(each).encode() + b"\n" for each in messages)
        self._code = code

    async def ask(self, message: dict[str, Any]) -> Any:
        return {"ok": False, "text": "The store /home/ann/secret can't be used: full.", "data": {}, "code": self._code}

    @asynccontextmanager
    async def watch(self, request: dict[str, Any]) -> AsyncIterator[asyncio.StreamReader]:
        reader = asyncio.StreamReader()
        reader.feed_data(self._lines)
        yield reader


def test_an_answer_has_no_places_of_a_computer() -> None:
    from btlang.task.messages import Pause

    feed = RobotFeed("kim", Connection(code="BT195"))  # type: ignore[arg-type]
    answer = asyncio.run(feed.send(Pause(), "ann"))
    assert (answer.ok, answer.code, "/home" in answer.text) == (False, "BT195", False)


def test_who_comes_late_hears_how_old_the_readings_are_by_then() -> None:
    async def heard() -> list[dict[str, Any]]:
        hello = {"type": "hello", "change": 3}
        feed = RobotFeed("kim", Connection(hello, {"type": "ages", "t": 100.0, "state": 1.0, "scan": None}))  # type: ignore[arg-type]
        following = asyncio.create_task(feed.follow())
        while not (feed.is_up and feed._ages):
            await asyncio.sleep(0.01)
        await asyncio.sleep(0.2)
        queue = ClientQueue()
        feed.add(queue)
        following.cancel()
        return [json.loads(text) for text in queue.take()]

    *_, ages = asyncio.run(heard())
    assert ages["type"] == "ages"
    assert ages["scan"] is None
    assert 0.2 <= ages["state"] - 1.0 < 2.0
    assert ages["t"] - 100.0 == pytest.approx(ages["state"] - 1.0)


def test_only_the_newest_ages_wait_for_a_client() -> None:
    from btlang.server.live.client_queue import RobotNews

    async def taken() -> list[str]:
        queue = ClientQueue()
        for number in range(3):
            queue.put(RobotNews("kim", {"type": "ages", "t": number, "state": 0.0, "scan": 0.0}))
        return queue.take()

    assert [json.loads(text)["t"] for text in asyncio.run(taken())] == [2]


def test_what_fails_begins_again_and_is_told_once(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("btlang.server.live.supervision._AGAIN", 0.0)
    done = []

    async def work() -> None:
        done.append(1)
        if len(done) < 4:
            raise OSError(24, "Too many open files")

    before = restarts["look"]
    asyncio.run(supervise("look", work))
    assert (len(done), restarts["look"] - before) == (4, 3)
    assert (
        capsys.readouterr().err == "The server can't look, and tries again: OSError: [Errno 24] Too many open files\n"
    )


def test_robots_are_followed_although_their_folder_can_not_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """EMFILE had ended what looks for robots, and all that followed them with it."""
    monkeypatch.setattr("btlang.server.live.robot_feeds._AGAIN", 0.01)
    looks = []

    def names_up() -> list[str]:
        looks.append(1)
        raise OSError(24, "Too many open files")

    monkeypatch.setattr("btlang.server.live.robot_feeds.names_up", names_up)

    async def follow() -> bool:
        feeds = RobotFeeds()
        feeds.add(RobotFeed("kim", Connection({"type": "hello", "change": 0})))  # type: ignore[arg-type]
        following = asyncio.create_task(feeds.follow())
        await asyncio.sleep(0.1)
        is_up = feeds.feeds["kim"].is_up and not following.done()
        following.cancel()
        return is_up

    assert asyncio.run(follow())
    assert len(looks) > 1


def test_a_feed_says_how_old_its_readings_are(robot: TaskLayer) -> None:
    """Each second, also where nothing happens: the state is read between tasks, too."""
    with closing(robot.feed.watch()) as messages:
        ages: list[dict[str, Any]] = []
        while len(ages) < 2:
            message = next(messages)
            if message["type"] == "ages":
                ages.append(message)
    assert 0.5 < ages[1]["t"] - ages[0]["t"] < 3
    assert ages[1]["state"] < 1.5
    wait_until(lambda: robot.feed._ages()["state"] < 0.5)
