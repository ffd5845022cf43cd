"""How far a scan shows the way to be free: the corridor that a round robot sweeps when it drives straight on."""

from __future__ import annotations

from functools import cache
from math import inf, nan

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_ANGLES = np.radians(np.arange(-90.0, 91.0))
_COS, _SIN = np.cos(_ANGLES), np.sin(_ANGLES)
_SIDES = 25  # degrees to both sides that beams must cover: the corridor from 0.3 m before the rim on
_GAP = 6  # degrees in a row that no beam covers; less hides nothing that matters, and scanners miss beams now and then


def free_way(ranges: Array, direction: float, radius: float, view: float = 360.0) -> float:
    """Return the metres that a robot of this radius can drive in a direction until it touches something.

    NaN if beams don't cover that direction, inf if nothing is in range. `ranges` are those of ScanReading, the
    direction is in degrees left of ahead. The scanner looks `view` degrees wide around it.
    """
    beams = ranges[_beams(round(direction) % 360)]
    seen = np.isfinite(beams)
    across, along = beams[seen] * _SIN[seen], beams[seen] * _COS[seen]
    touching = np.abs(across) < radius
    if touching.any():
        beside = across[touching]
        nearest = max(0.0, float((along[touching] - np.sqrt(radius * radius - beside * beside)).min()))
    else:
        nearest = inf
    return nearest if _are_covered(beams, view) else nan


def is_covered(ranges: Array, direction: float, view: float = 360.0) -> bool:
    """Return whether valid beams look in a direction, in degrees left of ahead, so that it can be clear."""
    return _are_covered(ranges[_beams(round(direction) % 360)], view)


@cache
def _beams(direction: int) -> npt.NDArray[np.int64]:
    return (direction + np.arange(-90, 91)) % 360


def _are_covered(beams: Array, view: float) -> bool:
    sides = max(0, min(_SIDES, int(view / 2) - 1))
    unseen = np.isnan(beams[90 - sides : 91 + sides])
    gap = min(_GAP, len(unseen))
    return not unseen.any() or bool(np.convolve(unseen, np.ones(gap), "valid").max() < gap - 0.5)
