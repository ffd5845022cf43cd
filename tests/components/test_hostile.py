"""Components that raise where nobody expects it, lie, flood, or go on after they were given up."""

from __future__ import annotations

import math
import pickle
import socket
import struct
import threading
import time
from collections import deque
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.components.calls import pack
from btlang.components.component import ACTIVE, ComponentError
from btlang.components.manager import ComponentManager
from btlang.components.process_host import ProcessHost
from btlang.components.remote_leaf import RemoteLeaf
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.bodies.body import ComponentPart
from btlang.robots.platforms import ALL
from btlang.robots.registry import connector
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world_file import load_world
from tests.components.robots import robot_file
from tests.components.test_faults import wait_until

WORD = """
[[action]]
phrase = "misbehave"
id = "Misbehave"
call = "hostile:{call}"
needs = ["base"]
help = "Does what it must not."
example = "misbehave"
"""


def hostile(folder: Path, name: str, **keys: object) -> str:
    """A robot with one of the hostile components."""
    lines = "\n".join(f"{key} = {value}" for key, value in keys.items())
    return robot_file(folder, f'[[component]]\nname = "villain"\nclass = "hostile:{name}"\n{lines}')


def misbehave(folder: Path, call: str, text: str = "misbehave") -> btlang.Mission:
    (folder / "hostile.toml").write_text(WORD.format(call=call), encoding="utf-8")
    return btlang.parse_tree(text, keywords=[str(folder / "hostile.toml")])


def statuses(session: btlang.Session) -> Any:
    return session.connection.manager.statuses()  # type: ignore[attr-defined]


@pytest.mark.parametrize("runs", ["process", "here"])
def test_a_constructor_that_raises_is_a_failure_like_others(tmp_path: Path, runs: str) -> None:
    robot = hostile(tmp_path, "BrokenConstructor", runs=f'"{runs}"', restarts=1)
    with btlang.Session(robot) as session:
        wait_until(lambda: "given up" in (statuses(session) or [None])[0].why, 10)
        assert "no water" in statuses(session)[0].why
        assert statuses(session)[0].starts == 2


class _LyingHost:
    """Says of itself what nobody can use."""

    state, process = "unconfigured", None

    def load(self) -> Any:
        return 5

    def close(self) -> None:
        pass


def test_a_host_that_says_nonsense_of_itself_is_given_up() -> None:
    manager = ComponentManager(
        [ComponentPart("villain", "hostile:Liar", restarts=0)], lambda part, changed: _LyingHost()
    )  # type: ignore[arg-type,return-value]
    manager.start()
    assert not manager.wait(5.0)
    assert [each.why for each in manager.statuses()] == [
        "TypeError: 'int' object is not subscriptable; it was given up after the first attempt"
    ]
    manager.close()


@pytest.mark.parametrize("over", ["simulated", "devices"])
def test_what_is_not_a_number_moves_nothing(over: str) -> None:
    with btlang.Session(connector("standard", over, **({"simulate": [ALL]} if over == "devices" else {}))) as session:
        robot = session.robot
        for velocity in ((math.nan, 0.0), (0.0, math.nan)):
            with pytest.raises(RobotError, match="can't drive at a speed that is not a number"):
                robot.drive(*velocity)
        name = robot.body.joints[0].name
        with pytest.raises(RobotError, match=f'the joint "{name}" can\'t move to what is not a number'):
            robot.move_joints({name: math.nan})
        before = robot.joint(name)
        for _ in range(40):
            robot.step(0.05)
        assert robot.velocity == (0.0, 0.0)
        assert robot.joint(name) == before


@pytest.mark.parametrize(("name", "reason"), [("FailingStep", "the pump is broken"), ("ExitingStep", "SystemExit: 3")])
def test_one_in_this_process_whose_step_fails_ends_its_actions_and_what_they_drive(
    tmp_path: Path, name: str, reason: str
) -> None:
    robot = hostile(tmp_path, name, runs='"here"', restarts=0)
    with btlang.Session(robot) as session:
        outcome = session.run(misbehave(tmp_path, f"{name}.roll"), speed="max", time_limit=20).outcome
        assert outcome is not None
        assert reason in outcome.why()
        session.robot.step(2.0)
        assert session.robot.velocity == (0.0, 0.0)


