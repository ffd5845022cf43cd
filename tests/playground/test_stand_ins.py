"""What the playground has in place of compiled packages does as they do."""

from __future__ import annotations

import json
from collections.abc import Callable
from random import Random
from typing import Any

import numpy
import pytest

from btlang.playground.stand_ins import numpy as pure
from btlang.robots.geometry import Pose
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.scan import scan, trace_beams
from btlang.robots.worlds.world_file import read_world
from tests.playground.pure import found, found_without_packages
from tests.profiles import amount
from tests.test_house import ROOT

EXAMPLES = ROOT / "examples"
FEW = ("careful_walk", "delivery", "coffee_round")

Build = Callable[[Any], Any]
"""Makes something with NumPy, or with what stands in for it."""


def grid(np: Any) -> Any:
    return np.array([[0.0, 3.5, -2.0], [7.0, 0.5, 4.0]])


def line(np: Any) -> Any:
    return np.array([3.0, -1.0, 2.0])


BUILT: dict[str, Build] = {
    "sums": lambda np: (1 + grid(np) * 2 - line(np)) % 3 / 4 + -(grid(np) ** 2),
    "numbers first": lambda np: 2 - line(np) / (8 / (line(np) + 0.5)),
    "columns": lambda np: grid(np)[:, 1][:, None] * line(np)[None, :],
    "division by zero": lambda np: 1.0 / np.array([2.0, 0.0, -0.0]),
    "zero by zero": lambda np: grid(np) / grid(np),
    "comparisons": lambda np: (grid(np) > 0) & (grid(np) <= 4) | (line(np) < 0) ^ (grid(np) == 7.0),
    "not": lambda np: ~(grid(np) != 0.5),
    "least and most": lambda np: np.minimum(np.maximum(grid(np), line(np)), 3.2),
    "clip": lambda np: np.clip(grid(np), -1.0, line(np) + 2),
    "roots": lambda np: np.sqrt(np.abs(grid(np))) + abs(grid(np)),
    "angles": lambda np: np.arctan2(np.sin(np.radians(grid(np))), np.cos(np.degrees(line(np)))),
    "lengths": lambda np: np.hypot(grid(np), line(np)),
    "rows": lambda np: grid(np)[1],
    "a row of a grid of grids": lambda np: np.array([grid(np), grid(np) + 1])[1],
    "an entry": lambda np: grid(np)[1, 2],
    "slices": lambda np: grid(np)[:, 1:3],
    "places": lambda np: grid(np)[np.array([1, 0, 1]), np.array([2, 2, 0])],
    "chosen": lambda np: grid(np)[grid(np) > 1],
    "none chosen": lambda np: line(np)[line(np) > 10],
    "transposed": lambda np: grid(np).T,
    "product": lambda np: grid(np).T @ np.array([[1.0, 2.0], [0.5, -1.0]]),
    "shape": lambda np: grid(np).reshape(-1, 2),
    "flat": lambda np: grid(np).ravel(),
    "whole": lambda np: np.rint(grid(np) * 1.3).astype(int),
    "where": lambda np: np.where(grid(np) > 1, line(np), 9.0),
    "where they are": lambda np: np.flatnonzero(line(np) > 0),
    "least of columns": lambda np: grid(np).min(axis=0),
    "least and its place": lambda np: np.array([grid(np).min(), grid(np).max(), grid(np).argmin(), grid(np).sum()]),
    "least of none": lambda np: np.array([line(np)[line(np) > 10].min(initial=np.inf)]),
    "any and all": lambda np: np.array([(grid(np) > 6).any(), (grid(np) > 6).all()]),
    "finite": lambda np: np.isfinite(np.array([1.0, np.inf, np.nan])) | np.isnan(np.array([1.0, np.inf, np.nan])),
    "counted": lambda np: np.arange(-2, 3) % 4,
    "decimals": lambda np: np.arange(4.0),
    "evenly": lambda np: np.linspace(0.5, 2.0, 7),
    "a single one": lambda np: np.linspace(0.5, 2.0, 1),
    "filled": lambda np: np.full((2, 2), 3.5) + np.zeros((2, 2)) + np.ones(2),
    "across and down": lambda np: np.meshgrid(np.arange(3) + 0.5, np.arange(2.0))[0],
    "neighbours": lambda np: np.convolve(line(np) > 0, np.ones(2), "valid"),
    "of many": lambda np: np.maximum.reduce([grid(np), 2 - grid(np), grid(np) * 0]),
    "or of layers": lambda np: np.logical_or.reduce(np.array([grid(np), grid(np) - 4]) > 0),
}
"""By what is tried. NumPy's warnings about division are silenced below, as they are where btlang divides."""


def changed(np: Any) -> list[Any]:
    """What is written into arrays."""
    first, layers, least = grid(np), np.zeros((2, 2, 3), dtype=bool), np.full(4, np.nan)
    first[0, :] = first[:, -1] = 0.25
    first[first > 5] *= 2.0
    window = slice(0, 2), slice(1, 3)
    first[window] = np.minimum(first[window], np.array([[1.0, 9.0], [-1.0, 9.0]]))
    layers[(1, *window)] |= first[window] > 0
    np.fmin.at(least, np.array([1, 1, 3]), np.array([4.0, 2.0, 8.0]))
    copy = first.copy()
    np.minimum(copy, 0.5, out=copy)
    return [first.tolist(), layers.tolist(), least.tolist(), copy.tolist(), first.ravel().tolist()]


@pytest.mark.parametrize("name", BUILT)
def test_arrays(name: str) -> None:
    with numpy.errstate(all="ignore"):
        real, stood_in = BUILT[name](numpy), BUILT[name](pure)
    entries = stood_in.tolist() if isinstance(stood_in, pure.ndarray) else stood_in
    assert getattr(stood_in, "shape", ()) == real.shape
    assert numpy.allclose(numpy.array(entries), real, rtol=1e-12, atol=1e-12, equal_nan=True), (entries, real)


def test_changed_arrays() -> None:
    for real, stood_in in zip(changed(numpy), changed(pure), strict=True):
        assert numpy.allclose(real, stood_in, equal_nan=True)


def test_beams_reach_as_far() -> None:
    random = Random(4)
    for name in (None, "museum", "warehouse"):
        obstacles = Obstacles(read_world(None if name is None else str(EXAMPLES / "worlds" / f"{name}.toml")))
        segments = numpy.array(obstacles.segments, dtype=float).reshape(-1, 4)
        discs = numpy.array(obstacles.discs, dtype=float).reshape(-1, 3)
        for _ in range(40):
            pose = Pose(random.uniform(0, 12), random.uniform(0, 8), random.uniform(-180, 180))
            traced = trace_beams(segments.tolist(), discs.tolist(), pose, 8.0)
            assert numpy.allclose(traced, scan(segments, discs, pose, 8.0), atol=1e-6)


@pytest.mark.long
def test_missions_end_in_the_same_way() -> None:
    """To the last decimal of the times that are said, and with the same words for what is similar."""
    names = amount(0, 1) and sorted(path.stem for path in EXAMPLES.glob("*.txt"))
    missions = [str(EXAMPLES / f"{name}.txt") for name in names or FEW]
    real = json.loads(json.dumps(found(missions)))
    stood_in = found_without_packages(missions)
    assert stood_in["near"] == real["near"]
    for mission in missions:
        assert stood_in["ends"][mission] == real["ends"][mission], mission
