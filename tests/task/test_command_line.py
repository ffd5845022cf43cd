"""What `btc task` and `btc robot` say to a robot that is up, in one process with it."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.task.layer import TaskLayer
from btlang.task.paths import USUAL_NAME
from btlang.task.socket_server import SocketServer

from .layers import ask, layer_in, refusal, submit, task, wait_until

Btc = Callable[..., tuple[int, str]]


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Iterator[TaskLayer]:
    """One that is up, and paused."""
    with tempfile.TemporaryDirectory() as short:  # the path of a socket has to be
        for variable in ("XDG_RUNTIME_DIR", "XDG_DATA_HOME"):
            monkeypatch.setenv(variable, short)
        with (
            layer_in(Path(short, "data")) as layer,
            closing(SocketServer(USUAL_NAME, layer.handle, layer.stop)) as door,
        ):
            door.start()
            ask(layer, "pause")
            yield layer


@pytest.fixture
def btc(capsys: pytest.CaptureFixture[str]) -> Btc:
    """Runs a command: its exit code, and what it prints anywhere."""

    def run(*words: str) -> tuple[int, str]:
        try:
            code = main(words)
        except SystemExit as ended:
            code = int(ended.code or 0)
        printed = capsys.readouterr()
        return code, printed.out + printed.err

    return run


def data(btc: Btc, *words: str) -> dict[str, Any]:
    """What an answer has for programs."""
    code, text = btc(*words, "--json")
    assert code == 0, text
    return dict(json.loads(text)["data"])


def test_a_long_list_says_what_it_leaves_out(robot: TaskLayer, btc: Btc) -> None:
    for _ in range(103):
        submit(robot, "wave")
    ask(robot, "cancel", task=1)
    lines = btc("task", "list")[1].splitlines()
    assert (len(lines), lines[-1]) == (101, "and 2 more: --limit N lists so many, --all every one")
    assert data(btc, "task", "list")["more"] == 2
    assert len(btc("task", "list", "--limit", "102")[1].splitlines()) == 102
    assert btc("task", "list", "--limit", "3")[1].splitlines()[3:] == [lines[-1].replace("2", "99")]
    assert len(btc("task", "list", "--all")[1].splitlines()) == 103
    assert data(btc, "task", "list", "--all")["more"] == 0


def test_a_list_says_which_task_comes_first_also_where_it_is_not_in_it(robot: TaskLayer, btc: Btc) -> None:
    submit(robot, "wave", at="in 20 h", priority=5)
    submit(robot, "wait 10 h", priority=1)
    submit(robot, "nod", labels=["tour"])
    ask(robot, "resume")
    assert btc("task", "list", "--label", "tour")[1] == "   3  queued     nod  [task 2 comes first]\n"


def test_a_deleted_mission_says_which_schedules_have_its_text(robot: TaskLayer, btc: Btc) -> None:
    for name in ("tour", "other"):
        btc("task", "put", name, "-c", "wave")
    ask(robot, "schedule", rule="every day at 9:00", name="tour")
    ask(robot, "schedule", rule="every day at 9:00", name="tour", text="nod")  # the name of a file
    gone = "is no longer in the library."
    one = f"'tour' {gone} Schedule 1 goes on with its text. To end it: btc task unschedule\n"
    assert btc("task", "delete", "tour") == (0, one)
    assert btc("task", "delete", "other") == (0, f"'other' {gone}\n")
    btc("task", "put", "tour", "-c", "wave")
    ask(robot, "schedule", rule="every day at 9:00", name="tour")
    assert data(btc, "task", "delete", "tour") == {"schedules": [1, 3]}


def test_a_report_begins_in_the_past(robot: TaskLayer, btc: Btc) -> None:
    ask(robot, "resume")
    number = submit(robot, "wave", at="in 20 h")
    wait_until(lambda: robot.now() > task(robot, number).created)
    for since in ("0:00", "yesterday at 9:00", "2 hours ago"):
        code, text = btc("robot", "report", "--since", since)
        assert code == 0
        assert "0 of 1 done, 1 not over yet" in text
    code, text = btc("robot", "report", "--since", "tomorrow at 9:00")
    assert code == 1
    assert "yesterday at 9:00" in text
    assert "would begin at" in refusal(robot, "report", since=4e9)
    assert "would begin at" in refusal(robot, "report", since="1 hour ago", until="2 hours ago")
