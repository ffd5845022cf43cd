"""The recording of the latest run, for `btc why`, `btc replay` and `btc watch` when they get no file."""

from __future__ import annotations

import os
from contextlib import suppress

from btlang.recording.recorder import Recorder
from btlang.run.bus import BLOCK
from btlang.support.user_dirs import user_dir

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Event

PART_BYTES = 200_000_000
"""The size of an unasked recording. A longer run goes on in the next file, and the file before is removed."""


def latest_recording() -> str:
    """Return the path of the recording that began last, "" if there's none or its file is gone."""
    with suppress(OSError), open(_pointer(), encoding="utf-8", errors="surrogateescape") as file:
        path = file.read()
        return path if os.path.isfile(path) else ""
    return ""


def note_latest(path: str) -> None:
    """Keep the path of a recording that begins now, and remove unasked recordings of earlier runs."""
    path, folder = os.path.abspath(path), _folder()
    with suppress(OSError):
        os.makedirs(folder, mode=0o700, exist_ok=True)
        new = f"{_pointer()}.{os.getpid()}"
        with open(new, "w", encoding="utf-8", errors="surrogateescape") as file:
            file.write(path)
        os.replace(new, _pointer())
        for name in os.listdir(folder):
            other = os.path.join(folder, name)
            if name.endswith(".mcap") and other != path:
                with suppress(OSError):  # Windows keeps a file that another run still writes
                    os.remove(other)


def unasked_path() -> str:
    """Return the path for the recording of a run that begins now. Raises OSError if its folder can't be made."""
    os.makedirs(_folder(), mode=0o700, exist_ok=True)
    return os.path.join(_folder(), f"run-{os.urandom(4).hex()}.mcap")


class UnaskedRecording:
    """A sink that records a run as long as it can: nobody asked for it, so a full disk is no error."""

    policy = BLOCK

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder

    def __call__(self, event: Event) -> None:
        """Write an event."""
        if not self._recorder.is_broken:
            with suppress(OSError):
                self._recorder(event)


def _folder() -> str:
    return os.path.join(user_dir("state"), "latest_run")


def _pointer() -> str:
    return os.path.join(_folder(), "path")
