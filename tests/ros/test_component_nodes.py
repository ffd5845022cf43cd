"""Components that are ROS 2 lifecycle nodes: their life, and what is done where they go wrong."""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.components.manager import ComponentKeeper
from btlang.robots.registry import connector
from btlang.ros.components.services import AwaitedReply
from btlang.run.events import Event
from tests.components.robots import robot_file
from tests.ros.processes import LONG, REPOSITORY, start, wait_until

STARTED = [sys.executable, "-m", "tests.ros.peers.lifecycle", "arm_driver"]
WORDS = """
[[action]]
phrase = "clench"
id = "GripNode"
ros = { service = "std_srvs/srv/Trigger", name = "/arm_driver/grip" }
help = "Closes the gripper."
example = "clench"
"""


@pytest.fixture(autouse=True)
def _domain(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("PYTHONPATH", str(REPOSITORY))
    monkeypatch.setattr("btlang.ros.components.host._DISCOVERY", 1.0)


def table(command: list[str] | None = None, **keys: object) -> str:
    lines = {"name": '"arm driver"', "node": '"/arm_driver"', **keys}
    if command:
        lines["command"] = str(command)
    return "\n".join(["[[component]]", *(f"{key} = {value}" for key, value in lines.items())])


@contextmanager
def up(folder: Path, component: str, over: str = "simulated") -> Iterator[tuple[Any, ComponentKeeper]]:
    with btlang.Session(robot_file(folder, component), over=over) as session:
        yield session, session.connection.manager.keeper("arm driver")  # type: ignore[attr-defined]


def mission(folder: Path, text: str) -> btlang.Mission:
    (folder / "arm.toml").write_text(WORDS, encoding="utf-8")
    return btlang.parse_tree(text, keywords=[str(folder / "arm.toml")])


def becomes(keeper: ComponentKeeper, state: str) -> None:
    wait_until(lambda: keeper.state == state, f"{state}, not {keeper.state} ({keeper.why})", 2 * LONG)


def test_a_killed_node_fails_its_command_and_is_back_for_the_next(tmp_path: Path) -> None:
    told: list[Event] = []
    with up(tmp_path, table(STARTED, parameters="{ force = 0.5 }")) as (session, keeper):
        assert (keeper.state, keeper.why) == ("active", "")
        process = keeper.status().process
        assert process is not None
        run = session.start(
            mission(
                tmp_path, "try repeat clench otherwise print lost\nwait 5 seconds\ntry clench up to 5 times every 2 s"
            ),
            sinks=[told.append],
        )
        wait_until(lambda: len(told) > 3, "it has begun")
        os.kill(process, signal.SIGKILL)
        wait_until(lambda: any(event.tag == "print" for event in told), "the command fails")
        becomes(keeper, "active")
        outcome = run.wait(60)
        assert outcome.succeeded, outcome.why()
        last = keeper.status().process
        assert last not in (process, None)
    assert any("was killed by signal 9" in str(getattr(event, "text", "")) for event in told)
    assert not any(os.path.exists(f"/proc/{each}") for each in (process, last))


def test_a_node_is_loaded_anew(tmp_path: Path) -> None:
    with up(tmp_path, table(STARTED)) as (session, keeper):
        becomes(keeper, "active")
        session.connection.manager.load(keeper.part)
        wait_until(lambda: keeper.status().starts == 2, "its second start")
        becomes(keeper, "active")


def test_an_exception_and_an_endless_configure(tmp_path: Path) -> None:
    (tmp_path / "plan").write_text("raise", encoding="utf-8")
    with up(tmp_path, table([*STARTED, str(tmp_path)], limit=2.0)) as (_, keeper):
        becomes(keeper, "active")
        first = keeper.status().starts
        assert first >= 2
        process = keeper.status().process
        (tmp_path / "plan").write_text("hang", encoding="utf-8")
        assert process is not None
        os.kill(process, signal.SIGKILL)
        wait_until(lambda: "did not configure within 2 s" in keeper.why, "the limit", 2 * LONG)
        becomes(keeper, "active")


def test_a_node_that_somebody_else_starts_late_and_kills(tmp_path: Path) -> None:
    with up(tmp_path, table(parameters="{ force = 0.1 }", needs='["base"]')) as (session, keeper):
        assert keeper.why == "waits for the node /arm_driver"
        outcome = session.run(mission(tmp_path, "clench"), speed="max").outcome
        assert "the arm driver waits for the node /arm_driver" in outcome.why()
        first = start(*STARTED, stderr=subprocess.DEVNULL)
        becomes(keeper, "active")
        wait_until(lambda: session.run(mission(tmp_path, "clench")).outcome.succeeded, "its word", 4 * LONG)
        first.kill()
        first.wait()
        wait_until(lambda: keeper.state != "active", "its death")
        second = start(*STARTED, stderr=subprocess.DEVNULL)
        becomes(keeper, "active")
        assert keeper.status().starts == 2
    assert second.poll() is None


def test_a_node_that_answers_late_and_was_left_up(tmp_path: Path) -> None:
    heard = (tmp_path / "heard").open("w+", encoding="utf-8")
    node = start(*STARTED, stderr=heard)
    for _ in range(2):  # the second robot finds it as the first one has left it
        with up(tmp_path, table(parameters='{ wrong = "slow" }')) as (_, keeper):
            becomes(keeper, "active")
            assert keeper.status().starts == 1
    assert node.poll() is None
    with heard:
        heard.seek(0)
        assert heard.read().count("configure") == 2


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({"parameters": '{ speed = "high" }'}, 'its parameter "speed" can\'t be set'),
        ({"command": '["no-such-program"]'}, "no-such-program can't be started: No such file or directory"),
        ({"command": '["false"]'}, "ended with exit code 1"),
    ],
)
def test_what_it_cannot_begin_with(tmp_path: Path, keys: dict[str, str], reason: str) -> None:
    if "command" not in keys:
        start(*STARTED, stderr=subprocess.DEVNULL)
    with up(tmp_path, table(restarts=0, **keys)) as (_, keeper):
        wait_until(lambda: reason in keeper.why, "the reason")


