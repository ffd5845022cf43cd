"""The commands of the task layer as services of `btc ros-node`, and what of its tasks a crash leaves."""

from __future__ import annotations

import itertools
import json
import signal
import socket
import time
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from std_srvs.srv import Trigger

from btlang.task import messages
from btlang.task.commands.client import RobotClient as TaskClient
from btlang.task.commands.client import socket_path
from tests.ros.client import LATCHED, Client
from tests.ros.processes import LONG, Command, wait_until
from tests.ros.test_mission_node import FAR, mission

HANG = """
from time import sleep


def hang():
    sleep(10)
"""


def command(client: Client, **fields: Any) -> Any:
    """The answer to a command as JSON."""
    from btlang_interfaces.srv import Command as CommandService

    return client.call(CommandService, "/btlang/command", command=json.dumps(fields))


def about(client: Client, service: str, task: int, **fields: str) -> Any:
    """The answer to a command about a task."""
    from btlang_interfaces.srv import TaskCommand

    return client.call(TaskCommand, f"/btlang/{service}", task=task, **fields)


def submit(client: Client, text: str, **fields: Any) -> int:
    """The number of a new task."""
    answer = command(client, command="submit", text=text, **fields)
    assert answer.ok, answer.text
    return int(json.loads(answer.data)["task"]["id"])


def state(client: Client, task: int) -> str:
    return str(json.loads(about(client, "show", task).data)["task"]["state"])


def test_tasks_are_led_by_services(start_node, client: Client, run_mission: Any):
    start_node()
    task = submit(client, FAR, labels=["tour"])
    wait_until(lambda: state(client, task) == "underway", "the start")
    interrupted = about(client, "interrupt", task, reason="a visitor")
    assert interrupted.ok, interrupted.text
    token = json.loads(interrupted.data)["token"]
    stale = about(client, "resume", task, token="0")
    assert (stale.ok, stale.code) == (False, "BT187")
    assert client.call(Trigger, "/btlang/pause").success
    assert about(client, "resume", task, token=token).ok
    assert client.call(Trigger, "/btlang/status").message.startswith("The robot is paused.")
    assert about(client, "resume", 0).text == "That ends the pause."
    wait_until(lambda: state(client, task) == "underway", "the mission goes on")
    assert about(client, "cancel", task, reason="enough").ok
    shown = json.loads(about(client, "show", task).data)["task"]
    assert (shown["state"], shown["reason"], shown["labels"]) == ("canceled", "enough", ["tour"])
    assert {change["person"] for change in shown["changes"]} == {"ROS 2", ""}


@pytest.mark.parametrize(
    ("sent", "code"),
    [
        ("{", "BT198"),
        ("[]", "BT198"),
        ('{"command": "submti"}', "BT198"),
        ('{"command": "show", "task": 9}', "BT187"),
        ('{"command": "submit", "text": "wave", "labels": ["\\ud800"]}', "BT198"),
        ('{"command": "put", "name": "a\\u0000", "text": "wave"}', "BT198"),
    ],
)
def test_a_wrong_command(sent: str, code: str, run_mission: Any, tmp_path: Path):
    """The service's own function, with real requests and answers."""
    from btlang_interfaces.srv import Command as CommandService

    from btlang.ros.mission import server
    from btlang.task.layer import TaskLayer

    with TaskLayer(folder=str(tmp_path), speed=50.0) as layer:
        answer = server._any(layer.handle, CommandService.Request(command=sent), CommandService.Response())
    assert (answer.ok, answer.code) == (False, code)
    assert answer.text


def test_a_crash_keeps_tasks_and_ends_goals(client: Client, run_mission: Any, tmp_path: Path, domain: int):
    from btlang_interfaces.msg import Tasks

    node = Command(tmp_path, domain, "ros-node")
    node.wait_for("ready")
    goal = mission(client, run_mission, "wait 1 minute")
    goal.feedback.wait(lambda news: news.state == "underway")
    waiting = mission(client, run_mission, "say never")
    waiting.feedback.wait(lambda news: news.state == "queued")
    kept = submit(client, 'say "still here"')
    node.process.send_signal(signal.SIGKILL)
    node.process.wait(LONG)
    folder = tmp_path / "again"
    folder.mkdir()
    again = Command(folder, domain, "ros-node", XDG_DATA_HOME=str(tmp_path))
    again.wait_for('says   "still here"')
    tasks = client.hear(Tasks, "/btlang/tasks", LATCHED)
    tasks.wait(lambda message: not message.tasks)
    listed = command(client, command="list", states=["canceled", "error", "completed"])
    assert {task["id"]: (task["state"], task["reason"]) for task in json.loads(listed.data)["tasks"]} == {
        1: ("error", "the robot was cut off"),
        2: ("canceled", "its node ended before it did"),
        kept: ("completed", ""),
    }
    assert "say never" not in again.out
    assert again.end() == 130


def test_its_tasks_are_those_of_the_command_line(
    start_node, client: Client, run_mission: Any, monkeypatch: pytest.MonkeyPatch
):
    node: Command = start_node()
    monkeypatch.setenv("XDG_RUNTIME_DIR", node.sockets)
    with TaskClient("btlang") as terminal:
        answer = terminal.send(messages.Submit("say hello"))
        assert answer.ok, answer.text
        wait_until(lambda: state(client, 1) == "completed", "the end")
    with socket.socket(socket.AF_UNIX) as watching:  # as a server does
        watching.settimeout(10.0)
        watching.connect(socket_path("btlang"))
        watching.sendall(b'{"watch": {"after": 0}}\n')
        told = watching.makefile("rb")
        states = [message["state"] for message in map(json.loads, itertools.islice(told, 5)) if "state" in message]
        assert states[:2] == ["queued", "standby"]


def test_nothing_delays_the_emergency_stop(start_node, client: Client, run_mission: Any, tmp_path: Path):
    """Here its node waits for a command that doesn't end."""
    (tmp_path / "hang.py").write_text(HANG, encoding="utf-8")
    (tmp_path / "hang.toml").write_text('[[action]]\nphrase = "hang"\nid = "Hang"\ncall = "hang:hang"\n')
    start_node("--keywords", str(tmp_path / "hang.toml"))
    client.call(Trigger, "/btlang/status")
    task = submit(client, "hang")
    wait_until(lambda: state(client, task) == "underway", "the start")
    other = Thread(target=about, args=(client, "cancel", task))
    other.start()
    time.sleep(0.5)
    began = time.monotonic()
    assert client.call(Trigger, "/btlang/stop").success
    assert time.monotonic() - began < 2.5
    assert other.is_alive()
    other.join()