@pytest.mark.parametrize("runs", ["process", "here"])
def test_a_method_that_raises_drives_no_longer(tmp_path: Path, runs: str) -> None:
    robot = hostile(tmp_path, "Liar", runs=f'"{runs}"')
    mission = misbehave(tmp_path, "Liar.roll_and_raise", "try misbehave otherwise wait 2 seconds")
    with btlang.Session(robot) as session:
        outcome = session.run(mission, speed="max").outcome
        assert outcome is not None
        assert outcome.succeeded
        assert session.robot.travelled < 0.2


def test_a_hook_that_was_given_up_moves_nothing_any_more(tmp_path: Path) -> None:
    wheels = '[[device]]\nname = "wheels"\nkind = "drive"\ndriver = "simulated"'
    robot = hostile(tmp_path, "EndlessHook", runs='"here"', limit=0.3, restarts=0, needs='["wheels"]')
    with open(robot, "a", encoding="utf-8") as file:
        file.write(f"\n{wheels}\n")
    with btlang.Session(robot) as session:
        wait_until(lambda: "given up" in statuses(session)[0].why, 10)
        session.robot.step(1.0)
        for _ in range(20):
            session.robot.step(0.05)
            time.sleep(0.01)
        assert session.robot.velocity == (0.0, 0.0)


class _Flood(deque[tuple[str, Any]]):
    """Gets another one for each that is taken."""

    def popleft(self) -> tuple[str, Any]:
        found = super().popleft()
        if found[0] == "villain":
            self.append(found)
        return found


def test_a_flood_of_events_neither_holds_a_tick_nor_hides_what_the_robot_says(tmp_path: Path) -> None:
    with btlang.Session(hostile(tmp_path, "Liar", runs='"here"')) as session:
        own: Any = session.connection
        for _ in range(5_000):
            own._post_from_component("villain", {})
        own._post("part", {"kind": "component", "name": "villain", "state": "active", "text": "it matters"})
        for _ in range(5_000):
            own._post_from_component("villain", {})
        own._said = _Flood(own._said, own._said.maxlen)
        heard: list[Any] = []
        session.connection.bus.add(heard.append)
        session.robot.step(0.05)
        assert "it matters" in [getattr(event, "text", "") for event in heard]
        assert len(heard) <= 1_500


class _Process(ProcessHost):
    """A process that says what a test says, over a socket that nobody reads."""

    def __init__(self, devices: Any = ()) -> None:
        part = ComponentPart("villain", "hostile:Liar")
        super().__init__(part, "", dict(devices), lambda: None, lambda kind, data: None)
        ours, self.its = socket.socketpair()
        self._connection = Connection(ours.detach())
        self.state = ACTIVE

    def listen(self) -> threading.Thread:
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        return self._reader

    def close(self) -> None:
        super().close()
        self.its.close()

    def says(self, *messages: Any) -> None:
        """All of these, and ends."""
        with Connection(self.its.detach()) as end:
            for message in messages:
                end.send_bytes(pack(message))
        self.listen().join(5.0)


def test_a_value_that_cannot_be_handed_over_fails_its_action_only() -> None:
    endless: list[Any] = []
    endless.append(endless)
    host = _Process()
    for value in (object(), endless):
        with pytest.raises(ActionFailed, match=r"can't be handed to another process"):
            host.begin("brew", {"drink": value}, lambda: None)
    assert not host._requests
    host.close()


NONSENSE = {"state": ACTIVE, "known": [], "problem": ""}


@pytest.mark.parametrize(
    "message",
    [
        5, None, {"ended": [], **NONSENSE}, {"ended": {"x": {}}, **NONSENSE}, {"ended": {}, **NONSENSE, "known": [[]]},
        {"ask": [], "call": 1}, {"ask": 1, "call": 0, "device": "none"}, {"tell": "x", "data": 5}, {"write": []},
    ],
)  # fmt: skip
def test_nonsense_ends_the_process_that_says_it(message: Any) -> None:
    host = _Process()
    request = host.begin("brew", {}, lambda: None)
    host.says(message)
    assert "says what can't be understood" in str(host.look())
    assert request.done.is_set()
    host.close()


