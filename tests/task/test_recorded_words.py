"""The words of a task that was done under house rules, with words of a component, in its recording and live."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.components.words import robot_words
from btlang.server.page.processes import comparison, film
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import TaskLayer
from btlang.task.store.records import TaskState
from tests.components.robots import machine, robot_file
from tests.task.layers import ask, layer_in, submit, wait_for

RULES = """\
# What holds all day.
whenever the battery is below 5%:
    dock
whenever somebody says "stop", wait 1 second
"""
TEXT = 'say "hello {name}"\nbrew tea\ncheck that the battery is low\n'


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], list[str]]:
    """What was told live of the run of a task that failed, and its recordings."""
    folder = tmp_path_factory.mktemp("robot")
    robot = robot_file(folder, machine())
    (folder / "rules.txt").write_text(RULES, encoding="utf-8")
    reader = MissionReader(robot_words(robot))
    options: dict[str, Any] = {"rules": str(folder / "rules.txt"), "recordings": str(folder / "recordings")}
    with TaskLayer(robot, reader, folder=str(folder / "data"), speed="max", **options) as layer:
        watched = layer.feed.watch()
        assert next(watched)["type"] == "hello"
        for _ in range(2):
            wait_for(layer, submit(layer, TEXT, values={"name": "Ann"}), TaskState.FAILED)
        told = next(message for message in watched if message["type"] == "run" and message["task"])
        watched.close()
    return told, sorted(map(str, (folder / "recordings").iterdir()))


def test_a_recording_has_the_words_of_mission_component_and_rules(done: tuple[dict[str, Any], list[str]]) -> None:
    data = json.loads(film(done[1][0]))
    assert data["text"] == TEXT
    assert [words for _, _, words in data["rules"]] == [
        "whenever the battery is below 5%", 'whenever somebody says "stop", wait 1 second',
    ]  # fmt: skip
    said = [data["text"][node["start"] : node["end"]] for node in data["nodes"][data["root"] :]]
    assert said[0] == TEXT.strip()
    assert said[-2:] == ["brew tea", "battery is low"]
    assert all(node["start"] is None for node in data["nodes"][: data["root"]])
    assert data["nodes"][data["failed"]]["label"] == "battery is low"
    assert "Brew" not in str(data["story"]) + str(data["ending"])
    assert "{" not in str(data["ending"]["context"])


def test_a_tree_in_xml_keeps_the_rules_and_its_name(tmp_path: Path) -> None:
    (tmp_path / "rules.txt").write_text(RULES, encoding="utf-8")
    options: dict[str, Any] = {"rules": str(tmp_path / "rules.txt"), "recordings": str(tmp_path / "recordings")}
    xml = (
        '<root BTCPP_format="4"><BehaviorTree ID="Tea"><ForceFailure><BatteryLow/></ForceFailure></BehaviorTree></root>'
    )
    with layer_in(tmp_path, **options) as layer:
        number = submit(layer, xml)
        wait_for(layer, number, TaskState.FAILED)
        listed = ask(layer, "list", states=["failed"])["tasks"][0]
    assert (listed["mission"], listed["reason"]) == ("Tea", "battery is low: it is not true")
    data = json.loads(film(str(next((tmp_path / "recordings").iterdir()))))
    assert data["about"]["mission"] == "Tea"
    assert len(data["rules"]) == 2
    assert [node["label"] for node in data["nodes"][data["root"] :]] == ["failing in any case", "battery is low"]


def test_live_and_replay_tell_the_same(done: tuple[dict[str, Any], list[str]]) -> None:
    told, data = done[0], json.loads(film(done[1][0]))
    assert told["text"] == data["text"]
    assert (told["rules"], told["root"]) == (data["rules"], data["root"])
    live = [words for _, _, words, _ in told["nodes"]]
    filled = [node["label"].replace("{name}", "Ann") for node in data["nodes"]]
    assert [words.replace("{name}", "Ann") for words in live] == filled


def test_two_runs_are_compared_with_their_words(done: tuple[dict[str, Any], list[str]]) -> None:
    data = json.loads(comparison(*done[1]))
    assert [each["text"] for each in data["films"]] == [TEXT, TEXT]
    assert data["missions"] == []
