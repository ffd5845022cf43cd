"""Waiting for other threads and processes that notify nobody when they are done."""

from __future__ import annotations

import time
from collections.abc import Callable

_LOOK = 0.01  # seconds between two looks


def wait_until(holds: Callable[[], object], limit: float) -> None:
    """Blocks until something holds, for so many real seconds at most. It is asked once in any case."""
    until = time.monotonic() + limit
    while not holds() and time.monotonic() < until:
        time.sleep(_LOOK)
