"""Boards for the tests of devices."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from btlang.devices.serial_board import line as line_module
from btlang.devices.serial_board.simulated_board import SimulatedLine
from tests.devices.boards import FirmwareBoard, TestBoard, compiled


@pytest.fixture(scope="session")
def firmware(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(tmp_path_factory.mktemp("firmware"))


@pytest.fixture(params=["simulated", "firmware"])
def board(request: pytest.FixtureRequest) -> TestBoard | FirmwareBoard:
    """The same tests run on both."""
    if request.param == "simulated":
        return TestBoard("base")
    return FirmwareBoard(request.getfixturevalue("firmware"), "base")


@pytest.fixture
def line(board: TestBoard | FirmwareBoard) -> Iterator[SimulatedLine]:
    with SimulatedLine(board) as made:
        yield made


@pytest.fixture
def simulated() -> Iterator[SimulatedLine]:
    """For faults of a board itself."""
    with SimulatedLine(TestBoard("base")) as made:
        yield made


@pytest.fixture
def ports(monkeypatch: pytest.MonkeyPatch) -> list[SimulatedLine]:
    """The lines whose ports this computer has, which a test fills."""
    lines: list[SimulatedLine] = []
    monkeypatch.setattr(line_module, "serial_ports", lambda: [line.path for line in lines if line.plugged])
    return lines
