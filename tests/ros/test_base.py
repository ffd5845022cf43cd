"""When a base that is told to move counts as stuck, with odometry that the test gives."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

from btlang.ros.base import RosBase


class Standing:
    """Tells of a robot that stands still."""

    def listen(self, *arguments: object, **options: object) -> None:
        pass

    def get(self, topic: str, limit: float | None = None) -> Any:
        still = SimpleNamespace(linear=SimpleNamespace(x=0.0), angular=SimpleNamespace(z=0.0))
        return SimpleNamespace(twist=SimpleNamespace(twist=still))


def test_a_base_that_stands_for_a_second_is_stuck() -> None:
    base = RosBase(MagicMock(), Standing(), 0.2)  # type: ignore[arg-type]
    base.drive(0.5, 0.0)
    for _ in range(19):
        base.step(0.05)
    assert not base.stuck
    base.step(0.06)
    assert base.stuck


def test_one_that_braked_since_a_step_came_late_is_not() -> None:
    base = RosBase(MagicMock(), Standing(), 0.2)  # type: ignore[arg-type]
    base.drive(0.5, 0.0)
    base.step(3.0)
    assert not base.stuck