def test_a_container(tmp_path: Path, composition: None) -> None:
    command = [sys.executable, "-m", "tests.ros.peers.container", "box"]
    box = start(*command, stdout=subprocess.PIPE, text=True)
    assert box.stdout is not None
    with box.stdout as said:
        assert said.readline() == "ready\n"
        keys = {"container": '"/box"', "package": '"arm"', "plugin": '"arm::Driver"', "parameters": "{ force = 0.2 }"}
        with up(tmp_path, table(**keys)) as (session, keeper):
            becomes(keeper, "active")
            wait_until(lambda: session.run(mission(tmp_path, "clench")).outcome.succeeded, "its word", 4 * LONG)
        with up(tmp_path, table(**{**keys, "plugin": '"arm::Hand"'}, restarts=0)) as (_, keeper):
            wait_until(lambda: "can't be loaded into /box: could not find arm::Hand" in keeper.why, "the reason")
        box.kill()
        assert said.read() == "loaded /arm_driver {'force': 0.2}\nunloaded /arm_driver\n"


def test_answers_that_are_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every third of them: it is asked again, and nothing has failed."""
    came, count = AwaitedReply.came, itertools.count()
    monkeypatch.setattr(AwaitedReply, "came", lambda self, future: came(self, future) if next(count) % 3 else None)
    with up(tmp_path, table(STARTED, parameters="{ force = 0.1 }", limit=5.0)) as (_, keeper):
        becomes(keeper, "active")
        time.sleep(2.0)  # of its heartbeat
        assert (keeper.state, keeper.status().starts) == ("active", 1)
    assert next(count) > 8


@pytest.mark.parametrize("over", ["devices", "ros"])
def test_it_belongs_to_any_robot(tmp_path: Path, over: str, start_sim: Any) -> None:
    options: dict[str, Any] = {"simulate": ["all"]} if over == "devices" else {"sim_time": True}
    if over == "ros":
        start_sim("--speed", "5")  # at 10 a turn that btlang watches is lost where a busy machine pauses
    robot = connector(robot_file(tmp_path, table(STARTED, parameters="{ force = 0.1 }")), over, **options)
    text = "clench then turn left 20 degrees"
    with btlang.Session(robot) as session:
        outcome = session.run(mission(tmp_path, text), time_limit=60.0).outcome
        assert outcome is not None
        assert outcome.succeeded, outcome.failure
