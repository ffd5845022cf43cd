"""The guide of the museum: its missions on its body, its gestures in step, and a week of its life."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.components.words import robot_words
from btlang.run.events import Event, StrokePlanned, Warned
from btlang.session import Session
from tests.guide.week import GUIDE
from tests.profiles import amount

ROBOT, WORLD = str(GUIDE / "robot.toml"), str(GUIDE / "world.toml")
MISSIONS = sorted((GUIDE / "missions").glob("*.txt"))
_MOST = 0.08  # seconds between a stroke and its word


@pytest.mark.parametrize("path", [*MISSIONS, GUIDE / "house_rules.txt"], ids=lambda path: path.stem)
def test_missions_fit_the_robot(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(path), "--robot", ROBOT]) == 0, capsys.readouterr().err
    assert capsys.readouterr().err == ""


class Strokes:
    """How far strokes are from their words, and what was left out."""

    def __init__(self) -> None:
        self.gaps: list[float] = []
        self.warnings: list[str] = []

    def __call__(self, event: Event) -> None:
        if isinstance(event, StrokePlanned):
            self.gaps.append(abs(event.stroke - event.word))
        elif isinstance(event, Warned):
            self.warnings.append(event.text)


@pytest.mark.long
@pytest.mark.parametrize("rate", [20.0, 50.0, 10.0, 5.0][: amount(1, 4)])
def test_strokes_meet_their_words_in_all_commentaries(rate: float) -> None:
    strokes = Strokes()
    for path in MISSIONS[:: amount(len(MISSIONS) // 2, 1)]:
        mission = btlang.parse_tree(path.read_text(encoding="utf-8"), keywords=robot_words(ROBOT), world=WORLD)
        with Session(ROBOT, world=WORLD) as session:
            run = session.prepare(mission, speed="max", rate=rate, seed=1, time_limit=600.0, sinks=[strokes])
            assert run.execute().stopped in ("", "time limit")
    gaps = sorted(strokes.gaps)
    print(f"{len(gaps)} strokes at {rate:g} Hz: p95 {gaps[int(0.95 * len(gaps))]:.3f} s, at most {gaps[-1]:.3f} s")
    assert len(gaps) > amount(10, 50)
    assert gaps[int(0.95 * len(gaps))] <= _MOST
    assert strokes.warnings == []


@pytest.mark.long
def test_weeks_of_the_museum() -> None:
    """Every tour is given or its absence explained, and nothing happens that must not."""
    seeds, days = amount(1, 10), amount(2, 140) / 20
    for first in range(0, seeds, 2):
        running = [
            subprocess.Popen(
                [sys.executable, "-m", "tests.guide.week", str(seed), str(days)], stdout=subprocess.PIPE, text=True
            )
            for seed in range(first, min(first + 2, seeds))
        ]
        for process in running:
            printed, _ = process.communicate(timeout=3600)
            assert process.returncode == 0
            week = json.loads(printed)
            print(week)
            assert week["contacts"] == week["entries"] == week["late"] == week["unexplained"] == []
            assert week["least battery"] >= 10.0
            assert week["asked"] == 0 or week["answered"] + week["passed on"] > 0
            assert week["tasks"].get("completed", 0) > 0
