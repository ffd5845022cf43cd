"""The missions that ship do the same on a ROS 2 robot as in the built-in simulation, command by command."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary.shipped import DEFAULT_WORLD
from tests.examples.cases import CASES
from tests.examples.test_examples import mission, words_of
from tests.profiles import amount
from tests.ros.lock_step import in_lock_step
from tests.ros.processes import LONG, Command

ENDING = [name for name, case in CASES.items() if "--for" not in case.options]
USUAL = ("find_someone", "obedience")
"""Those of each run, which drive, see and hear. `-m long` runs all."""
LATER = 0.1
"""How much longer or shorter a mission may take over ROS 2."""
BY_CHANCE = {"guided_tour": 0.5}
"""The same where chance decides how well somebody keeps up."""
TURN = 1.0
"""Seconds within which the order of two commands that go on at the same time may be another one."""


class Simulator(Command):
    """The robot, which waits for the mission."""

    program = ("-m", "tests.ros.lock_step")


def story(path: Path, world: str | None) -> list[tuple[float, str, str]]:
    """When each command ended, and how, with all that was said and shown meanwhile."""
    vocabulary = world_vocabulary(world=world)
    told: list[tuple[float, str, str]] = []
    for text in path.read_text(encoding="utf-8").splitlines():
        line: dict[str, Any] = json.loads(text)
        if line.get("event") in ("say", "print"):
            told.append((line["t"], line["event"], line["text"]))
        elif line.get("status") in ("SUCCESS", "FAILURE") and "id" in line:
            entry = vocabulary.entry(line["id"])
            if entry is not None and entry.sort == "action":
                told.append((line["t"], line["status"], words_of(line)))
    return told


def assert_same(over_ros: Path, built_in: Path, world: str | None, later: float) -> None:
    """The same happened in the same order, took as long, and ended for the same reason."""
    found, expected = story(over_ros, world), story(built_in, world)
    assert sorted(what for _, *what in found) == sorted(what for _, *what in expected)
    for (_, *what), (turn, *_) in zip(found, expected, strict=True):
        assert any(what == other and abs(when - turn) <= TURN for when, *other in expected), f"{what} at {turn}"
    end, expected_end = ending(over_ros), ending(built_in)
    assert end.pop("seconds") == pytest.approx(expected_end.pop("seconds"), rel=later)
    assert end == expected_end


def ending(path: Path) -> dict[str, Any]:
    """What is told of the end."""
    end: dict[str, Any] = json.loads(path.read_text(encoding="utf-8").splitlines()[-1])
    assert end.pop("event") == "end"
    for own in ("t", "run", "number", "wall"):
        del end[own]
    return end


@pytest.mark.long
@pytest.mark.parametrize("name", amount(0, 1) * ENDING or USUAL)
def test_an_example_does_as_in_the_simulation(
    name: str,
    tmp_path: Path,
    domain: int,
    monkeypatch: pytest.MonkeyPatch,
    nav2: object,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path, *rest = mission(name)
    world = rest[1] if rest else None
    command = ["run", path, *rest, *CASES[name].options, "--quiet", "--log"]
    built_in, over_ros = tmp_path / "built_in.json", tmp_path / "over_ros.json"
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    simulator = Simulator(tmp_path, domain, world or str(DEFAULT_WORLD))
    code = main([*command, str(built_in), "--speed", "max"])
    expected = capsys.readouterr().err
    simulator.wait_for("ready")
    in_lock_step(monkeypatch)
    assert main([*command, str(over_ros), "--robot", "ros", "--sim-time"]) == code, capsys.readouterr().err
    assert simulator.end() == 130
    assert simulator.err == ""

    assert bool(capsys.readouterr().err) == bool(expected)
    assert_same(over_ros, built_in, world, BY_CHANCE.get(name, LATER))


def test_it_does_with_clocks_that_wait_for_nobody(
    tmp_path: Path, domain: int, start_sim: Callable[..., Command], capsys: pytest.CaptureFixture[str]
) -> None:
    path = mission("first_steps")[0]
    built_in, over_ros = tmp_path / "built_in.json", tmp_path / "over_ros.json"
    assert main(["run", path, "--quiet", "--log", str(built_in), "--speed", "max"]) == 0
    start_sim("--world", str(DEFAULT_WORLD), "--speed", "3")
    command = Command(tmp_path, domain, "run", path, "--log", str(over_ros), "--robot", "ros", "--sim-time")
    assert command.process.wait(LONG * 2) == 0, command.err
    found, expected = story(over_ros, None), story(built_in, None)
    assert [what for _, *what in found] == [what for _, *what in expected]
