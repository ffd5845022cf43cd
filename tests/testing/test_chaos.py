"""Chaos is the same for the same seed, keeps shipped missions safe, and notices when a rule of safety is broken."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.cli import main
from btlang.diagnostics.files import read_source
from btlang.robots.simulation.base import SimulatedBase
from btlang.testing.runner import run_chaos
from btlang.testing.test_file import read_tests
from btlang.tree.node import Node, Tree
from tests.profiles import amount
from tests.testing.files import mission_test
from tests.testing.test_example_tests import EXAMPLES, ROOT

WALK = "repeat 5 times: go to the lab, then pick up the book, then go to the hall"


def test_the_same_seed_gives_the_same_troubles() -> None:
    runs = [run_chaos(mission_test(WALK), seed) for seed in (3, 3, 4)]
    assert runs[0] == runs[1]
    assert runs[0].troubles
    assert runs[0].troubles != runs[2].troubles


def test_all_kinds_of_trouble_come() -> None:
    told = "\n".join(line for seed in range(40) for line in run_chaos(mission_test(WALK), seed).troubles)
    for kind in ("grip", "scanner", "blocked", "goal", "hand", "in the way", "emergency stop"):
        assert kind in told


@pytest.mark.long
@pytest.mark.parametrize("example", EXAMPLES[:: amount(6, 1)])
def test_shipped_missions_are_safe(example: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    test = read_tests(read_source(f"examples/tests/{example}.test.txt"))[0]
    for seed in range(amount(1, 30)):
        assert run_chaos(test, seed).problem == ""


def test_a_robot_that_does_not_brake_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SimulatedBase, "brake", lambda self: None)
    problems = [run_chaos(mission_test("repeat forever: turn left"), seed).problem for seed in range(10)]
    assert any("after a stop" in problem or "after the mission was over" in problem for problem in problems)


def test_a_robot_that_is_too_fast_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.robots.simulation.base.clip_speed", lambda value, limit: value * 10)
    assert "faster than its body allows" in run_chaos(mission_test("move forward 2 m"), 0).problem


def test_two_holders_of_the_base_are_noticed() -> None:
    test = mission_test("wave")
    drive = tuple(Node("MoveForward", (), (("distance", distance),)) for distance in ("2", "3"))
    mission = test.mission.replace(tree=Tree(Node("Parallel", drive)), syntax=None)
    assert "both used: base" in run_chaos(test.replace(mission=mission), 0).problem


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.test.txt").write_text('test "it walks":\n  run:\n    go to the lab\n  finally the mission fails\n')
    assert main(["test", "--chaos", "--repeat", "4"]) == 0
    assert "ok      a.test.txt:1: it walks (4 times, " in capsys.readouterr().out
