"""The missions that ship end on a ROS 2 robot as they do in the built-in simulation, each of their commands too."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from btlang.api import world_vocabulary
from btlang.cli import main
from tests.examples.cases import CASES
from tests.examples.test_examples import mission, words_of
from tests.ros.processes import Command

SPEED = {"oily_floor": "2"}
"""Of the simulator, where it is not 6: there the mission has to begin soon, before its faults."""
LONGEST = 150.0
"""Seconds of the longest mission, by the clock of the simulator."""
VARYING = {"careful_walk", "locked_lab", "look_before_you_go", "oily_floor"}
"""How often a command runs in them, if at all, depends on when the mission begins, or on a centimetre: what is compared
is how those commands ended that ran in both."""
ENDING = [name for name, case in CASES.items() if "--for" not in case.options]


def outcomes(path: Path, world: str | None) -> Counter[tuple[str, str]]:
    """How often each command ended how. Their order may differ where several run at the same time."""
    vocabulary = world_vocabulary(world=world)
    lines: list[dict[str, Any]] = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    ended = [line for line in lines if line.get("status") in ("SUCCESS", "FAILURE") and "id" in line]
    entries = [(line, vocabulary.entry(line["id"])) for line in ended]
    return Counter(
        (words_of(line), line["status"]) for line, entry in entries if entry is not None and entry.sort == "action"
    )


@pytest.mark.parametrize("name", ENDING)
def test_an_example_ends_as_in_the_simulation(
    name: str,
    tmp_path: Path,
    domain: int,
    start_sim: Callable[..., Command],
    nav2: object,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path, *rest = mission(name)
    world = rest[1] if rest else None
    built_in, over_ros = tmp_path / "built_in.json", tmp_path / "over_ros.json"
    code = main(["run", path, *rest, *CASES[name].options, "--speed", "max", "--quiet", "--log", str(built_in)])
    capsys.readouterr()

    start_sim(*(rest or ["--world", str(shipped_world())]), "--speed", SPEED.get(name, "6"))
    options = ["--robot", "ros", "--sim-time", "--log", str(over_ros)]
    command = Command(tmp_path, domain, "run", path, *rest, *CASES[name].options, *options)
    assert command.process.wait(LONGEST) == code, command.err
    expected, found = outcomes(built_in, world), outcomes(over_ros, world)
    if name in VARYING:
        both = {command for command, _ in expected} & {command for command, _ in found}
        assert both
        assert {end for end in found if end[0] in both} == {end for end in expected if end[0] in both}
    else:
        assert found == expected


def shipped_world() -> str:
    """The world of missions that name none."""
    from btlang.vocabulary.shipped import DEFAULT_WORLD

    return DEFAULT_WORLD
