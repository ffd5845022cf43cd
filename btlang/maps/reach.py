"""The cells of a map that can be reached from others."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable

import numpy as np

from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

    Cells = npt.NDArray[np.bool_]

_MOST_RUNS = 1_000_000  # of free cells in a row; joining so many takes seconds


def reached(free: Cells, seeds: Iterable[tuple[int, int]]) -> Cells:
    """Return the free cells that are joined by their sides to one of the seeds, each given as (column, row).

    Seeds that aren't free reach nothing. Raises Problem for a map with too much detail.
    """
    height, width = free.shape
    steps = np.diff(np.pad(free, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = (found.tolist() for found in np.nonzero(steps == 1))
    ends = np.nonzero(steps == -1)[1].tolist()
    if len(rows) > _MOST_RUNS:
        raise Problem(f"the map has too much detail: {len(rows):,} stretches of free cells, at most {_MOST_RUNS:,}")
    firsts = np.searchsorted(np.array(rows, dtype=np.int64), np.arange(height + 1)).tolist()
    seen = bytearray(len(rows))
    left = [run for column, row in seeds if (run := _run_at(column, row, free, ends, firsts)) is not None]
    while left:
        run = left.pop()
        if seen[run]:
            continue
        seen[run] = True
        for row in (rows[run] - 1, rows[run] + 1):
            if not 0 <= row < height:
                continue
            other, last = bisect_right(ends, starts[run], firsts[row], firsts[row + 1]), firsts[row + 1]
            while other < last and starts[other] < ends[run]:
                left.append(other)
                other += 1
    kept = np.frombuffer(seen, dtype=bool)
    marks = np.zeros((height, width + 1), dtype=np.int8)
    for sign, columns in ((1, starts), (-1, ends)):
        marks[np.array(rows, dtype=np.int64)[kept], np.array(columns, dtype=np.int64)[kept]] += sign
    return np.cumsum(marks, axis=1, dtype=np.int8)[:, :width].astype(bool)


def _run_at(column: int, row: int, free: Cells, ends: list[int], firsts: list[int]) -> int | None:
    if not (0 <= row < free.shape[0] and 0 <= column < free.shape[1]) or not free[row, column]:
        return None
    return bisect_right(ends, column, firsts[row], firsts[row + 1])
