"""What the beams of a laser scan say."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

_TOUCHING = 0.01  # metres of an echo that is too close, where a scanner measures from 0 on


def echoes(scan: Any) -> npt.NDArray[np.float64]:
    """The metres of each beam by REP 117: inf where nothing is in range, NaN where it says nothing.

    What is too close to be measured, -inf, is as near as the scanner can measure. One that does not say how far it
    sees, with a `range_max` of 0, sees as far as its echoes are.
    """
    ranges = np.array(scan.ranges, dtype=np.float64)
    close = ranges == -np.inf
    if scan.range_max > scan.range_min:
        ranges[ranges > scan.range_max] = np.inf
    ranges[~(ranges >= scan.range_min) | (ranges <= 0.0)] = np.nan
    ranges[close] = max(scan.range_min, _TOUCHING)
    return ranges
