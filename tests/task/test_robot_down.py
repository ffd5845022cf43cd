"""What is known of tasks that are over, and of a robot that is down; what it says when it comes up again."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from btlang.cli.robot import left_over
from btlang.task.commands.client import data_folder
from btlang.task.layer import TaskLayer
from btlang.task.store.location import latest_store, note_store, usual_store
from btlang.task.store.records import MissionText, Task, TaskState
from btlang.task.store.task_store import open_store

from .layers import Btc, ask, robot_up, submit, wait_for, wait_until


def test_why_answers_for_a_task(robot: TaskLayer, btc: Btc, tmp_path: Path) -> None:
    ask(robot, "resume")
    done = submit(robot, "say hi")
    wait_for(robot, done, TaskState.COMPLETED)
    shown = btc("task", "show", str(done))[1]
    assert btc("why", str(done)) == btc("task", "why", str(done)) == (0, shown)
    recording = str(tmp_path / "run.mcap")
    assert btc("run", "-c", "say hi", "--speed", "max", "--quiet", "--record", recording)[0] == 0
    robot.store.amend(done, recording=recording)
    code, text = btc("why", str(done))
    assert code == 0
    assert text == btc("task", "show", str(done))[1] + "\n" + btc("why", recording)[1]
    assert "Task 99 isn't known" in btc("why", "99")[1]
    assert "isn't the number of a task" in btc("why", "9" * 5000)[1]
    assert "isn't the number of a task" in btc("task", "why", "now")[1]


@pytest.mark.parametrize("name", ["robot", "rover"])
def test_a_robot_that_is_down_still_says_what_it_did(name: str, btc: Btc, short: Path) -> None:
    with robot_up(Path(data_folder(name)), name) as layer:
        wait_for(layer, submit(layer, "say hi"), TaskState.COMPLETED)
        ask(layer, "pause")
        submit(layer, "wave", labels=["tour"])
        ask(layer, "put", name="q", text="wave")
        ask(layer, "schedule", rule="every day at 9:00", text="wave")
    start = f"btc robot up{f' --name {name}' * (name != 'robot')}"
    down = f"The robot '{name}' is down; this is from its store. To bring it up: {start}\n"
    for words, said in (
        ("task list", "   2  queued     wave  [the robot is down]\n"),
        ("task list --all", "   1  completed  say hi\n"),
        ("task show 1", "completed"),
        ("task why 1", "completed"),
        ("why 1", "completed"),
        ("robot report", "1 of 2 done, 1 not over yet"),
        ("robot report", "task 1, say hi: completed\n"),
        ("task trail", "submit"),
        ("task library", "q, revision 1"),
        ("task schedules", "every day at 09:00: wave"),
    ):
        code, text = btc(*words.split())
        assert code == 0, text
        assert down in text
        assert said in text
    code, text = btc("task", "show", "9")
    assert (code, "Task 9 isn't known" in text) == (1, True)
    for words in ("task add -c wave", "task cancel 2", "robot status", "task list --live", "robot resume"):
        code, text = btc(*words.split())
        who = "No robot" if name == "robot" else f"No robot '{name}'"
        assert (code, f"{who} is up" in text) == (2, True), text


def test_of_several_that_are_down_the_one_used_last_answers(btc: Btc, short: Path) -> None:
    for name in ("robot", "museum"):
        with robot_up(Path(data_folder(name)), name) as layer:
            wait_for(layer, submit(layer, "wave" if name == "museum" else "nod"), TaskState.COMPLETED)
    os.utime(usual_store(data_folder("robot")), (0, 0))
    code, text = btc("task", "list")
    assert code == 0
    assert "The robot 'museum' is down" in text
    assert "For robot: --name NAME\n" in text
    assert "To see the one that is over: btc task list --all\n" in text
    assert "nod" in btc("task", "list", "--all", "--name", "robot")[1]
    assert btc("robot", "list") == (0, "museum  down\nrobot   down\n")


def test_a_status_has_the_house_rules_and_the_next_schedule(btc: Btc, short: Path) -> None:
    rules = short / "rules.txt"
    rules.write_text("whenever the battery is below 20%,\n    charge\n", encoding="utf-8")
    with robot_up(Path(data_folder("robot")), rules=str(rules)) as layer:
        ask(layer, "schedule", rule="every day at 9:00", text="wave")
        wait_until(lambda: ask(layer, "status")["battery"] is not None)  # the rules have begun
        code, text = btc("robot", "status")
        assert btc("robot", "list") == (0, "robot  up\n")
    assert code == 0
    assert "The next schedule is due at " in text
    assert "The battery is at 100%.\nHouse rule: whenever the battery is below 20%, charge\n" in text


def test_the_recording_of_a_task_is_replayed_by_its_number(btc: Btc, short: Path) -> None:
    folder = Path(data_folder("robot"))
    with robot_up(folder, recordings=str(folder / "recordings")) as layer:
        wait_for(layer, submit(layer, "say hi"), TaskState.COMPLETED)
        ask(layer, "pause")
        submit(layer, "wave")
        assert "start  say" in btc("replay", "1", "--lines", "--speed", "max")[1]
        code, text = btc("replay", "2")
        assert (code, "BT088: There's no recording of task 2, which is queued." in text) == (2, True), text
        assert "Task 9 isn't known" in btc("watch", "9")[1]
    for words in (["replay", "1"], ["replay", "1", "--name", "robot"], ["replay"]):  # of the store, and the latest run
        code, text = btc(*words, "--lines", "--speed", "max")
        assert (code, "start  say" in text) == (0, True), text


@pytest.mark.parametrize("is_file", [True, False])
def test_a_store_elsewhere_is_found_when_the_robot_is_down(
    is_file: bool, btc: Btc, short: Path, tmp_path: Path
) -> None:
    store = str(tmp_path / "elsewhere.db")
    with robot_up(Path(data_folder("robot")), store=store) as layer:
        wait_for(layer, submit(layer, "say hi"), TaskState.COMPLETED)
    if not is_file:
        Path(store).unlink()
    code, text = btc("task", "list", "--all")
    assert (code, "completed  say hi" in text) == ((0, True) if is_file else (2, False)), text
    if is_file:
        assert btc("robot", "backup", str(tmp_path / "copy.db"))[0] == 0
        with open_store(str(tmp_path / "copy.db")) as copy:
            assert copy.task(1) is not None


def test_the_place_of_a_store_is_kept_without_its_password(short: Path) -> None:
    for place, kept in (
        ("postgresql://u:se@cret@h/db?sslmode=require", "postgresql://u@h/db?sslmode=require"),
        ("postgresql:///db?host=/tmp/x&password=a&user=u", "postgresql:///db?host=/tmp/x&user=u"),
        ("postgresql://h/db?password=a", "postgresql://h/db"),
        ("postgresql://u@h:5432/db", "postgresql://u@h:5432/db"),
        ("/a:b@c?password=d", "/a:b@c?password=d"),
    ):
        note_store(str(short), place)
        assert latest_store(str(short)) == kept


def test_a_robot_that_never_was_up_has_no_store(btc: Btc, short: Path) -> None:
    for words in (["task", "list"], ["why", "1"], ["task", "list", "--name", "rover"]):
        code, text = btc(*words)
        assert (code, "BT185" in text) == (2, True)
    assert not any(short.rglob("*.db"))


def test_what_is_left_from_before_is_said_when_the_robot_comes_up(short: Path) -> None:
    with open_store(str(short / "tasks.db")) as store:
        assert left_over(store, "standard") == []
        store.add(Task(0, MissionText("wave"), "ann", 0.0))
        assert left_over(store, "standard") == ["1 task is left from before. To see it: btc task list"]
        store.add(Task(0, MissionText("nod"), "ann", 0.0))
        assert left_over(store, "rover") == [
            "2 tasks are left from before. They were for another body, 'standard'; this one is 'rover'. "
            "To see them: btc task list"
        ]
        left_over(store, "rover", "btc robot up --world hotel.toml")
        assert left_over(store, "rover", "btc robot up")[1:] == [
            "Before, the robot was brought up with: btc robot up --world hotel.toml"
        ]


def test_a_robot_that_is_down_comes_up_as_it_was(btc: Btc, short: Path) -> None:
    with robot_up(Path(data_folder("hotel")), "hotel") as layer:
        left_over(layer.store, "standard", "btc robot up --name hotel --world hotel.toml")
    assert "To bring it up: btc robot up --name hotel --world hotel.toml\n" in btc("task", "list")[1]
    assert "Start it with: btc robot up --name hotel\n" in btc("robot", "status")[1]
