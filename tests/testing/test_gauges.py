"""Gauges that change during a test: quantities of keyword files, and gauges of the robot file."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.diagnostics.files import read_source
from btlang.testing.runner import run_test
from btlang.testing.test_file import read_tests
from tests.components.robots import machine, robot_file

LOAD = """[[type]]
name = "mass"
units = [{ words = ["kg"], factor = "1" }, { words = ["g"], factor = "1/1000" }]

[[quantity]]
phrase = "load"
type = "mass"
id = "Load"
call = "loads:load"

[[quantity]]
phrase = "noise at {place}"
type = "number"
id = "Noise"
call = "loads:noise"
"""
LOADS = "def load():\n    return 0.5\n\n\ndef noise(place):\n    return 1.0\n"
GAS = """
[[component]]
name = "nose"
class = "nose:Nose"
runs = "%s"

[[device]]
name = "gas_sensor"
kind = "gauge"
driver = "simulated"
options = { value = 3 }
"""
NOSE = """from btlang import Component

class Nose(Component):
    needs = ("gas_sensor",)

    def smells(self):
        return self.read("gas_sensor").value > 10
"""
NOSE_WORDS = '[[condition]]\nphrase = "it smells"\nid = "Smells"\ncall = "nose:Nose.smells"\n'


def problems_of(folder: Path, text: str) -> list[str]:
    (folder / "t.test.txt").write_text(text, encoding="utf-8")
    return [run_test(test).problem for test in read_tests(read_source(str(folder / "t.test.txt")))]


@pytest.fixture
def words(tmp_path: Path) -> Path:
    (tmp_path / "loads.toml").write_text(LOAD, encoding="utf-8")
    (tmp_path / "loads.py").write_text(LOADS, encoding="utf-8")
    (tmp_path / "m.txt").write_text(
        'words "loads.toml"\nwhenever the load is above 2 kg, say heavy\nwait 10 s\n', encoding="utf-8"
    )
    return tmp_path


def test_a_quantity_of_a_keyword_file_changes_as_the_battery_does(words: Path) -> None:
    found = problems_of(
        words,
        'test "it rises":\n  run "m.txt"\n  always the load is at least 300 g\n  after 2 s it has never said heavy\n'
        "  then after 1 s the load rises to 3 kg\n  within 1 s it has said heavy\n  after 1 s the load falls to 400 g\n"
        "  for 1 s the load is below 500 g\n"
        'test "as it is":\n  run "m.txt"\n  finally the load is 0.5 kg and it has never said heavy\n'
        'test "at first":\n  with the load at 5 kg\n  run "m.txt"\n  within 1 s it has said heavy\n',
    )
    assert found == ["", "", ""]


def test_only_the_values_of_slots_that_the_test_names_change(words: Path) -> None:
    [problem] = problems_of(
        words,
        'test "noise":\n  run "m.txt"\n  after 1 s the noise at the lab rises to 7\n'
        "  after 1 s the noise at the lab is above 6 and the noise at the hall is below 2\n"
        "  finally the noise at the lab is below 6\n",
    )
    assert "finally the noise at the lab is below 6" in problem
    assert "it is 7" in problem


@pytest.mark.parametrize("runs", ["process", "here"])
def test_a_gauge_of_the_robot_file_changes_for_the_components_that_read_it(tmp_path: Path, runs: str) -> None:
    robot_file(tmp_path, machine() + GAS % runs)
    (tmp_path / "nose.py").write_text(NOSE, encoding="utf-8")
    (tmp_path / "nose.toml").write_text(NOSE_WORDS, encoding="utf-8")
    found = problems_of(
        tmp_path,
        'test "gas":\n  on the robot "robot.toml"\n  run:\n    whenever it smells, say gas\n    wait 5 s\n'
        "  after 1 s not it smells\n  after 1 s the gas sensor rises to 20\n  within 1 s it has said gas\n"
        "  then the gas_sensor drops to 2%\n  after 1 s not it smells\n"
        'test "gas at first":\n  on the robot "robot.toml" with the gas sensor at 12\n  run:\n    wait 1 s\n'
        "  always it smells\n",
    )
    assert found == ["", ""]
