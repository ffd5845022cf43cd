"""What the beams of a laser scan say."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

_TOUCHING = 0.01  # metres of an echo that is too close, where a scanner measures from 0 on


def echoes(scan: Any) -> npt.NDArray[np.float64]:
    """The metres of each beam by REP 117: inf where nothing is in range, NaN where it says nothing.

    What is too close to be measured, -inf, is as near as the scanner can measure.
    """
    ranges = np.array(scan.ranges, dtype=np.float64)
    low, high = scan.range_min, scan.range_max
    close = ranges == -np.inf
    ranges[ranges > high] = np.inf
    ranges[~(ranges >= low) | (ranges <= 0.0) | (not high > low)] = np.nan
    ranges[close] = max(low, _TOUCHING) if high > low else np.nan
    return ranges
