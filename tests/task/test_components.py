"""The components and devices of a robot that is up: listed, started anew, loaded, unloaded, and what a camera sees."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from pathlib import Path

import pytest

from btlang.components.words import robot_words
from btlang.task import messages
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import TaskLayer
from btlang.task.messages import Answer, Command
from tests.components.robots import machine, robot_file
from tests.task.layers import wait_until

EYE = '\n[[device]]\nname = "eye"\nkind = "camera"\ndriver = "simulated"\n'
SONAR = '\n[[device]]\nname = "sonar"\nkind = "range"\ndriver = "simulated"\noptions = { silent = [0, 1e6] }\n'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """That of the robot, whose file each test finds as it was."""
    return tmp_path_factory.mktemp("robot")


@pytest.fixture
def layer(tmp_path: Path, folder: Path) -> Iterator[TaskLayer]:
    robot = robot_file(folder, machine() + EYE + SONAR)
    with TaskLayer(robot, MissionReader(robot_words(robot)), folder=str(tmp_path / "data")) as layer:
        wait_until(lambda: " active " in lines(layer)[0])  # components start in processes of their own
        yield layer


def lines(layer: TaskLayer) -> list[str]:
    return layer.handle(messages.Components()).text.splitlines()


def test_they_are_listed(layer: TaskLayer) -> None:
    answer = layer.handle(messages.Components())
    assert [line.split()[:2] for line in answer.text.splitlines()] == [
        ["machine", "active"], ["eye", "works"], ["sonar", "silent"],
    ]  # fmt: skip
    assert answer.data["components"][0]["version"] == "1.0"
    assert answer.data["devices"][1]["silent"] == "it is switched off in the robot file"


def test_restart_load_and_unload(layer: TaskLayer, folder: Path) -> None:
    assert layer.handle(messages.ChangeComponent("machine", "restart")).ok
    wait_until(lambda: "started 2 times" in lines(layer)[0] and " active " in lines(layer)[0])
    path = folder / "robot.toml"
    path.write_text(path.read_text(encoding="utf-8").replace("coffee:Machine", "tea:Machine"), encoding="utf-8")
    (folder / "tea.py").write_text("from coffee import Machine\n", encoding="utf-8")
    assert layer.handle(messages.ChangeComponent("machine", "load")).ok
    wait_until(lambda: " active " in lines(layer)[0] and "tea:Machine" in lines(layer)[0])
    assert layer.handle(messages.ChangeComponent("machine", "unload")).ok
    wait_until(lambda: lines(layer)[0].startswith("eye"))


def test_one_that_is_loaded_while_it_goes_is_there(layer: TaskLayer) -> None:
    for _ in range(5):
        assert layer.handle(messages.ChangeComponent("machine", "unload")).ok
        assert layer.handle(messages.ChangeComponent("machine", "load")).ok
    wait_until(lambda: lines(layer)[0].startswith("machine") and " active " in lines(layer)[0])


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        (messages.ChangeComponent("nobody", "restart"), 'there is no component "nobody"; the components are machine'),
        (messages.ChangeComponent("machine", "explode"), "explode"),
        (messages.ChangeComponent("nobody", "load"), "the robot file has no component"),
        (messages.Picture("nobody"), "the robot has no device 'nobody'"),
        (messages.Picture("sonar"), "the sonar is silent"),
    ],
)
def test_refusals(layer: TaskLayer, command: Command, reason: str) -> None:
    answer: Answer = layer.handle(command)
    assert (answer.ok, reason in answer.text) == (False, True), answer.text


def test_a_picture(layer: TaskLayer) -> None:
    answer = layer.handle(messages.Picture("eye"))
    assert (answer.data["width"], answer.data["height"]) == (160, 120)
    assert base64.b64decode(answer.data["png"]).startswith(b"\x89PNG")


def test_a_robot_without_any(tmp_path: Path) -> None:
    with TaskLayer(folder=str(tmp_path / "data")) as layer:
        assert lines(layer) == ["The robot has no components or devices of its own."]
        assert not layer.handle(messages.ChangeComponent("machine", "restart")).ok
        assert not layer.handle(messages.Picture("eye")).ok


def test_watchers_hear_of_changes(layer: TaskLayer) -> None:
    watcher = layer.feed.watch()
    told = (message for message in watcher if message["type"] == "components")
    assert next(told)["components"][0]["starts"] == 1
    layer.handle(messages.ChangeComponent("machine", "restart"))
    wait_until(lambda: next(told)["components"][0]["starts"] == 2)
    watcher.close()
