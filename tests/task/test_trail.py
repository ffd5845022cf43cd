"""The audit trail as an operator reads it."""

from __future__ import annotations

import json

from btlang.task.layer import TaskLayer
from tests.task.layers import Btc, ask, refusal, submit


def lines(btc: Btc) -> list[str]:
    """The trail, the oldest first, without the times."""
    code, text = btc("task", "trail")
    assert code == 0, text
    return [line.split("  ", 1)[1] for line in reversed(text.splitlines())]


def test_an_entry_has_who_what_and_what_came_of_it(robot: TaskLayer, btc: Btc) -> None:
    submit(robot, "go to the lab\nthen wave", priority=5, labels=["tour"])
    ask(robot, "cancel", task=1, reason="lunch")
    refusal(robot, "cancel", task=9)
    assert lines(btc)[1:] == [
        'ann: submit "go to the lab / then wave", priority 5, labels tour  [Task 1 is queued.]',
        'ann: cancel task 1, reason "lunch"  [Task 1 is canceled.]',
        "ann: cancel task 9  [refused (BT187): Task 9 isn't known.]",
    ]
    data = json.loads(btc("task", "trail", "--json")[1])["data"]
    assert [json.loads(each["details"])["command"] for each in data["acts"]] == ["cancel", "cancel", "submit", "pause"]


def test_words_that_name_no_mission_are_one_entry(robot: TaskLayer, btc: Btc) -> None:
    assert btc("task", "add", "wave")[0] == 0
    (entry,) = lines(btc)[1:]
    assert entry.endswith(': submit "wave"  [Task 1 is queued.]')


def test_the_token_of_an_interruption_is_not_shown(robot: TaskLayer, btc: Btc) -> None:
    submit(robot, "wait 100 s")
    ask(robot, "resume")
    while robot.handle({"command": "interrupt", "task": 1}, "ann").ok is False:
        pass
    token = robot.store.task(1).token  # type: ignore[union-attr]
    assert token
    ask(robot, "resume", task=1, token=token)
    said = lines(btc)
    assert any("interrupt task 1  [Task 1 is interrupted." in line for line in said)
    assert any("resume task 1  [" in line for line in said)
    assert not any(token in line for line in said)


def test_a_mission_that_names_its_robot_is_done_by_the_one_that_is_up(robot: TaskLayer) -> None:
    assert submit(robot, 'robot "../other.toml"\n\ngo to the lab') == 1
    assert "BT049" in refusal(robot, "submit", text='words "../other.toml"\n\ngo to the lab')
