"""Missions in which something goes wrong, and what `btc run` tells of it, exactly.

The world of a mission has its name, or is the one that ships; what goes wrong stands there, or in the code of a word.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.cli import main
from btlang.frontends.mission.reader import PARSERS
from tests.conftest import matches_golden

FAILURES = Path(__file__).parent / "failures"
MISSIONS = sorted(FAILURES.glob("*.txt"))


def told(mission: Path, capsys: pytest.CaptureFixture[str], *options: str) -> str:
    """What a run of the mission writes to standard error, without notes on how it is to be run."""
    world = mission.with_suffix(".toml")
    options = (*options, "--world", world.name) if world.exists() else options
    assert main(["run", mission.name, "--keywords", "words.toml", "--speed", "max", *options]) == 1
    lines = capsys.readouterr().err.splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith("note: "))


@pytest.mark.parametrize("mission", MISSIONS, ids=lambda path: path.stem)
def test_report(mission: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(FAILURES)
    matches_golden(told(mission, capsys), mission.with_suffix(".out"))


@pytest.mark.parametrize("mission", MISSIONS, ids=lambda path: path.stem)
def test_neither_the_parser_nor_what_is_shown_matters(
    mission: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(FAILURES)
    reports = [told(mission, capsys, "--quiet", "--parser", parser) for parser in PARSERS]
    assert reports == [mission.with_suffix(".out").read_text(encoding="utf-8")] * len(PARSERS)
