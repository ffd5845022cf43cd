"""Missions that say at their top for which robot they are."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.testing.test_file import read_tests
from btlang.text.source import Source
from btlang.vocabulary.shipped import BODIES

WORLD = 'start = { x = 1, y = 1 }\nplaces = [{ name = "pitch", x = 3, y = 1 }]\n'
ROBOT = (
    (Path(BODIES) / "small.toml")
    .read_text(encoding="utf-8")
    .replace('name = "small"', 'name = "cart"\nworld = "field.toml"')
)
MISSION = 'robot "../robot.toml"\n\ngo to the pitch\n'


@pytest.fixture(autouse=True)
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a robot, its world and a mission for it; the current folder is another one."""
    folder = tmp_path / "project"
    (folder / "missions").mkdir(parents=True)
    (folder / "tests").mkdir()
    (folder / "field.toml").write_text(WORLD)
    (folder / "robot.toml").write_text(ROBOT)
    (folder / "missions" / "half.txt").write_text(MISSION)
    (folder / "tests" / "half.test.txt").write_text(
        'test "it gets there":\n  run "../missions/half.txt"\n  finally it has reached the pitch\n'
    )
    monkeypatch.chdir(tmp_path)
    return folder


def test_it_runs_without_options(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for verb in ("run", "check", "tree"):
        options = ["--speed", "max", "--lines"] if verb == "run" else []
        assert main([verb, "project/missions/half.txt", *options]) == 0, capsys.readouterr().err
    assert "done   go to pitch" in capsys.readouterr().out


def test_the_library_and_sessions_take_its_robot(project: Path) -> None:
    path = project / "missions" / "half.txt"
    mission = btlang.parse_file(path)
    assert Path(mission.robot).resolve() == project / "robot.toml"
    assert mission.run(speed="max").succeeded
    with btlang.Session() as session:
        assert session.run(path, speed="max").outcome.succeeded  # type: ignore[union-attr]
        assert session.robot.body.name == "cart"


def test_a_test_takes_it_too(project: Path) -> None:
    [test] = read_tests(read_source(str(project / "tests" / "half.test.txt")))
    assert Path(test.robot).resolve() == project / "robot.toml"
    assert main(["test", "project"]) == 0


def test_another_robot_wins(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (project / "other.toml").write_text('name = "other"\nradius = 0.3\n')
    assert main(["check", "project/missions/half.txt", "--robot", "project/other.toml"]) == 2
    assert "There's no place" in capsys.readouterr().err


def test_a_text_from_elsewhere_is_for_the_robot_that_runs_it() -> None:
    text = MISSION.replace("pitch", "lab")
    assert btlang.parse_tree(text).robot == ""
    assert btlang.parse_tree(Source(text, roots=())).run(speed="max").succeeded


@pytest.mark.parametrize(
    ("lines", "reason"),
    [
        ('robot "../robot.toml"\nrobot "../robot.toml"', "the mission has a robot already"),
        ('robot "../../robot.toml"', "outside the folder"),
        ('wave\nrobot "../robot.toml"', "comes before all others"),
        ('robot "../none.toml"', "(?i)no such file"),
    ],
)
def test_mistakes(project: Path, lines: str, reason: str) -> None:
    path = project / "missions" / "half.txt"
    path.write_text(f"{lines}\nwave\n")
    with pytest.raises(MissionError, match=reason):
        btlang.parse_file(path)
