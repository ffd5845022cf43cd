"""`btc diff`: missions, trees of any format, and recorded runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.cli import main

OLD = "go to the lab; try to grasp the cup; nod"
NEW = "go to the lab; try to grasp the cup; wave; nod"


def files(tmp_path: Path) -> tuple[str, str]:
    for name, text in (("old", OLD), ("new", NEW)):
        (tmp_path / f"{name}.txt").write_text(text, encoding="utf-8")
    return str(tmp_path / "old.txt"), str(tmp_path / "new.txt")


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    code = main(["diff", *words])
    return code, capsys.readouterr().out


def test_missions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = files(tmp_path)
    line = printed(capsys, old, new)[1]
    assert line.startswith("new step 'wave' behind ")
    assert printed(capsys, old, new) == (1, line)
    assert printed(capsys, old, new, "--markdown") == (1, f"- {line}")
    assert printed(capsys, old, old) == (0, "No differences.\n")


@pytest.mark.parametrize("options", [["--to", "xml"], ["--to", "xml", "--dialect", "3"], ["--to", "json"]])
def test_trees_of_any_format(options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = files(tmp_path)
    tree = str(tmp_path / f"old.{options[1]}")
    assert main(["compile", old, *options, "-o", tree]) == 0
    assert printed(capsys, tree, old) == (0, "No differences.\n")
    assert printed(capsys, tree, new) == printed(capsys, old, new)


def test_recorded_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = files(tmp_path)
    runs = [f"{path}.mcap" for path in (old, new)]
    for path, run in zip((old, new), runs, strict=True):
        assert main(["run", path, "--speed", "max", "--quiet", "--record", run]) == 0
    capsys.readouterr()
    code, lines = printed(capsys, *runs)
    assert code == 1
    assert lines.startswith("+ ")
    assert lines.endswith(" s  wave\n")
    assert printed(capsys, runs[0], runs[0]) == (0, "No differences.\n")


def test_what_cannot_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, _ = files(tmp_path)
    (tmp_path / "bad.txt").write_text("frobnicate", encoding="utf-8")
    for path in (str(tmp_path / "no.txt"), str(tmp_path / "bad.txt"), str(tmp_path)):
        assert main(["diff", old, path]) == 2
        assert "Traceback" not in capsys.readouterr().err
