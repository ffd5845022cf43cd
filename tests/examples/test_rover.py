"""The campus rover: its tests hold, its world is that of its way points, and its words are those of its robot."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.components.words import robot_words
from btlang.robots.bodies.body_file import load_body

ROVER = Path(__file__).parents[2] / "examples" / "rover"


def test_its_tests_hold(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROVER)
    assert main(["test", ".", "--jobs", "1"]) == 0, capsys.readouterr()


def test_its_world_is_made_of_its_landmarks(tmp_path: Path) -> None:
    assert main(["world", "import", str(ROVER / "landmarks.json"), "-o", str(tmp_path / "world.toml")]) == 0
    assert (tmp_path / "world.toml").read_text(encoding="utf-8") == (ROVER / "world.toml").read_text(encoding="utf-8")


def test_a_number_without_a_unit_is_degrees() -> None:
    words, world = robot_words(str(ROVER / "robot.toml")), str(ROVER / "world.toml")
    roots = [
        btlang.parse_tree(text, keywords=words, world=world).tree.root
        for text in ("twist 90", "twist -45", "twist right", "twist right 30 degrees")
    ]
    assert [(root.id, dict(root.ports)) for root in roots] == [
        ("Twist", {"degrees": "90"}), ("Twist", {"degrees": "-45"}),
        ("TurnRight", {}), ("TurnRight", {"angle": "30"}),
    ]  # fmt: skip


def test_every_gesture_can_be_done() -> None:
    names = load_body(str(ROVER / "robot.toml")).gestures
    assert sorted(names) == ["cobra", "pick", "raised", "reach", "tucked", "wave"]
    files = [str(path) for path in (ROVER / "gestures").glob("*.toml")]
    assert main(["gesture", "check", *files, "--robot", str(ROVER / "robot.toml")]) == 0
