"""`--groot` as Groot2 sees it: the tree, statuses, blackboards, recordings and breakpoints, over ZeroMQ."""

from __future__ import annotations

import json
import socket
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from xml.etree import ElementTree

import pytest
import zmq
from hypothesis import given
from hypothesis import strategies as st

import btlang
from btlang.cli import main
from btlang.monitor.groot import GrootMonitor, GrootServer
from btlang.monitor.groot_protocol import MOST_NODES, GrootTree
from btlang.run.controls import Controls
from btlang.session import Run, Session
from btlang.tree.node import Node, Tree
from tests.monitor.client import GrootClient
from tests.profiles import amount, searches

PATROL = """
round is wave then nod
greet name with {words} means say {words}
set counter to 3
round, then round
if the battery is below 5%, charge
wait 60 s
"""


def free_port() -> int:
    """One that is free, and the one behind it."""
    while True:
        with socket.socket() as one, socket.socket() as other:
            one.bind(("127.0.0.1", 0))
            port = one.getsockname()[1]
            try:
                other.bind(("127.0.0.1", port + 1))
            except (OSError, OverflowError):
                continue
            return int(port)


@contextmanager
def monitored(text: str, speed: float = 20.0) -> Iterator[tuple[GrootClient, Run]]:
    """A run in a thread, and a client that watches it."""
    port, controls = free_port(), Controls()
    server = GrootServer(port, controls)
    mission = btlang.parse_tree(text)
    with Session() as session:
        monitor = GrootMonitor(server)
        run = session.prepare(mission, speed=speed, controls=controls, hooks=monitor.hooks)
        monitor.watch_run(run, mission)
        run.start()
        try:
            with GrootClient(port) as client:
                yield client, run
        finally:
            run.stop()
            run.wait(10)
            server.close()


def wait_for(client: GrootClient, uid: int, status: str, seconds: float = 20.0) -> None:
    until = time.monotonic() + seconds
    while client.statuses()[uid] != status:
        assert time.monotonic() < until, (client.statuses(), status)
        time.sleep(0.02)


def test_the_tree_has_a_tree_for_each_use_of_a_subtree() -> None:
    with monitored("round is wave then nod\nround, then round") as (client, _):
        tree = client.tree()
    trees = {element.attrib["_fullpath"]: element for element in tree.iter("BehaviorTree")}
    assert list(trees) == ["", "round::2", "round::6"]
    assert [element.attrib["ID"] for element in trees.values()] == ["MainTree", "round", "round"]
    uids = [int(element.attrib["_uid"]) for element in tree.iter() if "_uid" in element.attrib]
    assert sorted(uids) == list(range(1, 10))
    assert [element.attrib["_fullpath"] for element in tree.iter("SubTree")] == ["round::2", "round::6"]
    assert {element.attrib["ID"] for element in tree.find("TreeNodesModel") or ()} >= {"Wave", "Nod"}


def test_statuses_follow_the_run() -> None:
    with monitored("wave, then wait 60 s") as (client, run):
        uids = client.uids()
        wait_for(client, uids["wave"], "SUCCESS")
        assert client.statuses()[1] == "RUNNING"
        run.stop()
        run.wait(10)
        assert set(client.statuses().values()) == {"SUCCESS", "IDLE (RUNNING)"}


def test_blackboards() -> None:
    with monitored('set counter to 3\nset mood to "fine"\nwait 60 s') as (client, _):
        wait_for(client, 1, "RUNNING")
        values = client.values("MainTree", "nothing")
        assert values == {"MainTree": {"counter": 3, "mood": "fine"}}


def test_transitions_are_recorded_from_the_start_on() -> None:
    with monitored("repeat forever: wave") as (client, _):
        uid = client.uids()["wave"]
        [_, began] = client.ask("r", b"start")
        assert abs(int(began) / 1e6 - time.time()) < 5
        time.sleep(1.0)
        [_, data] = client.ask("t")
        found = [(low | high << 32, node, code) for low, high, node, code in struct.iter_unpack("<IHHB", data)]
        assert found
        assert all(0 <= at < 5e6 and node in (1, uid) for at, node, _ in found)
        assert [at for at, _, _ in found] == sorted(at for at, _, _ in found)
        client.ask("r", b"stop")
        client.ask("t")
        time.sleep(0.3)
        assert client.ask("t")[1] == b""


