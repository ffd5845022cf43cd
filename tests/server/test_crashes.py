"""Server and robot are killed in turn, at any moment and under load: nothing that was acknowledged is lost or done
twice, and a client that follows misses nothing.
"""

from __future__ import annotations

import asyncio
import http.client
import json
import random
import shutil
import stat
import statistics
import tempfile
import threading
import time
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException

from btlang.server.accounts.accounts import Accounts, UserRole
from btlang.server.http.listener import load_key
from btlang.task.store.records import FINAL, TaskState
from btlang.task.store.task_store import TaskStore, open_store
from tests.profiles import amount
from tests.server.doors import Door, Program
from tests.task.layers import LONG, wait_until

NAME, MISSION = "otto", "tour"
BACK = 5.0
"""Seconds after a restart within which everybody has an answer again."""
_PAUSE = 0.005  # seconds between two requests of a client, and before the next try


class Robot(Program):
    """`btc robot up` beside a server; its folder stays."""

    def __init__(self, door: Door) -> None:
        super().__init__(door.environment, "robot", "up", "--name", NAME, "--speed", "max")
        self.start()

    def start(self, beginning: str = f"The robot '{NAME}' is up") -> None:
        super().start(beginning)


class Client(ABC):
    """Does something again and again in a thread of its own, until `close`. What goes wrong there is raised by that."""

    def __init__(self, door: Door, token: str, name: str = "") -> None:
        self.door, self.name, self.headers = door, name, {"authorization": f"Bearer {token}"}
        self.asked = 0.0
        """When the latest request was sent that was answered."""
        self.refusals: Counter[str] = Counter()
        self.ended, self._latest = threading.Event(), float("inf")
        self._problem: BaseException | None = None
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self) -> None:
        """Once what has no answer yet has one."""
        self._latest = time.monotonic() + LONG
        self.ended.set()
        self._thread.join()
        if self._problem is not None:
            raise self._problem

    @abstractmethod
    def work(self) -> None:
        """Until `ended`."""

    def ask(self, method: str, path: str, data: object = None) -> dict[str, Any]:
        """The answer of the robot, nothing if there is none. Raises AssertionError some time after `close`."""
        sent = time.monotonic()
        assert sent < self._latest
        with suppress(OSError, http.client.HTTPException):
            reply = self.door.ask(method, f"{path}?robot={NAME}", data, **self.headers)
            if reply.status in (200, 409):
                self.asked = sent
                return dict(reply.data)
            self.refusals[f"{reply.status} {reply.data['text']}"] += 1
        return {}

    def _run(self) -> None:
        try:
            self.work()
        except BaseException as problem:
            self._problem = problem


class Submitter(Client):
    """Gives tasks to the robot, each with a label; one without an answer again, unless the robot has it."""

    def work(self) -> None:
        self.tasks: dict[str, int] = {}
        self.unanswered = 0
        while not self.ended.is_set():
            label = f"{self.name}{len(self.tasks)}"
            command = {"command": "submit", "robot": NAME, "text": "wave then nod", "labels": [label]}
            restart = ("give up", "again", "resume")[len(self.tasks) % 3]
            answer = self.ask("POST", "/api/commands", {**command, "restart": restart})
            if answer:
                assert answer["ok"], answer
                self.tasks[label] = answer["data"]["task"]["id"]
            else:
                found = self._found(label)
                self.unanswered += len(found)
                self.tasks.update(dict.fromkeys([label], found[0]) if found else {})
            time.sleep(_PAUSE)

    def _found(self, label: str) -> list[int]:
        states = [state.value for state in TaskState]
        listed = {"command": "list", "robot": NAME, "label": label, "states": states}
        while not (answer := self.ask("POST", "/api/commands", listed)):
            time.sleep(_PAUSE)
        return [task["id"] for task in answer["data"]["tasks"]]


class Saver(Client):
    """Saves a mission again and again, with the revision that it has; one without an answer as a Submitter does."""

    def work(self) -> None:
        self.texts: list[str] = []
        self.unanswered, count = 0, 0
        while not self.ended.is_set():
            count += 1
            text = f"print {count} then nod"
            while len(self.texts) == 0 or self.texts[-1] != text:
                saved = {"text": text, "revision": len(self.texts)}
                answer = self.ask("PUT", f"/api/missions/{MISSION}", saved)
                if answer:
                    assert answer["ok"], answer
                    self.texts.append(text)
                    assert answer["data"]["mission"]["number"] == len(self.texts)
                else:
                    found = self._found()
                    self.unanswered += len(found) - len(self.texts)
                    assert found[: len(self.texts)] == self.texts
                    self.texts = found
                time.sleep(_PAUSE)

    def _found(self) -> list[str]:
        while not (answer := self.ask("GET", f"/api/missions/{MISSION}")):
            time.sleep(_PAUSE)
        return [each["text"] for each in answer["data"]["missions"]] if answer["ok"] else []


