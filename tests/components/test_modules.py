"""Modules in the folders of robot files: those of two robots with one name, and newer versions."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import btlang
from btlang.components.checking import check_robot
from btlang.components.component import ComponentError
from btlang.components.location import load_class
from btlang.devices.driver import DeviceError, driver_class
from btlang.diagnostics.files import read_source

ROBOT = 'name = "faulty"\nradius = 0.2\nover = "devices"\n'
DRIVER = """
class Driver:
    kinds, needs_port, rate = ("range",), False, 20.0
    def __init__(self, port, devices): self.channel = {}
    def open(self): pass
    def exchange(self, commands): return {{}}
    def close(self): pass
"""
COMPONENT = "import btlang\nclass Part(btlang.Component):\n    version = '{}'\n"


@pytest.fixture(autouse=True)
def path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path])


def written(folder: Path, name: str, text: str) -> str:
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.py").write_text(text, encoding="utf-8")
    return str(folder)


def test_each_robot_has_its_own(tmp_path: Path) -> None:
    one = written(tmp_path / "one", "part_of_robot", COMPONENT.format("1"))
    two = written(tmp_path / "two", "part_of_robot", COMPONENT.format("2") + DRIVER.format("1"))
    assert [load_class("part_of_robot:Part", folder).version for folder in (one, two, one)] == ["1", "2", "1"]
    assert driver_class("part_of_robot:Driver", two).kinds == ("range",)
    with pytest.raises(DeviceError, match="has no attribute 'Driver'"):
        driver_class("part_of_robot:Driver", one)


def test_a_newer_version_is_read(tmp_path: Path) -> None:
    for version in ("1", "2.0", "3.0.0"):
        folder = written(tmp_path / "robot", "part_with_versions", COMPONENT.format(version))
        assert load_class("part_with_versions:Part", folder).version == version


def test_one_that_breaks_leaves_the_module_before(tmp_path: Path) -> None:
    folder = written(tmp_path / "robot", "part_that_breaks", COMPONENT.format("1"))
    load_class("part_that_breaks:Part", folder)
    before = sys.modules["part_that_breaks"]
    written(tmp_path / "robot", "part_that_breaks", "raise RuntimeError('unfinished')")
    with pytest.raises(ComponentError, match="unfinished"):
        load_class("part_that_breaks:Part", folder)
    assert sys.modules["part_that_breaks"] is before


@pytest.mark.parametrize("place", [":", "a:", ":b", "os.path:join", "no.such:Part", "..:x", "btlang:Component.x.y"])
def test_odd_places_are_errors(place: str, tmp_path: Path) -> None:
    with pytest.raises(ComponentError):
        load_class(place, str(tmp_path))
    with pytest.raises(DeviceError):
        driver_class(place, str(tmp_path))


@pytest.mark.parametrize(
    ("driver", "reason"),
    [
        ("class Driver: kinds = ()", '"faulty:Driver" isn\'t a class of drivers: it has no needs_port'),
        ("def Driver(): pass", "isn't a class of drivers: it has no kinds"),
        (
            DRIVER.format("devices[0].options['channel']"),
            "the driver \"faulty:Driver\" can't be made: KeyError: 'channel'",
        ),
        (DRIVER.format("1 / 0"), "can't be made: ZeroDivisionError"),
    ],
)
def test_faulty_drivers_are_problems_of_the_robot_file(driver: str, reason: str, tmp_path: Path) -> None:
    folder = written(tmp_path / "robot", "faulty", driver)
    text = ROBOT + '[[device]]\nname = "sonar"\nkind = "range"\ndriver = "faulty:Driver"\n'
    (tmp_path / "robot" / "robot.toml").write_text(text)
    _, found = check_robot(read_source(f"{folder}/robot.toml"))
    assert reason in " ".join(each.message for each in found)
    with pytest.raises(btlang.MissionError, match="BT071"):
        btlang.Session(f"{folder}/robot.toml")


@pytest.mark.parametrize("over", ["simulated", "devices"])
@pytest.mark.parametrize(
    ("device", "reason"),
    [
        ('kind = "rang"\ndriver = "simulated"', 'there is no kind "rang"'),
        ('kind = "range"\ndriver = "simulated"\noptions = { noise = "x" }', '"noise" of the a must be a number'),
    ],
)
def test_devices_that_cannot_be(over: str, device: str, reason: str, tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text(f'{ROBOT}[[device]]\nname = "a"\n{device}\n')
    with pytest.raises(btlang.MissionError, match=reason):
        btlang.Session(str(tmp_path / "robot.toml"), over=over)
