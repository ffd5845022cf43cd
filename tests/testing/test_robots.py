"""Tests of missions on a robot of its own: its parts, its words and its world."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.testing.runner import run_test
from btlang.testing.test_file import read_tests
from btlang.testing.trial import results_of
from btlang.text.source import Source
from tests.components.robots import machine, robot_file

WORLD = """start = { x = 1, y = 1 }
places = [{ name = "counter", x = 3, y = 1 }]
walls = [[[0, 0], [5, 0], [5, 3], [0, 3], [0, 0]]]
"""


def test_a_test_runs_on_its_robot_in_the_world_of_that(tmp_path: Path) -> None:
    robot_file(tmp_path, machine())
    path = tmp_path / "robot.toml"
    path.write_text('world = "world.toml"\n' + path.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "world.toml").write_text(WORLD, encoding="utf-8")
    (tmp_path / "t.test.txt").write_text(
        'test "coffee":\n  on the robot "robot.toml"\n  run:\n    go to the counter then brew a coffee\n'
        '  "brew" fails once\n  finally the mission fails and it has reached the counter\n'
        'test "more coffee":\n  on the robot "robot.toml" with the battery at 50%\n  run:\n    brew a coffee\n'
        "  always the battery is below 51%\n  finally the mission succeeds\n",
        encoding="utf-8",
    )
    for test in read_tests(read_source(str(tmp_path / "t.test.txt"))):
        assert run_test(test).problem == ""


@pytest.mark.parametrize("runs", ["process", "here"])
def test_conditions_and_quantities_of_components_are_asked_of_the_robot(tmp_path: Path, runs: str) -> None:
    robot_file(tmp_path, machine(runs=f'"{runs}"'))
    (tmp_path / "t.test.txt").write_text(
        'test "coffee":\n  on the robot "robot.toml"\n  run:\n    wait 1 s then brew a coffee then brew a tea\n'
        "  after 0.5 s not something was brewed\n  within 9 s something was brewed\n"
        "  when the number of cups is 2, the battery drops to 15%\n"
        "  finally the number of cups is at least 2 and the battery is below 20%\n"
        'test "no coffee":\n  on the robot "robot.toml"\n  run:\n    brew a coffee\n'
        "  never something was brewed\n",
        encoding="utf-8",
    )
    one, another = map(run_test, read_tests(read_source(str(tmp_path / "t.test.txt"))))
    assert one.problem == ""
    assert "never something was brewed" in another.problem
    assert "not something was brewed" not in another.problem


@pytest.mark.parametrize("name", ["absent.toml", "../robot.toml", "broken.toml"])
def test_a_robot_that_cannot_be_used_is_a_message(tmp_path: Path, name: str) -> None:
    (tmp_path / "broken.toml").write_text("name = 3", encoding="utf-8")
    (tmp_path / "t.test.txt").write_text(f'test "t":\n  on the robot "{name}"\n  run:\n    wave\n', encoding="utf-8")
    with pytest.raises(MissionError) as caught:
        read_tests(read_source(str(tmp_path / "t.test.txt")))
    assert {one.code for one in caught.value.diagnostics} <= {"BT001", "BT071"}


def test_a_test_from_outside_names_no_robot_of_this_computer(tmp_path: Path) -> None:
    """Its components would run code."""
    path = robot_file(tmp_path, machine())
    tests = f'test "t":\n  on the robot "{path}"\n  run:\n    wave\n'
    found = results_of(Source(tests, "tests", roots=()), lambda name, world: None)
    assert [each["code"] for each in found["problems"]] == ["BT001"]
