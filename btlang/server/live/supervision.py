"""Tasks that must not end: one that fails is begun again, and it is said."""

from __future__ import annotations

import asyncio
import sys
import time
import traceback
from collections import Counter
from collections.abc import Awaitable, Callable
from contextlib import suppress

from btlang.text.output import show

_AGAIN = 0.5  # seconds until a task is begun again
_SAID = 60.0  # seconds between two notices about the same task

restarts: Counter[str] = Counter()
"""How often each task was begun again."""


async def supervise(name: str, work: Callable[[], Awaitable[object]]) -> None:
    """Do a work until it's cancelled, again and again where it fails; `name` completes "can't ..."."""
    said = -_SAID
    while True:
        try:
            await work()
            return
        except Exception as error:
            restarts[name] += 1
            if time.monotonic() - said >= _SAID:
                said = time.monotonic()
                problem = "".join(traceback.format_exception_only(error)).strip()
                with suppress(OSError):  # nobody may read it any more
                    show(f"The server can't {name}, and tries again: {problem}", sys.stderr)
        await asyncio.sleep(_AGAIN)
