"""The emergency stop of a robot with a task layer: a path of its own, and a latch that survives a restart."""

from __future__ import annotations

import json
import os
import threading
import time
from collections.abc import Callable
from contextlib import suppress

_SIZE = 512
"""Bytes of the file: it is written over in place, which a full disk doesn't keep anybody from."""
_AGAIN = 1.0  # seconds after which a file that couldn't be written is tried again


class EmergencyStop:
    """`stop` may be called from any thread: it sets a flag, stops the robot by `halt`, and is done. It takes no lock,
    and waits for nothing: what keeps the latch in the file at `path` is another thread.

    A file that can't be read counts as latched: nobody knows whether it was.
    """

    def __init__(self, path: str, halt: Callable[[], object]) -> None:
        self._path, self._halt = path, halt
        self.reason = _read(path)
        """Why the robot is stopped, "" if it isn't."""
        self.stops: list[str] = []
        """The reasons of all stops of this process: one may be released before anybody has taken notice of it."""
        self.listeners: list[Callable[[], object]] = []
        """Called a moment after a stop or a release, in another thread."""
        self._kept = self.reason
        self._changed = threading.Event()
        self._writing = threading.Lock()  # which `stop` doesn't take
        self._closed = False
        if not os.path.exists(path):
            _write(path, "")
        self._thread = threading.Thread(target=self._keep, name="btlang emergency latch", daemon=True)
        self._thread.start()

    @property
    def is_latched(self) -> bool:
        """Whether nothing may move the robot."""
        return bool(self.reason)

    def stop(self, person: str, reason: str = "") -> None:
        """Stops the robot for a person; nothing begins before `release`."""
        reason = f"emergency stop by {person or 'somebody'}" + (f": {reason}" if reason else "")
        self.stops.append(reason)
        self.reason = reason  # before the robot stops, so that nothing begins once it has
        self._halt()
        self._changed.set()

    def release(self) -> None:
        """Opens the latch. Raises OSError if the file can't be written: then it stays shut."""
        with self._writing:
            _write(self._path, "")
            self._kept = self.reason = ""
        self._changed.set()

    def close(self) -> None:
        """Waits until the file has what it should have, a second at most."""
        self._closed = True
        self._changed.set()
        self._thread.join(_AGAIN)

    def _keep(self) -> None:
        while not self._closed or self._kept != self.reason:
            self._changed.wait(None if self._kept == self.reason else _AGAIN)
            self._changed.clear()
            for listener in self.listeners:
                listener()
            with self._writing, suppress(OSError):
                reason = self.reason
                if reason and reason != self._kept:
                    _write(self._path, reason)
                    self._kept = reason


def _write(path: str, reason: str) -> None:
    data = json.dumps({"reason": reason[: _SIZE // 8], "time": time.time()}).encode().ljust(_SIZE)
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT, 0o600)
    try:
        os.pwrite(descriptor, data, 0)
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _read(path: str) -> str:
    try:
        with open(path, "rb") as file:
            reason = json.loads(file.read())["reason"]
    except FileNotFoundError:
        return ""
    except (OSError, ValueError, KeyError, TypeError):
        return "its latch can't be read"
    return reason if isinstance(reason, str) else "its latch can't be read"
