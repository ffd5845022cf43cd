"""What becomes of a mission if a sensor lies: see docs/lies.md for the table that this makes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.lies import devices, simulated
from tests.lies.lies import BOARD, DEVICES, LIES, SIMULATED, Lie
from tests.lies.scene import Result
from tests.profiles import amount

WAY, SECONDS = 0.5, 1.0
"""Metres and seconds within which a robot is at rest that must stop."""
FAR, NEAR = 6.0, 1.5  # metres to the wall


def scene(lie: Lie) -> dict[str, float]:
    """The walls, and after how many metres the lie begins."""
    return {"wall": NEAR if lie.outcome == "wall" else FAR, "after": 0.0 if lie.outcome == "fail" else 0.3}


def mission(lie: Lie) -> str:
    """What the robot does meanwhile."""
    return "look left" if lie.sensor == "joint" else "move forward 2 m" if lie.outcome == "fine" else "move forward 5 m"


def judge(lie: Lie, result: Result, late: float = 0.0) -> None:
    """The outcome is the one that the table asks for. A busy machine may be so much `late`."""
    assert not result.touched, result
    if lie.outcome == "fine":
        assert result.reason == "", result
        return
    assert re.search(lie.words, result.reason), result
    assert not result.moved_on, result
    if lie.outcome == "stop":
        assert result.way <= WAY + 0.5 * late, result
        assert result.seconds <= SECONDS + late, result
    elif lie.outcome == "wall":
        assert result.free > 0.01, result


@pytest.mark.parametrize("lie", [lie for lie in LIES if SIMULATED in lie.platforms], ids=lambda lie: lie.name)
def test_a_simulated_robot(lie: Lie) -> None:
    judge(lie, simulated.run(mission(lie), [lie], **scene(lie)))


def _some(platform: str, usual: list[str]) -> list[object]:
    lies = [lie for lie in LIES if platform in lie.platforms]
    return [
        pytest.param(lie, id=lie.name, marks=() if lie.name in usual else pytest.mark.long)
        for lie in lies
        if amount(0, 1) or lie.name in usual
    ]


@pytest.mark.parametrize("lie", _some(DEVICES, ["odometry with the wrong sign", "no valid beam ahead"]))
def test_a_driver(lie: Lie, tmp_path: Path) -> None:
    judge(lie, devices.run(tmp_path, mission(lie), [lie], **scene(lie)), 0.3)


@pytest.mark.parametrize("lie", _some(BOARD, ["a phantom for the sonar"]))
def test_a_board(lie: Lie, tmp_path: Path) -> None:
    judge(lie, devices.run(tmp_path, mission(lie), [lie], board=True, **scene(lie)), 0.3)
