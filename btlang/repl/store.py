"""What outlives the REPL: the history of what was typed, and each draft as it is at every moment."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

from btlang.diagnostics.files import os_error_reason
from btlang.support.record import Record
from btlang.support.user_dirs import user_dir

try:
    import fcntl
except ImportError:  # not on Windows, where sessions of running processes are offered too
    fcntl = None  # type: ignore[assignment]

_MOST_KEPT = 20  # sessions; older ones are deleted


class SavedDraft(Record):
    """A draft of a process that is gone: its entries, what was being typed, and the world that it was for."""

    entries: tuple[str, ...]
    draft: str
    world: str | None
    path: Path


def state_folder() -> Path:
    """Return the platform's folder for such things, $XDG_STATE_HOME/btlang on Linux."""
    return Path(user_dir("state"))


class DraftStore:
    """A folder with the file `history` and a file for each draft; None keeps nothing.

    A folder that cannot be written to is no error: `problem` says why nothing is kept.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder or Path()
        # the number alone would not do: in a container every process may have the same
        self._own = self._folder / "sessions" / f"{time.time_ns()}-{os.getpid()}.json"
        self._held: int | None = None
        self.problem = "" if folder else "no folder"
        if folder is None:
            return
        try:
            self._own.parent.mkdir(parents=True, exist_ok=True)
            self.history.touch()
            self._folder.chmod(0o700)  # what people type to their robots is private
            self.history.chmod(0o600)
            self._held = _lock(self._own)
            self.save([], "")
        except OSError as error:
            self.problem = f"{self._folder}: {os_error_reason(error)}"

    def __del__(self) -> None:
        if self._held is not None:
            os.close(self._held)

    @property
    def history(self) -> Path:
        """The history of what was typed in all sessions, in the format of prompt_toolkit's FileHistory."""
        return self._folder / "history"

    def save(self, entries: list[str], draft: str, world: str | None = None) -> None:
        """Save the present state of this draft, in its file before this returns: it outlives a kill at any moment."""
        if self.problem:
            return
        state = {"entries": entries, "draft": draft, "world": world and os.path.abspath(world)}
        try:
            new = self._own.with_suffix(".new")
            new.touch(mode=0o600)
            new.write_text(json.dumps(state), encoding="ascii")
            os.replace(new, self._own)
        except OSError as error:
            self.problem = f"{self._own}: {os_error_reason(error)}"

    def forget(self) -> None:
        """Delete this session's files: all of it has been saved elsewhere, or there is nothing in it."""
        if not self.problem:
            _delete(self._own)

    def left(self) -> SavedDraft | None:
        """Return the latest draft that was left with something in it."""
        kept = []
        for path in self._files():
            if path == self._own or not _is_left(path):
                continue
            draft = _read(path)
            if draft is None:
                _delete(path)
            else:
                kept.append(draft)
        for old in kept[_MOST_KEPT:]:
            _delete(old.path)
        return kept[0] if kept else None

    def _files(self) -> list[Path]:
        try:
            return sorted(self._own.parent.glob("*.json"), key=lambda path: path.stat().st_mtime, reverse=True)
        except OSError:
            return []

    def done_with(self, kept: SavedDraft) -> None:
        """Forget a draft that was taken up again: it is no longer kept by itself."""
        _delete(kept.path)


def _read(path: Path) -> SavedDraft | None:
    """Read a draft; None where it is empty or not readable."""
    try:
        state = json.loads(path.read_text(encoding="ascii"))
        entries, draft, world = tuple(map(str, state["entries"])), str(state["draft"]), state.get("world")
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return SavedDraft(entries, draft, world and str(world), path) if entries or draft.strip() else None


def _delete(path: Path) -> None:
    path.unlink(missing_ok=True)
    path.with_suffix(".lock").unlink(missing_ok=True)


def _lock(path: Path) -> int | None:
    """Return the open lock of a draft, which ends with its process; None where one that still runs holds it."""
    lock = os.open(path.with_suffix(".lock"), os.O_CREAT | os.O_WRONLY, 0o600)
    if fcntl is not None:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(lock)
            return None
    return lock


def _is_left(path: Path) -> bool:
    lock = _lock(path)
    if lock is not None:
        os.close(lock)
    return lock is not None
