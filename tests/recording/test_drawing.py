"""Pictures of a replay are those of the run itself, as far as a recording knows the robot."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from btlang.cli import main

TEXT = "go to the kitchen, pick up the cup, go to the lab, put down the cup, say done"


def test_the_pictures_of_a_replay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    Path("m.txt").write_text(TEXT)
    run = ["run", "m.txt", "--speed", "max", "--quiet", "--record", "run.mcap"]
    assert main([*run, "--picture", "run.svg", "--tree-picture", "tree.svg"]) == 0
    replay = ["replay", "run.mcap", "--speed", "max", "--lines", "--why"]
    assert main([*replay, "--picture", "again.svg", "--tree-picture", "tree_again.svg"]) == 0
    assert "The mission succeeded" in capsys.readouterr().out
    assert Path("tree_again.svg").read_text() == Path("tree.svg").read_text()
    run_svg, again = (Path(name).read_text() for name in ("run.svg", "again.svg"))
    assert len(re.findall("<path", again)) == len(re.findall("<path", run_svg))
    assert abs(len(again) - len(run_svg)) < len(run_svg) / 50


def test_a_picture_that_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "-c", "wave", "--speed", "max", "--quiet", "--record", "run.mcap"]) == 0
    assert main(["replay", "run.mcap", "--speed", "max", "--lines", "--picture", "no/such/folder.svg"]) == 2
