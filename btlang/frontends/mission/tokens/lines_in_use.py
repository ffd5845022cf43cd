"""The lines that were read before and with which a thread reads texts; most read without any, and import no more."""

from __future__ import annotations

from _thread import _local  # `threading` and `contextvars` take longer to import

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class _InUse(_local):
    memo: Any = None


in_use = _InUse()
"""Its `memo` is the LineMemo with which the thread reads, if there is one."""
