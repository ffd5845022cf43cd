"""The recordings of tasks, in a folder that doesn't grow without end."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress

from btlang.api import Mission
from btlang.diagnostics.errors import MissionError
from btlang.recording.recorder import Recorder, recorder_in

MOST_BYTES = 1_000_000_000
"""Of all recordings together; the oldest go first."""
_FREE = 100_000_000  # bytes of the disk that recordings leave to others
_EACH = 200_000_000  # bytes of one, which then goes on in another file


class Recordings:
    """A recorder for each task, in `folder`; none if the package mcap isn't installed or the folder can't be written,
    which `trouble` gets once.
    """

    def __init__(
        self, folder: str, trouble: Callable[[str], object] = lambda text: None, most_bytes: int = MOST_BYTES
    ) -> None:
        self._folder, self._trouble, self._most = folder, trouble, most_bytes
        self.problem = ""
        """Why there are no recordings, "" if there are."""
        self._latest: Recorder | None = None

    def recorder(self, mission: Mission, task: int) -> Recorder | None:
        """For a run of a task that begins now, until `end`."""
        self.make_room()
        try:
            recorder = recorder_in(self._folder, mission, (), {"task": str(task)}, _EACH)
        except MissionError as error:
            if not self.problem:
                self._trouble(str(error))
            self.problem = error.diagnostics[0].message
            return None
        self.problem, self._latest = "", recorder
        return recorder

    def end(self) -> None:
        """The run is over: closes its file."""
        if self._latest is not None:
            self._latest.close()
            self._latest = None

    def make_room(self) -> None:
        """Removes the oldest recordings while all together are too many, or the disk is nearly full; never the one
        that goes on.
        """
        found: list[tuple[float, int, str]] = []
        with suppress(OSError):
            for entry in os.scandir(self._folder):
                if entry.name.endswith(".mcap") and not self._goes_on(entry.path):
                    status = entry.stat()
                    found.append((status.st_mtime, status.st_size, entry.path))
        total = sum(size for _, size, _ in found)
        for _, size, path in sorted(found):
            if total <= self._most - _EACH and _free(self._folder) >= _FREE:
                break
            with suppress(OSError):
                os.remove(path)
            total -= size

    def _goes_on(self, path: str) -> bool:
        latest = self._latest
        return latest is not None and os.path.abspath(path).startswith(
            os.path.splitext(os.path.abspath(latest.path))[0]
        )


def _free(folder: str) -> int:
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return _FREE
