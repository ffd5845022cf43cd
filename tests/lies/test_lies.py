"""What becomes of a mission if a sensor lies: see docs/lies.md for the table that this makes."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import pytest

from tests.lies import devices, simulated
from tests.lies.lies import BOARD, DEVICES, LIES, SEEN, SIMULATED, STANDS, Lie, look_true
from tests.lies.scene import Result
from tests.profiles import amount

FAR, NEAR = 6.0, 1.5  # metres to the wall
SHORT = 0.3  # metres: a robot that has only gone so far may take longer, as one that sets off


def scene(lie: Lie) -> dict[str, Any]:
    """The walls, and after how many metres the lie begins."""
    return {"wall": NEAR if lie.outcome == "wall" else FAR, "after": 0.0 if lie.outcome == "fail" else 0.3}


def mission(lie: Lie) -> str:
    """What the robot does meanwhile."""
    return "look left" if lie.sensor == "joint" else "move forward 2 m" if lie.outcome == "fine" else "move forward 5 m"


def judge_both(lies: Sequence[Lie], result: Result, late: float = 0.0) -> None:
    """Of two lies at once the stricter outcome counts, and either may be the reason."""
    print([lie.name for lie in lies], result)
    order = ("stop", "fail", "wall", "fine")
    strictest = min(lies, key=lambda lie: order.index(lie.outcome))
    words = "|".join(lie.words for lie in lies if lie.words)
    way, seconds = max(lie.way for lie in lies), max(lie.seconds for lie in lies)
    judge(
        replace(strictest, words=f"{words}|{SEEN}|{STANDS}|nothing has arrived on", way=way, seconds=seconds),
        result,
        late,
    )


def pairs(platform: str, count: int) -> list[tuple[Lie, Lie]]:
    """So many pairs of lies of two sensors, drawn at random; the seed is printed."""
    seed = int(os.environ.get("BTLANG_LIES", "0")) or Random().randrange(1, 10**6)
    print(f"pairs of lies: BTLANG_LIES={seed}")
    random = Random(seed)
    lies = [lie for lie in LIES if platform in lie.platforms and lie.sensor != "joint"]
    found: list[tuple[Lie, Lie]] = []
    while len(found) < count:
        one, other = random.sample(lies, 2)
        if one.sensor != other.sensor and not look_true((one, other)):
            found.append((one, other))
    return found


def scene_of_both(lies: Sequence[Lie]) -> dict[str, Any]:
    """Near the wall if one of them hides it."""
    wall = min(scene(lie)["wall"] for lie in lies)
    return {"wall": wall, "after": min(scene(lie)["after"] for lie in lies)}


def judge(lie: Lie, result: Result, late: float = 0.0) -> None:
    """The outcome is the one that the table asks for. A busy machine may be so much `late`."""
    assert not result.touched, result
    if lie.outcome == "fine":
        assert result.reason == "", result
        return
    assert re.search(lie.words, result.reason), result
    assert not result.moved_on, result
    if lie.outcome == "stop":
        assert result.way <= lie.way + 0.5 * late, result
        assert result.seconds <= lie.seconds + late or result.way <= SHORT, result
    elif lie.outcome == "wall":
        assert result.free > 0.0, result


@pytest.mark.parametrize("lie", [lie for lie in LIES if SIMULATED in lie.platforms], ids=lambda lie: lie.name)
def test_a_simulated_robot(lie: Lie) -> None:
    judge(lie, simulated.run(mission(lie), [lie], **scene(lie)))


def some(platform: str, usual: Sequence[str]) -> list[Lie]:
    """The lies of a platform in a long run, else the usual ones."""
    return [lie for lie in LIES if platform in lie.platforms and (amount(0, 1) or lie.name in usual)]


@pytest.mark.long
@pytest.mark.parametrize("lie", some(DEVICES, ["odometry with the wrong sign"]), ids=lambda lie: lie.name)
def test_a_driver(lie: Lie, tmp_path: Path) -> None:
    judge(lie, devices.run(tmp_path, mission(lie), [lie], **scene(lie)), 0.3)


@pytest.mark.long
@pytest.mark.parametrize("lie", some(BOARD, ["a phantom for the sonar"]), ids=lambda lie: lie.name)
def test_a_board(lie: Lie, tmp_path: Path) -> None:
    for attempt in range(3):
        result = devices.run(tmp_path / str(attempt), mission(lie), [lie], board=True, **scene(lie))
        if "silent" in lie.words or "silent" not in result.reason:
            break  # else the board itself had no time on a busy machine, and the robot stopped for that
    judge(lie, result, 0.3)


@pytest.mark.long
def test_two_lies_at_once() -> None:
    for lies in pairs(SIMULATED, amount(10, 400)):
        judge_both(lies, simulated.run("move forward 5 m", lies, **scene_of_both(lies)))


@pytest.mark.long
def test_two_lies_of_a_driver_at_once(tmp_path: Path) -> None:
    for number, lies in enumerate(pairs(DEVICES, amount(0, 50))):
        judge_both(lies, devices.run(tmp_path / str(number), "move forward 5 m", lies, **scene_of_both(lies)), 0.3)
