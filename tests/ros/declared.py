"""Missions with words of a keyword file on a ROS 2 node, against peers in processes of their own."""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

import pytest

import btlang
from btlang.backends.engine import bind_leaf
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.status import RUNNING, SUCCESS
from tests.ros.domains import free_domain
from tests.ros.processes import start

ROOT = Path(__file__).parent.parent.parent
PROFILE = str(Path(__file__).parent / "peers" / "profile.xml")
LIMIT = 15.0  # real seconds that anything is waited for
_BLOCKED = 2.0  # seconds: a tick that waits for an answer takes longer, one on a busy machine does not
PLACES = {"kitchen": (4.0, -1.0, 1.5707963), "lobby": (1.0, 2.0, None)}


def words(name: str) -> str:
    """A keyword file of tests/ros/words."""
    return (Path(__file__).parent / "words" / f"{name}.toml").read_text(encoding="utf-8")


class Peer:
    """A program of tests/ros/peers in a process of its own; its lines are read in a thread."""

    def __init__(self, program: str, *arguments: str, domain: int) -> None:
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain), "PYTHONPATH": str(ROOT)}
        self.process = start(
            sys.executable, "-W", "ignore", "-m", f"tests.ros.peers.{program}", *arguments,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment, cwd=ROOT,
        )  # fmt: skip
        self._lines: queue.Queue[str] = queue.Queue()
        self.told: list[str] = []
        self._reading = threading.Thread(target=self._read, daemon=True)
        self._reading.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._lines.put(line.rstrip("\n"))

    def expect(self, start: str, limit: float = LIMIT) -> str:
        """The next line that starts so; those before it are passed over."""
        until = time.monotonic() + limit
        while True:
            try:
                line = self._lines.get(timeout=max(0.0, until - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f"no line {start!r} after {self.told}") from None
            self.told.append(line)
            if line.startswith(start):
                return line

    def has_told(self, start: str) -> bool:
        """Whether such a line has come so far."""
        while not self._lines.empty():
            self.told.append(self._lines.get())
        return any(line.startswith(start) for line in self.told)

    def kill(self) -> None:
        """SIGKILL."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait(LIMIT)

    def close(self) -> None:
        """Lets it end, and its pipes."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait(5)
        self._reading.join(5)
        self.process.stdout.close()


class Robot:
    """A node in a domain of its own, and the missions that run on it."""

    def __init__(self, folder: Path, domain: int) -> None:
        from btlang.ros.node import SpunNode
        from btlang.ros.words.clients import RosClients

        self.domain = domain
        self.spun = SpunNode("declared", domain_id=self.domain)
        self.clients = RosClients(self.spun.node)
        self.spun.start()
        self.peers: list[Peer] = []
        self._file = folder / "words.toml"
        self.engine: Engine | None = None
        self._began = time.monotonic()
        self._clock = Clock()

    def peer(self, program: str, *arguments: str, wait: bool = True) -> Peer:
        """Starts a peer in the same domain."""
        made = Peer(program, *arguments, domain=self.domain)
        self.peers.append(made)
        if wait:
            made.expect("ready")
        return made

    def load(self, mission: str, words: str) -> Engine:
        """A mission with the words of a keyword file."""
        from btlang.ros.words.binding import bind_ros

        if not self._file.exists() or self._file.read_text(encoding="utf-8") != words:
            self._file.write_text(words, encoding="utf-8")  # a file that was written is read anew: half a second
        tree = btlang.parse_tree(mission, keywords=[str(self._file)])

        def own(entry: Any, vocabulary: Any) -> Any:
            return bind_ros(entry, tree.vocabulary, self.clients, PLACES.__getitem__)

        self.engine = Engine(tree.tree, lambda id: bind_leaf(id, tree.vocabulary, own), clock=self._clock)
        return self.engine

    def wait_for(self, holds: Callable[[], bool], limit: float = LIMIT) -> None:
        """Waits without ticking."""
        end = time.monotonic() + limit
        while not holds():
            assert time.monotonic() < end, self.clients.missing()
            time.sleep(0.02)

    def tick(self, until: Callable[[], bool], limit: float = LIMIT) -> int:
        """Ticks at 50 Hz until something holds or the mission has ended; no tick may block."""
        assert self.engine is not None
        end = time.monotonic() + limit
        while True:
            before = time.monotonic()
            status = self.engine.tick()
            took = time.monotonic() - before
            assert took < _BLOCKED, f"a tick took {took:.2f} s"
            if status != RUNNING or until():
                return status
            assert time.monotonic() < end, f"it runs on; peers told {[peer.told for peer in self.peers]}"
            time.sleep(0.02)
            self._clock.now = time.monotonic() - self._began

    def run(self, mission: str, words: str, limit: float = LIMIT, server: Peer | None = None) -> str:
        """Runs a mission to its end: "" for success, else why it failed. A server may have to find its client first."""
        self.load(mission, words)
        if server is not None:
            server.expect("found")
        if self.tick(lambda: False, limit) == SUCCESS:
            return ""
        assert self.engine is not None
        assert self.engine.failure is not None
        assert self.engine.failure.exception is None, self.engine.failure
        return self.engine.failure.reason

    def __enter__(self) -> Robot:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.engine is not None:
            self.engine.halt()
        self.clients.close(1.0)
        self.spun.close()
        for peer in self.peers:
            peer.close()
        if kind is None:
            assert self.clients.problems == []


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Robot]:
    """A robot whose node and peers end with the test. Skips where ROS 2 is not installed."""
    pytest.importorskip("rclpy", reason="ROS 2 is not installed")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", PROFILE)
    monkeypatch.setattr("btlang.ros.words.servers.ANSWER", LIMIT)  # a busy machine may hold up a server for long
    with free_domain() as domain, Robot(tmp_path, domain) as made:
        yield made
