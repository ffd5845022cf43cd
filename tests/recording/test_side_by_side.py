"""Two recorded runs side by side."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.recording.film import side_by_side
from tests.recording.runs import recorded

TEXT = "if the battery is low, nod\notherwise wave\nsay hello"
LOW = "if the battery is above 5%, nod\notherwise wave\nsay hello"


def compared(one: Path, other: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(json.dumps(side_by_side(str(one), str(other))))
    return data


@pytest.fixture
def paths(tmp_path: Path) -> tuple[Path, Path]:
    return tmp_path / "one.mcap", tmp_path / "other.mcap"


def test_runs_that_are_the_same(paths: tuple[Path, Path]) -> None:
    for path in paths:
        recorded(TEXT, path)
    data = compared(*paths)
    assert (data["first"], data["ended"], data["stories"], data["missions"]) == (None, [], [], [])
    assert data["films"][0]["nodes"] == data["films"][1]["nodes"]


def test_runs_of_one_mission(paths: tuple[Path, Path]) -> None:
    text = "go to a random place\nif the robot is at the office, nod\notherwise wave"
    for path, seed in zip(paths, (0, 1), strict=True):
        recorded(text, path, seed)
    data = compared(*paths)
    nodes = data["films"][0]["nodes"]
    assert data["missions"] == []
    assert [nodes[each["node"]]["label"] for each in data["first"]] == ["at office"] * 2
    assert [(each["status"], each["reason"]) for each in data["first"]] == [("FAILURE", ""), ("SUCCESS", "")]
    assert {nodes[index]["label"] for index in data["ended"]} >= {"at office", "nod", "wave"}
    assert {0, 1} == {which for which, *_ in data["stories"]}


def test_runs_of_two_missions(paths: tuple[Path, Path]) -> None:
    for path, text in zip(paths, (TEXT, LOW), strict=True):
        recorded(text, path)
    data = compared(*paths)
    assert (data["first"], data["ended"]) == (None, [])
    assert any("battery" in line for line in data["missions"])
    assert [(which, words) for which, _, _, words, *_ in data["stories"]] == [(0, "wave"), (1, "nod")]


def test_what_cannot_be_read(paths: tuple[Path, Path], capsys: pytest.CaptureFixture[str]) -> None:
    recorded(TEXT, paths[0])
    paths[1].write_bytes(b"no recording")
    with pytest.raises(MissionError):
        compared(*paths)
    assert main(["diff", str(paths[0]), str(paths[0])]) == 0
    assert capsys.readouterr().out == "No differences.\n"
