"""Every example runs through the real command line, and does what it says."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.robots.simulation import connection as simulation
from btlang.robots.simulation.robot import SimulatedRobot

from .cases import CASES, Case

EXAMPLES = Path(__file__).parents[2] / "examples"
NEAR = 1.2


class Witness(SimulatedRobot):
    """The simulated robot, which keeps the 1 m cells of the floor that it has been in."""

    latest: Witness

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.cells: set[tuple[int, int]] = set()
        Witness.latest = self

    def step(self, dt: float) -> None:
        super().step(dt)
        self.cells.add((int(self.pose.x), int(self.pose.y)))


def mission(name: str) -> list[str]:
    """The arguments that name an example, which names its world itself."""
    return [str(EXAMPLES / f"{name}.txt")]


def words_of(line: dict[str, Any]) -> str:
    """A command as `Id` and its values."""
    return " ".join([line["id"], *map(str, line["ports"].values())])


def commands(log: list[dict[str, Any]], case: Case, status: str) -> tuple[str, ...]:
    """The commands that ended so, in their order."""
    world = str(EXAMPLES / "worlds" / f"{case.world}.toml") if case.world else None
    vocabulary = world_vocabulary(world=world)
    lines = [(line, vocabulary.entry(line["id"])) for line in log if line.get("status") == status]
    return tuple(words_of(line) for line, entry in lines if entry is not None and entry.sort == "action")


def met(log: list[dict[str, Any]]) -> set[str]:
    """Robot events, alone and with the kind of fault or the name of the thing."""
    events = [line for line in log if "event" in line]
    plain = {line["event"] for line in events}
    return plain | {f"{line['event']} {line.get('kind', line.get('name'))}" for line in events}


def texts(log: list[dict[str, Any]], event: str) -> tuple[str, ...]:
    """What the robot said or printed."""
    return tuple(line["text"] for line in log if line.get("event") == event)


def test_every_example_is_listed() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.txt")} == set(CASES)


@pytest.mark.parametrize("name", CASES)
def test_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    case = CASES[name]
    monkeypatch.setattr(simulation, "SimulatedRobot", Witness)
    path = tmp_path / "log.json"
    assert main(["run", *mission(name), *case.options, "--speed", "max", "--log", str(path)]) == case.code
    assert case.error in capsys.readouterr().err
    log = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]

    done = commands(log, case, "SUCCESS")
    if case.done[-1] == "...":
        done = (*done[: len(case.done) - 1], "...")
    assert done == case.done
    assert commands(log, case, "FAILURE") == case.failed
    assert texts(log, "say") == case.said
    assert texts(log, "print") == case.printed
    assert case.seconds[0] <= log[-1]["t"] <= case.seconds[1]

    robot = Witness.latest
    assert "bump" not in met(log)
    assert robot.bumps == 0
    assert set(case.met) <= met(log)
    assert len(robot.cells) >= case.cells
    assert case.at is None or robot.pose.distance_to(robot.locate(case.at)) <= NEAR
    for thing, place in case.put.items():
        assert distance(robot.locate(thing), robot.locate(place)) <= NEAR
        assert thing not in (robot.holding("left"), robot.holding("right"))


def distance(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Metres between two points."""
    return ((one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2) ** 0.5


@pytest.mark.parametrize("name", CASES)
def test_both_parsers_give_one_tree_without_a_warning(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    trees = []
    for parser in ("shunting-yard", "lark"):
        assert main(["tree", *mission(name), "--plain", "--parser", parser]) == 0
        trees.append(capsys.readouterr())
    assert trees[0].out == trees[1].out
    assert trees[0].err == ""


@pytest.mark.parametrize("name", CASES)
def test_the_comment_on_top_says_how_to_run_it(name: str) -> None:
    lines = (EXAMPLES / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    comment = [line for line in lines[: lines.index("")] if line.startswith("#")]
    world = CASES[name].world
    assert len(comment) == lines.index("") >= 2
    assert comment[-1].startswith(f"#   btc run examples/{name}.txt")
    assert "--world" not in comment[-1]
    assert (f'world "worlds/{world}.toml"' in lines) == bool(world)


def test_roaming_is_the_founding_example() -> None:
    lines = (EXAMPLES / "roaming.txt").read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line and not line.startswith(("#", "world "))] == [
        "meet wall is if wall in front print hello",
        "avoid wall is if wall in front turn left",
        "do the twist is turn right then turn left",
        "angle right is move forward then turn right",
        "angle left is move forward then turn left",
        "do the twist then repeat avoid wall or move forward",
    ]


@pytest.mark.parametrize(
    "path", sorted(EXAMPLES.glob("*/missions/*.txt")), ids=lambda path: f"{path.parts[-3]}/{path.stem}"
)
def test_missions_of_projects_run_without_options(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(path), "--speed", "max", "--for", "20s", "--quiet"]) == 0, capsys.readouterr().err
