"""What outlives the REPL: the history of what was typed, and each session as it is at every moment."""

from __future__ import annotations

import json
import os
from pathlib import Path

from btlang.record import Record

_MOST_KEPT = 20  # sessions; older ones are deleted


class Kept(Record):
    """A session of a process that is gone: the texts of its entries, and what was being typed."""

    entries: tuple[str, ...]
    draft: str
    path: Path


def state_folder() -> Path:
    """The platform's folder for such things, $XDG_STATE_HOME/btlang on Linux."""
    from platformdirs import user_state_path

    return user_state_path("btlang")


class Store:
    """A folder with the file `history` and a file for each session; None keeps nothing.

    A folder that cannot be written to is no error: `problem` says why nothing is kept.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder or Path()
        self._own = self._folder / "sessions" / f"{os.getpid()}.json"
        self.problem = "" if folder else "no folder"
        if folder is None:
            return
        try:
            self._own.parent.mkdir(parents=True, exist_ok=True)
            self.history.touch()
            self._write({"entries": [], "draft": ""})
        except OSError as error:
            self.problem = f"{self._folder}: {(error.strerror or str(error)).lower()}"

    @property
    def history(self) -> Path:
        """What was typed in all sessions, in the format of prompt_toolkit's FileHistory."""
        return self._folder / "history"

    def save(self, entries: list[str], draft: str) -> None:
        """The present state of this session, in its file before this returns: it outlives a kill at any moment."""
        if not self.problem:
            try:
                self._write({"entries": entries, "draft": draft})
            except OSError as error:
                self.problem = f"{self._own}: {(error.strerror or str(error)).lower()}"

    def forget(self) -> None:
        """Deletes this session's file: all of it has been saved elsewhere, or there is nothing in it."""
        if not self.problem:
            self._own.unlink(missing_ok=True)

    def left(self) -> Kept | None:
        """The latest session that was left with something in it."""
        kept = []
        for path in self._files():
            if _is_alive(path):
                continue
            session = _read(path)
            if session is None:
                path.unlink(missing_ok=True)
            else:
                kept.append(session)
        for old in kept[_MOST_KEPT:]:
            old.path.unlink(missing_ok=True)
        return kept[0] if kept else None

    def _files(self) -> list[Path]:
        try:
            return sorted(self._own.parent.glob("*.json"), key=lambda path: path.stat().st_mtime, reverse=True)
        except OSError:
            return []

    def _write(self, state: dict[str, object]) -> None:
        new = self._own.with_suffix(".new")
        new.write_text(json.dumps(state), encoding="ascii")
        os.replace(new, self._own)


def _read(path: Path) -> Kept | None:
    """None where the session is empty or not readable."""
    try:
        state = json.loads(path.read_text(encoding="ascii"))
        entries, draft = tuple(map(str, state["entries"])), str(state["draft"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return Kept(entries, draft, path) if entries or draft.strip() else None


def _is_alive(path: Path) -> bool:
    """Whether the process that a session is named after still runs."""
    try:
        os.kill(int(path.stem), 0)
    except (ValueError, OverflowError, ProcessLookupError):
        return False
    except PermissionError:
        return True
    return True