def test_a_breakpoint_pauses_the_run_and_the_robot() -> None:
    with monitored("wait 2 s, then move forward 1 m, then say hello") as (client, run):
        uid = client.uids()["move forward 1 m"]
        client.hook(uid)
        assert client.reached() == uid
        assert run.controls.paused
        assert client.statuses()[uid] in ("RUNNING", "IDLE (RUNNING)")
        before = run.nodes
        assert json.loads(client.ask("D")[1])[0]["uid"] == uid
        client.unlock(uid)
        outcome = run.wait(20)
        assert outcome is not None
        assert outcome.succeeded
        assert before is run.nodes
        assert json.loads(client.ask("D")[1]) == []


def test_a_breakpoint_is_answered_with_a_status() -> None:
    with monitored("wait 2 s, then move forward 1 m, then say hello") as (client, run):
        uid = client.uids()["move forward 1 m"]
        client.hook(uid)
        client.reached()
        client.unlock(uid, "FAILURE")
        outcome = run.wait(20)
        assert outcome is not None
        assert not outcome.succeeded


@pytest.mark.parametrize(("status", "succeeds"), [("SUCCESS", True), ("FAILURE", False)])
def test_a_node_can_be_replaced(status: str, succeeds: bool) -> None:
    with monitored("wait 2 s, then check bumped, then say hello") as (client, run):
        client.hook(client.uids()["bumped"], mode=1, desired_status=status)
        outcome = run.wait(20)
        assert outcome is not None
        assert outcome.succeeded == succeeds


def test_behind_a_node() -> None:
    with monitored("wait 2 s, then wave, then wait 60 s") as (client, run):
        uid = client.uids()["wave"]
        client.hook(uid, position=1, once=True)
        assert client.reached() == uid
        assert run.controls.paused
        client.ask("A")
        run.resume()
        wait_for(client, uid, "SUCCESS")


