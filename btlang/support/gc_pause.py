"""Pauses Python's search for garbage in cycles while much is made and little of it thrown away."""

from __future__ import annotations

import gc
from _thread import allocate_lock  # `threading` takes longer to import

_MANY = 50_000  # objects that were made in a pause; of fewer the search is short, and counting frozen ones isn't
_LOOK_AFTER = 1_000_000  # objects that were made in pauses: garbage in cycles among them has to go, too


class _Pause:
    """A pause that lasts until the last of those that asked for it is done, in whatever thread; then Python collects as
    before.
    """

    def __init__(self) -> None:
        self._lock = allocate_lock()
        self._users = 0
        self._was_enabled = False
        self._made = 0

    def __enter__(self) -> None:
        with self._lock:
            if self._users == 0:
                self._was_enabled = gc.isenabled()
                gc.disable()
            self._users += 1

    def __exit__(self, *_error: object) -> None:
        with self._lock:
            self._users -= 1
            if self._users or not self._was_enabled:
                return
            is_due, made = False, gc.get_count()[0]
            if made > _MANY and not gc.get_freeze_count():  # else somebody's frozen objects would thaw
                is_due = self._made > max(_LOOK_AFTER, 2 * made)  # of what is just made little is garbage
                self._made = 0 if is_due else self._made + made
                gc.freeze()
                gc.unfreeze()  # makes all objects old ones: else Python looks at once through what was made
            gc.enable()
        if is_due:
            gc.collect()


gc_paused = _Pause()
"""A pause of Python's search for garbage: `with gc_paused:` makes a long mission compile in half the time, and the time
of a line no longer grows.
"""