class Follower(Client):
    """Follows the robot, and connects again when it is cut off; asks for its status meanwhile."""

    def work(self) -> None:
        self.changes: list[tuple[int, int, str]] = []
        self.sent: dict[int, float] = {}
        self.connections = 0
        asyncio.run(self._follow())

    async def _follow(self) -> None:
        address = f"wss://127.0.0.1:{self.door.port}/api/ws"
        options: dict[str, Any] = {"ssl": self.door.tls, "additional_headers": self.headers, "proxy": None}
        while not self.ended.is_set():
            with suppress(OSError, WebSocketException, EOFError):
                async with connect(address, open_timeout=LONG, **options) as server:
                    self.connections += 1
                    await self._talk(server)
            await asyncio.sleep(_PAUSE)

    async def _talk(self, server: ClientConnection) -> None:
        known = self.changes[-1][0] if self.changes else 0
        await server.send(json.dumps({"id": 0, "type": "subscribe", "after": {NAME: known}}))
        asking = asyncio.create_task(self._ask(server))
        try:
            async for text in server:
                self._take(json.loads(text))
        finally:
            asking.cancel()

    async def _ask(self, server: ClientConnection) -> None:
        with suppress(WebSocketException):
            while not self.ended.is_set():
                number = len(self.sent) + 1
                self.sent[number] = time.monotonic()
                await server.send(json.dumps({"id": number, "command": "status", "robot": NAME}))
                await asyncio.sleep(_PAUSE)
            await server.close()

    def _take(self, message: dict[str, Any]) -> None:
        assert message["type"] != "lost"
        if message["type"] == "change":
            self.changes.append((message["number"], message["task"], message["state"]))
        elif message["type"] == "result" and message["id"] and message["ok"]:
            self.asked = self.sent[message["id"]]


@pytest.fixture
def door() -> Iterator[Door]:
    """A server without a robot, in a folder with a short path."""
    folder = Path(tempfile.mkdtemp(prefix="bt"))
    (folder / "btlang").mkdir(0o700)  # for the data and the sockets both
    try:
        with closing(Door(folder)) as door:
            yield door
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@pytest.mark.long
def test_server_and_robot_are_killed_in_turn(door: Door) -> None:
    data = door.folder / "btlang"
    with closing(Accounts(str(data / "server"))) as accounts:
        accounts.add("ed", UserRole.EDITOR, "no password")
        token = accounts.add_token("ed", "program")
    draw, kills = random.Random(1), amount(2, 50)
    waits: list[float] = []
    with closing(Robot(door)) as robot, open_store(str(data / "robots" / NAME / "tasks.db")) as store:
        with ExitStack() as ends:
            submitters = [ends.enter_context(closing(Submitter(door, token, name))) for name in "abc"]
            saver = ends.enter_context(closing(Saver(door, token)))
            follower = ends.enter_context(closing(Follower(door, token)))
            clients = [*submitters, saver, follower]
            answered(clients, time.monotonic())
            for number in range(kills):
                time.sleep(draw.uniform(0.0, amount(1, 2)))
                killed = (door, robot)[number % 2]
                killed.kill()
                began = time.monotonic()
                killed.start()
                waits += answered(clients, began)
            for client in (*submitters, saver):
                client.close()
            wait_until(lambda: not store.count_tasks({state for state in TaskState if state not in FINAL}), 600.0)
            wait_until(lambda: follower.changes[-1][0] >= store.latest_change())
        check(store, submitters, saver, follower)
    unanswered = sum(each.unanswered for each in submitters)
    refused = sum((each.refusals for each in clients), Counter[str]())
    print(
        f"{kills} kills, {sum(len(each.tasks) for each in submitters)} tasks ({unanswered} without an answer),"
        f" {len(saver.texts)} saves ({saver.unanswered}), {len(follower.changes)} changes over {follower.connections}"
        f" connections: none lost, none twice, none out of order; answers after"
        f" {statistics.median(waits):.2f} s (p50), {max(waits):.2f} s (slowest); refused: {dict(refused)}"
    )
    assert max(waits) < BACK


def answered(clients: Sequence[Client], since: float) -> list[float]:
    """How long it took each client to get an answer to what it asked after a moment."""
    waits: dict[Client, float] = {}

    def all_are() -> bool:
        for client in clients:
            if client.asked > since and client not in waits:
                waits[client] = time.monotonic() - since
        return len(waits) == len(clients)

    wait_until(all_are)
    return list(waits.values())


def check(store: TaskStore, submitters: list[Submitter], saver: Saver, follower: Follower) -> None:
    """Everything is there, and once."""
    tasks = store.tasks(TaskState)
    submitted = [(label, number) for each in submitters for label, number in each.tasks.items()]
    assert sorted((task.labels[0], task.id) for task in tasks) == sorted(submitted)
    assert [revision.text for revision in store.revisions(MISSION)] == saver.texts
    assert [revision.number for revision in store.revisions(MISSION)] == list(range(1, len(saver.texts) + 1))
    changes = [(number, change.task, change.state.value) for number, change in store.changes()]
    assert follower.changes == changes
    assert [number for number, *_ in changes] == list(range(1, len(changes) + 1))
    ends = Counter(task for _, task, state in changes if TaskState(state) in FINAL)
    assert ends == Counter(task.id for task in tasks)


def test_a_secret_is_written_whole_or_made_again(tmp_path: Path) -> None:
    """A server that is killed at its first start leaves none that is empty."""
    path = tmp_path / "secret.key"
    path.touch()
    key = load_key(str(tmp_path))
    assert len(key) == 64
    assert load_key(str(tmp_path)) == key == path.read_text()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert list(tmp_path.iterdir()) == [path]