def test_nobody_there_is_no_reason_to_stand_still(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.monitor.groot._HEARTBEAT", 0.3)
    with monitored("wait 2 s, then wave") as (client, run):
        client.hook(client.uids()["wave"])
        outcome = run.wait(20)
        assert outcome is not None
        assert outcome.succeeded


@pytest.mark.parametrize(
    ("frames", "told"),
    [
        ([b""], "wrong request header"),
        ([b"garbage garbage"], "wrong request header"),
        ([b"\x01T\0\0\0\0"], "protocol 1"),
        ([b"\x02?\0\0\0\0"], "Request not recognized"),
        ([b"\x02B\0\0\0\0"], "2 parts"),
        ([b"\x02I\0\0\0\0", b"{"], ""),
        ([b"\x02I\0\0\0\0", b"[1, 2]"], ""),
        ([b"\x02I\0\0\0\0", b'{"uid": 1}'], "position"),
        ([b"\x02I\0\0\0\0", b'{"uid": 1e999}'], "infinity"),
        ([b"\x02U\0\0\0\0", b'{"uid": 1, "position": 0, "desired_status": "SKIPPED", "remove_when_done": true}'],
         "Node ID not found"),
        ([b"\x02I\0\0\0\0",
          b'{"enabled": true, "uid": 99, "mode": 0, "once": true, "desired_status": "IDLE", "position": 0}'],
         "Node ID not found"),
        ([b"\x02I\0\0\0\0", b"[" * 50_000], "too many brackets"),
    ],
)  # fmt: skip
def test_garbage_is_answered(frames: list[bytes], told: str) -> None:
    with monitored("wait 60 s") as (client, _):
        client.uids()
        assert told in client.error(*frames)
        assert client.statuses()  # it still answers


def test_any_bytes_leave_it_alive() -> None:
    with monitored("wait 60 s") as (client, run):

        @searches(100, 5000)
        @given(st.lists(st.binary(max_size=40), min_size=1, max_size=3))
        def send(frames: list[bytes]) -> None:
            client.socket.send_multipart(frames)
            client.socket.recv_multipart()

        send()
        client.ask("A")
        assert client.statuses()[1] == "RUNNING"
        assert run.is_under_way


def test_silent_clients_do_not_delay_a_tick() -> None:
    """Some send and never read, some only connect."""
    with monitored("repeat forever: wave", speed=1.0) as (client, run):
        context = zmq.Context()
        silent = [context.socket(zmq.DEALER if number % 2 else zmq.REQ) for number in range(20)]
        for one in silent:
            one.connect(client.socket.getsockopt(zmq.LAST_ENDPOINT))
            one.send_multipart([b"", b"\x02S\0\0\0\0"] if one.type == zmq.DEALER else [b"\x02S\0\0\0\0"])
        time.sleep(1.0)
        assert client.statuses()
        assert run.is_under_way
        context.destroy(linger=0)


def test_a_client_beside_others_is_answered() -> None:
    with monitored("repeat forever: wave") as (client, _):
        port = int(client.socket.getsockopt(zmq.LAST_ENDPOINT).decode().rpartition(":")[2])
        counts: list[int] = []

        def poll() -> None:
            with GrootClient(port) as one:
                count = 0
                for _ in range(10):
                    count += len(one.statuses()) == 2
                    time.sleep(0.05)
                counts.append(count)

        threads = [threading.Thread(target=poll) for _ in range(20)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert counts == [10] * 20


class OwnTime:
    """A clock that stands still while threads of this process wait for a processor, as they do on a busy machine.

    One that waits for another thread sees it go on. Other systems than Linux don't tell, there it always goes on.
    """

    def __init__(self) -> None:
        self._waited: dict[Path, int] = {}  # nanoseconds, also of threads that are over

    def __call__(self) -> float:
        for thread in Path("/proc/self/task").glob("*/schedstat"):
            with suppress(OSError):  # it has just ended
                self._waited[thread] = int(thread.read_text(encoding="ascii").split()[1])
        return time.perf_counter() - sum(self._waited.values()) / 1e9


@pytest.mark.long
def test_thousands_of_nodes_at_20_hz(monkeypatch: pytest.MonkeyPatch) -> None:
    """No tick is late because of a client that polls as Groot2 does; in each run few nodes, so that it is quick."""
    monkeypatch.setattr("btlang.run.pace.perf_counter", OwnTime())
    count = amount(600, 5_000)
    leaves = tuple(Node("Wave") for _ in range(count - 2))
    tree = Tree(Node("Repeat", (Node("Parallel", leaves),), (("num_cycles", "-1"),)))
    mission = btlang.parse_tree("wave").replace(tree=tree, syntax=None)
    port, controls = free_port(), Controls()
    server = GrootServer(port, controls)
    try:
        with Session() as session, GrootClient(port) as client:
            monitor = GrootMonitor(server)
            run = session.prepare(mission, controls=controls, hooks=monitor.hooks, time_limit=amount(1, 10))
            monitor.watch_run(run, mission)
            run.start()
            assert len(client.uids()) >= 1
            while run.wait(0.1) is None:
                assert len(client.statuses()) == count
        outcome = run.wait()
        assert outcome is not None
        assert outcome.overruns <= outcome.ticks // amount(5, 20)
    finally:
        server.close()


def test_a_tree_of_any_size_is_shown_as_far_as_the_protocol_goes() -> None:
    leaves = tuple(Node("Wave") for _ in range(MOST_NODES + 10))

    class Nodes:
        size = len(leaves) + 1

        def node(self, index: int) -> Node:
            return leaves[index - 1] if index else Node("Sequence", leaves)

    tree = GrootTree(Nodes(), lambda index: 0, lambda node: node.id, "")  # type: ignore[arg-type]
    assert tree.size == MOST_NODES
    assert tree.to_xml().count("_uid") == MOST_NODES


def test_a_taken_port_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        one.listen()
        assert main(["run", "-c", "wave", "--speed", "max", "--groot", str(one.getsockname()[1])]) == 2
    assert "BT086" in capsys.readouterr().err


def test_the_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    port = free_port()
    seen: list[dict[int, str]] = []

    def watch() -> None:
        with GrootClient(port) as client:
            for _ in range(100):
                frames = client.ask("S")
                if frames[0] != b"error":
                    seen.append(client.statuses())
                    return
                time.sleep(0.02)

    for words in (
        ["run", "-c", "wave", "--speed", "10", "--lines", "--record", "run.mcap", "--groot", str(port)],
        ["replay", "run.mcap", "--speed", "10", "--lines", "--groot", str(port)],
    ):
        thread = threading.Thread(target=watch)
        thread.start()
        assert main(words) == 0, capsys.readouterr().err
        thread.join()
    assert [len(each) for each in seen] == [1, 1]
    assert main(["replay", "run.mcap", "--to", "run.btlog"]) == 0
    data = (tmp_path / "run.btlog").read_bytes()
    assert data.startswith(b"BTCPP4-FileLogger2\x01")
    [size] = struct.unpack_from("<i", data, 19)
    assert [element.attrib["_uid"] for element in ElementTree.fromstring(data[23 : 23 + size]).iter("Wave")] == ["1"]
    changes = list(struct.iter_unpack("<IHHB", data[23 + size + 8 :]))
    assert [(uid, code) for _, _, uid, code in changes] == [(1, 1), (1, 2)]
