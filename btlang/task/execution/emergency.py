"""The emergency stop of a robot with a task layer: a path of its own, and a latch that survives a restart."""

from __future__ import annotations

import json
import os
import stat
import threading
import time
from collections.abc import Callable
from contextlib import suppress

_SIZE = 512
"""The bytes of the file: it is written over in place, which a full disk doesn't keep anybody from."""
_UNREADABLE = "its latch can't be read"
_OWN = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # nobody leads it to another file, or makes it wait
_AGAIN = 1.0  # seconds after which a file that couldn't be written is tried again
_LOOK = 0.2  # seconds between two looks whether somebody has shut the latch by its file, where nothing else was left


def latch_path(folder: str) -> str:
    """Return the file of the latch, in the folder of a robot."""
    return os.path.join(folder, "emergency_stop")


def shut_latch(folder: str, person: str, reason: str = "") -> None:
    """Stop a robot by its file alone, in a moment if its process is alive, else from its next start on, until it is
    released. Raises OSError.
    """
    _write(latch_path(folder), _reason(person, reason))


class EmergencyLatch:
    """The emergency stop of a robot, and its latch.

    `stop` may be called from any thread: it sets a flag, stops the robot by `halt`, and is done. It takes no lock, and
    waits for nothing: what keeps the latch in the file at `path` is another thread, which also looks whether somebody
    else has shut it there.

    A file that can't be read counts as latched: nobody knows whether it was.
    """

    def __init__(self, path: str, halt: Callable[[], object]) -> None:
        self._path, self._halt = path, halt
        self.reason = _read(path)
        """The reason why the robot is stopped, "" if it isn't."""
        self.stops: list[str] = []
        """The reasons of all stops of this process: one may be released before anybody has taken notice of it."""
        self.listeners: list[Callable[[], object]] = []
        """The functions to call a moment after a stop or a release, in another thread."""
        self._kept = self.reason
        self._changed = threading.Event()
        self._writing = threading.Lock()  # which `stop` doesn't take
        self._closed = False
        if not os.path.lexists(path):
            _write(path, "")
        self._seen = _change_time(path)
        self._thread = threading.Thread(target=self._keep, name="btlang emergency latch", daemon=True)
        self._thread.start()

    @property
    def is_latched(self) -> bool:
        """Whether the latch is shut, so that nothing may move the robot."""
        return bool(self.reason)

    def stop(self, person: str, reason: str = "") -> None:
        """Stop the robot for a person; nothing begins before `release`."""
        self._stop(_reason(person, reason))
        self._changed.set()

    def release(self) -> None:
        """Open the latch. Raises OSError if the file can't be written: then it stays shut."""
        with self._writing:
            _write(self._path, "")
            self._seen = _change_time(self._path)
            self._kept = self.reason = ""
        self._changed.set()

    def close(self) -> None:
        """Wait until the file has what it should have, a second at most."""
        self._closed = True
        self._changed.set()
        self._thread.join(_AGAIN)

    def _stop(self, reason: str) -> None:
        self.stops.append(reason)
        self.reason = reason  # before the robot stops, so that nothing begins once it has
        self._halt()

    def _keep(self) -> None:
        while not self._closed or self._kept != self.reason:
            came = self._changed.wait(_LOOK if self._kept == self.reason else _AGAIN)
            self._changed.clear()
            with self._writing, suppress(OSError):
                seen = _change_time(self._path)
                if seen != self._seen and not self.reason:
                    self._seen, self._kept = seen, _read(self._path)
                    if self._kept:
                        self._stop(self._kept)
                        came = True
                reason = self.reason
                if reason and reason != self._kept:
                    _write(self._path, reason)
                    self._seen, self._kept = _change_time(self._path), reason
            for listener in self.listeners if came else ():
                listener()


def _reason(person: str, reason: str) -> str:
    return f"emergency stop by {person or 'somebody'}" + (f": {reason}" if reason else "")


def _change_time(path: str) -> int:
    """Return when the file was written last, 0 if there is none."""
    try:
        return os.lstat(path).st_mtime_ns
    except OSError:
        return 0


def _write(path: str, reason: str) -> None:
    data = json.dumps({"reason": reason[: _SIZE // 8], "time": time.time()}).encode().ljust(_SIZE)
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | _OWN, 0o600)
    try:
        os.pwrite(descriptor, data, 0)
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _read(path: str) -> str:
    try:
        descriptor = os.open(path, os.O_RDONLY | _OWN)
        with open(descriptor, "rb") as file:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                return _UNREADABLE
            reason = json.loads(file.read(_SIZE))["reason"]
    except FileNotFoundError:
        return ""
    except (OSError, ValueError, KeyError, TypeError):
        return _UNREADABLE
    return reason if isinstance(reason, str) else _UNREADABLE
