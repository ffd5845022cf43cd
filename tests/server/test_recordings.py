"""Trials, and the recordings of a robot, for pages."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from btlang.api import parse_tree
from btlang.cli import main
from btlang.server.http.access import AccessError
from btlang.server.page.recordings import list_recordings, path_of
from btlang.task.layer import TaskLayer
from btlang.task.store.records import TaskState
from tests.server.doors import Door, robot_in
from tests.task.layers import submit, wait_for

TEXT = "say hello\ncheck that the robot is not at the lab\ngo to the lab"


@pytest.fixture(scope="module")
def robot() -> Iterator[TaskLayer]:
    """One that records its tasks."""
    folder = Path(tempfile.mkdtemp(prefix="bt"))
    try:
        with robot_in(folder, recordings=str(folder / "recordings")) as layer:
            layer.folder = folder  # type: ignore[attr-defined]
            yield layer
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="module")
def names(door: Door, robot: TaskLayer) -> list[str]:
    """The recordings of a run and of one that failed, of one mission."""
    for _ in range(2):
        wait_for(robot, submit(robot, TEXT), TaskState.COMPLETED, TaskState.FAILED)
    return list(reversed([each["name"] for each in recordings(door)]))


def recordings(door: Door) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = door.ask("GET", "/api/recordings", **door.log_in("vic")).data["recordings"]
    return found


def test_a_trial(door: Door) -> None:
    vic = door.log_in("vic")
    film = door.ask("POST", "/api/try", {"text": 'say "🤖"\nwave twice'}, **vic).data
    assert (film["ok"], film["stopped"], film["failed"]) == (True, "", -1)
    assert [(node["start"], node["end"]) for node in film["nodes"]][2:] == [(9, 19), (9, 13)]
    assert film["map"]["places"]
    wrong = door.ask("POST", "/api/try", {"text": "wav"}, **vic).data
    assert (wrong["ok"], wrong["messages"][0]["code"]) == (False, "BT010")
    endless = door.ask("POST", "/api/try", {"text": "repeat: print hello"}, **vic).data
    assert endless["stopped"]


def test_tests_of_a_mission(door: Door) -> None:
    tests = 'test "it waves":\n  run "tour"\n  finally it has said "🤖"'
    asked = {"text": "# 🤖\nwave", "tests": tests, "called": "tour"}
    assert door.ask("POST", "/api/test", asked).status == 401
    vic = door.log_in("vic")
    [failed] = door.ask("POST", "/api/test", asked, **vic).data["results"]
    assert (failed["passed"], failed["at"], failed["film"]["text"]) == (False, 3, asked["text"])
    assert door.ask("POST", "/api/test", {**asked, "tests": tests.replace("🤖", "")}, **vic).data["problems"] == []
    for wrong in ({"tests": 5}, {"called": None}, {"tests": None}):
        assert door.ask("POST", "/api/test", {**asked, **wrong}, **vic).status == 400
    assert door.ask("POST", "/api/test", {**asked, "tests": "#" * 200_001}, **vic).status == 413
    secret = door.ask("POST", "/api/test", {**asked, "tests": 'test "t":\n  run "pyproject.toml"'}, **vic).data
    assert [each["code"] for each in secret["problems"]] == ["BT001"]
    long = 'test "t":\n  run "tour" for at most 10 hours\n  finally the mission fails\n' * 3
    late = door.ask("POST", "/api/test", {**asked, "text": "repeat: print hello", "tests": long}, **vic).data
    assert [each["passed"] for each in late["results"]] == [False, None, None]


def test_recordings_of_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = str(tmp_path)
    path = tmp_path / "2026-01-01-100000-ab12.mcap"
    assert main(["run", "-c", "wave", "--speed", "max", "--quiet", "--record", str(path)]) == 0
    capsys.readouterr()
    (tmp_path / "broken.mcap").write_bytes(b"no recording")
    (tmp_path / "other.txt").write_text("x")
    assert {each["name"] for each in list_recordings(folder)} == {path.name, "broken.mcap"}
    assert path_of(folder, path.name) == os.path.join(folder, path.name)
    for name in ("../x.mcap", "other.txt", "none.mcap", "", "a/b.mcap", "\0.mcap", "x.mcap\n", "..mcap"):
        with pytest.raises(AccessError):
            path_of(folder, name)
    with pytest.raises(AccessError):
        list_recordings("")


@pytest.mark.parametrize(
    "path",
    [
        "/api/recordings",
        "/api/recordings/x.mcap",
        "/api/films/x.mcap",
        "/api/trees/x.mcap",
        "/api/failures/x.mcap",
        "/api/comparisons/x.mcap?with=y.mcap",
    ],
)
def test_who_may_see_recordings(door: Door, path: str) -> None:
    assert door.ask("GET", path).status == 401
    assert door.ask("GET", path, **door.log_in("vic")).status in (200, 404)


def test_two_runs_are_compared(door: Door, names: list[str]) -> None:
    vic = door.log_in("vic")
    one, other = names
    data = door.ask("GET", f"/api/comparisons/{one}?with={other}", **vic).data
    assert data["ok"]
    assert (data["missions"], len(data["films"])) == ([], 2)
    assert [film["failed"] for film in data["films"]].count(-1) == 1
    nodes = data["films"][0]["nodes"]
    assert [nodes[each["node"]]["label"] for each in data["first"]] == ["at lab"] * 2
    assert data["first"][0]["node"] in data["ended"]
    assert door.ask("GET", f"/api/comparisons/{one}?with={one}", **vic).data["first"] is None
    for wrong in (f"{one}", f"{one}?with=../{other}", f"x.mcap?with={other}"):
        assert door.ask("GET", f"/api/comparisons/{wrong}", **vic).status == 404


def test_failures_of_all_runs_of_a_mission_are_counted(door: Door, robot: TaskLayer, names: list[str]) -> None:
    vic = door.log_in("vic")
    wait_for(robot, submit(robot, "wave"), TaskState.COMPLETED)  # another mission
    data = door.ask("GET", f"/api/failures/{names[0]}", **vic).data
    nodes = door.ask("GET", f"/api/films/{names[0]}", **vic).data["nodes"]
    assert (data["ok"], data["runs"], data["failed"]) == (True, 2, 1)
    assert {nodes[node]["label"]: count for node, count in data["failures"]} == {"then": 1, "not": 1}


def test_the_tree_of_a_recording(door: Door, names: list[str]) -> None:
    xml = door.ask("GET", f"/api/trees/{names[0]}", **door.log_in("vic")).data["xml"]
    assert parse_tree(xml).tree == parse_tree(TEXT).tree
