"""Turns whose commands come seldom and whose poses come late, as on a busy machine or over a radio link."""

from __future__ import annotations

from collections import deque

from hypothesis import given
from hypothesis import strategies as st

from btlang.robots.motion.progress import Approach, DriveProgress

ANGLE, CLOSE = 90.0, 1.0  # degrees
STEP = 0.02  # seconds
WATCHDOG = 0.5  # seconds after which the wheels stop without a command


@given(late=st.floats(0.0, 1.0), ticks=st.lists(st.floats(0.05, 1.0), min_size=5, max_size=40))
def test_a_turn_arrives_however_late_poses_and_commands_come(late: float, ticks: list[float]) -> None:
    turned, now, looks = 0.0, 0.0, 0
    poses = deque([(0.0, 0.0)])
    approach = Approach(45.0, 3.0, slowest=4.6)
    bounds = DriveProgress(ANGLE, CLOSE, True, lambda: now)
    while abs(left := ANGLE - poses[0][1]) > CLOSE:
        bounds.check(left, poses[0][1])
        velocity, until = approach.velocity(left), now + ticks[looks % len(ticks)]
        stops = now + WATCHDOG
        while now < until:
            turned += velocity * STEP * (now < stops)
            now += STEP
            poses.append((now + late, turned))
        while len(poses) > 1 and poses[1][0] <= now:
            poses.popleft()
        looks += 1
        assert looks < 1000