def test_outcomes_that_are_none_are_failures() -> None:
    host = _Process()
    request = host.begin("brew", {}, lambda: None)
    host.says({"ended": {"1": 5, "7": {}}, **NONSENSE})
    with pytest.raises(ActionFailed):
        _ = request.value
    host.close()


def test_a_message_without_end_does_not_fill_the_memory() -> None:
    host = _Process()
    host.listen()
    host.its.sendall(struct.pack("!i", 2**31 - 1))
    wait_until(lambda: host.look() is not None, 5)
    assert "says what can't be understood: a message of" in str(host.look())
    host.close()


def test_questions_of_hours_leave_nothing_behind() -> None:
    """Each is answered once, however often it is asked; only the latest is kept."""
    host = _Process()
    leaf = RemoteLeaf(host, "roll", (), SimulatedRobot(load_world()), lambda: None, set())
    leaf.start()
    request = host._requests[1]
    for number in range(1, 50):
        for _ in range(2):
            host._asked({"ask": number, "call": 1, "robot": "time"})
        assert len(request.asked) == 1
        leaf.tick()
        assert not request.asked
    host._asked({"ask": 48, "call": 1, "robot": "time"})  # of a time that is over
    assert not request.asked
    assert len(pickle.dumps((request.latest, request.answer))) < 1000
    host.close()


def test_the_robot_stands_before_its_process_is_told_of_a_halt() -> None:
    """A process that doesn't read holds up who writes to it."""
    order: list[str] = []
    robot = SimulatedRobot(load_world())
    host = _Process()
    host.halt = lambda request: order.append("told, " + str(robot._base.commanded))  # type: ignore[method-assign,attr-defined]
    leaf = RemoteLeaf(host, "roll", (), robot, lambda: None, set())
    leaf.start()
    host._asked({"ask": 1, "call": 1, "robot": "drive", "args": [0.3, 0.0]})
    leaf.tick()
    leaf.halt()
    assert order == ["told, (0.0, 0.0)"]
    host.close()


def test_a_value_nobody_expects_leaves_no_robot_driving() -> None:
    robot = SimulatedRobot(load_world())
    host = _Process()
    leaf = RemoteLeaf(host, "roll", (), robot, lambda: None, set())
    leaf.start()
    host._asked({"ask": 1, "call": 1, "robot": "drive", "args": [0.3, 0.0]})
    leaf.tick()
    host._requests[1].end({"value": 1, "stored": {"nowhere": 1}})
    with pytest.raises(KeyError):
        leaf.tick()
    assert robot._base.commanded == (0.0, 0.0)  # type: ignore[attr-defined]
    host.close()


def test_a_part_that_is_not_installed_is_refused_before_it_is_loaded(tmp_path: Path) -> None:
    """Words are looked for among all components: one that can't be found would fail every later mission."""
    with btlang.Session(hostile(tmp_path, "Liar", runs='"here"')) as session:
        manager = session.connection.manager  # type: ignore[attr-defined]
        with pytest.raises(ComponentError, match='no package has a component "nowhere"'):
            manager.load(ComponentPart("other", "nowhere"))
        assert [each.name for each in manager.statuses()] == ["villain"]
        outcome = session.run(misbehave(tmp_path, "Liar.roll_and_raise"), speed="max").outcome
        assert outcome is not None
        assert "no water" in outcome.why()


def test_a_restart_keeps_the_newer_version_that_waits() -> None:
    manager = ComponentManager([ComponentPart("villain", "hostile:Liar")], lambda part, changed: _LyingHost())  # type: ignore[arg-type,return-value]
    newer = ComponentPart("villain", "hostile:Better")
    keeper = manager.keeper("villain")
    keeper.start = lambda: None  # type: ignore[method-assign]
    manager.load(newer)
    manager.restart("villain")
    assert keeper.next == newer
