"""`btc explain FILE`: each statement as written, as read and as a tree, in any width."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from btlang.api import Mission, parse_tree
from btlang.cli import main
from btlang.text.source import Source
from tests.conftest import matches_golden
from tests.examples.cases import world_of
from tests.printer.test_sentence import MISSIONS, ROOT
from tests.profiles import amount, cases

GOLDEN = Path(__file__).parent / "golden"
TEA = """\
# Bring the cup from the kitchen to the office.
greet is say "Good morning!" and wave; the hut is at (1, 2)

Unless the battery is full, dock then charge. Please nod; wave after turn left, then go to the hut.
ready means the battery is full
Go to Alice, then greet if someone is near. (Nod; wave) twice
try:
    go to the office, then put down the cup and say "Here you are, my dear friend, with the finest tea of all."
    repeat go to the lab then go to the kitchen then go to the lobby until ready
otherwise say "Oh dear."
"""


@pytest.mark.parametrize("width", [80, 120])
def test_a_mission_of_all_kinds(width: int) -> None:
    matches_golden(parse_tree(TEA).explain(width) + "\n", GOLDEN / f"tea_{width}.txt")


@pytest.mark.parametrize(("name", "world"), [("patrol", None), ("locked_lab", "locked_lab"), ("obedience", None)])
def test_examples(name: str, world: str | None) -> None:
    text = (ROOT / "examples" / f"{name}.txt").read_text(encoding="utf-8")
    where = str(ROOT / "examples" / "worlds" / f"{world}.toml") if world else None
    matches_golden(parse_tree(text, world=where).explain(80) + "\n", GOLDEN / f"{name}.txt")


@cases("path", MISSIONS, usual=34, first=2, ids=lambda path: path.stem)
def test_every_mission_fits(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)  # where it includes from
    text = path.read_text(encoding="utf-8-sig")
    tree = parse_tree(Source(text, str(path), may_load=True), world=world_of(path, text))
    for width in (60, 80, 120):
        lines = tree.explain(width).splitlines()
        assert all(len(line) <= width for line in lines)
        numbers = [int(line.split()[1].rstrip(":")) for line in lines if line.startswith("line ")]
        assert numbers == sorted(numbers)
        assert sum(line.startswith("  read as:") for line in lines) == len(numbers)


@pytest.mark.parametrize("text", [TEA, "(wave then nod)\nstop", "(wave then nod)", "wave; (nod; stop) then wave"])
def test_what_is_read_is_a_mission_with_the_same_tree(text: str) -> None:
    tree = parse_tree(text)
    read = "\n".join(_readings(tree.explain(10_000)))
    assert parse_tree(read).tree == tree.tree


def _readings(shown: str) -> list[str]:
    return re.findall(r"^  read as: (.*)$", shown, re.MULTILINE)


@pytest.mark.long
def test_deep_missions() -> None:
    depth = amount(1200, 5000)
    tree = parse_tree("(" * depth + "wave" + " then nod) twice" * depth)
    assert tree.explain(80).startswith("line 1:")


def test_a_tree_without_a_mission() -> None:
    """Its statements are those of its English."""
    tree = parse_tree("wave if bumped")
    explained = Mission(tree.tree, tree.vocabulary).explain()
    assert explained.startswith("line 1: if bumped, wave\n  read as: if bumped, wave\n\n  IfThenElse\n")


def test_the_command(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    assert main(["explain", "-c", "wave then nod if bumped"]) == 0
    assert "read as: wave then (if bumped, nod)" in capsys.readouterr().out
    path = tmp_path / "BT013x.txt"
    path.write_text("fly", encoding="utf-8")
    assert main(["explain", str(path)]) == 2
    assert "BT010" in capsys.readouterr().err
    assert main(["explain", str(tmp_path / "missing.txt")]) == 2
    assert "BT001" in capsys.readouterr().err
