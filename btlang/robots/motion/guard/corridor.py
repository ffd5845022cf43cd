"""How far a scan shows the way to be free: the corridor that a round robot sweeps when it drives straight on."""

from __future__ import annotations

from functools import cache
from math import inf, nan

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_ANGLES = np.radians(np.arange(-90.0, 91.0))
_COS, _SIN = np.cos(_ANGLES), np.sin(_ANGLES)
_WINDOW = slice(65, 116)  # degrees to both sides that beams must cover: the corridor from 0.3 m before the rim on
_GAP = 6  # degrees in a row that no beam covers; less hides nothing that matters, and scanners miss beams now and then


def free_way(ranges: Array, direction: float, radius: float, wide: float = 0.0) -> float:
    """Metres that a robot of this radius can drive in a direction before it touches something; NaN where beams don't
    cover that direction, inf where nothing is in range.

    `ranges` are those of btlang.robots.motion.guard.readings.ScanReading, the direction is in degrees left of ahead.
    The corridor is `wide` metres wider than the robot on each side.
    """
    beams = ranges[_beams(round(direction) % 360)]
    seen = np.isfinite(beams)
    echoes, half = beams[seen], radius + wide
    across, along = echoes * _SIN[seen], echoes * _COS[seen]
    touching = np.abs(across) < half
    if touching.any():
        beside = np.minimum(np.abs(across[touching]), radius)
        nearest = max(0.0, float((along[touching] - np.sqrt(radius * radius - beside * beside)).min()))
    else:
        nearest = inf
    return nearest if _are_covered(beams) else nan


def is_covered(ranges: Array, direction: float) -> bool:
    """Whether valid beams look in a direction, in degrees left of ahead, so that it can be clear."""
    return _are_covered(ranges[_beams(round(direction) % 360)])


@cache
def _beams(direction: int) -> npt.NDArray[np.int64]:
    return (direction + np.arange(-90, 91)) % 360


def _are_covered(beams: Array) -> bool:
    unseen = np.isnan(beams[_WINDOW])
    return not unseen.any() or bool(np.convolve(unseen, np.ones(_GAP), "valid").max() < _GAP - 0.5)
