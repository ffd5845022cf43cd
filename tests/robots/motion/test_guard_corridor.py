"""How far the way is free: by a scan, and by what stands around a simulated robot."""

from __future__ import annotations

from math import inf, isnan, nan

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.corridor import free_way, is_covered
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.scan import Scanner
from btlang.robots.worlds.world import FurnitureBox, Person, World

ROOM = World(
    start=Pose(2.0, 2.0, 0.0),
    walls=(((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)),),
    boxes=(FurnitureBox(3.2, 3.2, 0.6, 0.4),),
    people=(Person("Alice", 0.8, 3.0, 0.25),),
)
RADIUS = 0.2


@settings(max_examples=300, deadline=None)
@given(st.floats(0.25, 3.75), st.floats(0.25, 3.75), st.floats(-180, 180), st.sampled_from([0.0, 180.0]))
def test_both_agree(x: float, y: float, heading: float, direction: float) -> None:
    obstacles = Obstacles(ROOM)
    assume(obstacles.nearest(x, y)[0] > RADIUS + 0.01)
    assume(not ROOM.boxes[0].contains((x, y)))
    exact = obstacles.free_way(x, y, heading + direction, RADIUS)
    seen = free_way(Scanner(obstacles, 8.0).read(Pose(x, y, heading)), direction, RADIUS)
    assert exact <= seen + 1e-6  # beams miss corners
    end = Pose(x, y, heading + direction).ahead(exact)
    assert obstacles.nearest(*end)[0] == pytest.approx(RADIUS, abs=1e-6)


def scan(**beams: float) -> np.ndarray:
    ranges = np.full(360, inf)
    for beam, metres in beams.items():
        ranges[int(beam[1:]) % 360] = metres
    return ranges


def test_what_is_beside_is_not_in_the_way() -> None:
    assert free_way(scan(b90=0.21, b270=0.21), 0.0, RADIUS) == inf
    assert free_way(scan(b0=1.0), 0.0, RADIUS) == pytest.approx(0.8)
    assert free_way(scan(b0=1.0), 180.0, RADIUS) == inf
    assert free_way(scan(b180=1.0), 180.0, RADIUS) == pytest.approx(0.8)


@pytest.mark.parametrize(
    ("begin", "end", "covered"), [(-30, 30, False), (-3, 3, False), (-2, 2, True), (60, 300, True)]
)
def test_what_no_valid_beam_covers_is_not_clear(begin: int, end: int, covered: bool) -> None:
    ranges = scan()
    ranges[[beam % 360 for beam in range(begin, end)]] = nan
    assert is_covered(ranges, 0.0) is covered
    assert isnan(free_way(ranges, 0.0, RADIUS)) is not covered
