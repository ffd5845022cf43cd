"""A disk that is full: recordings make room for the tasks, and the tasks wait for it."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from btlang.task.execution.run_sinks import Recordings
from btlang.task.store.database import Outbox, StoreError, store_error


def test_recordings_make_room_on_a_full_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The oldest first, and only as many as are needed; the disk is one of 250 MB, as far as can be seen."""
    sizes = {"a.mcap": 40, "b.mcap": 60, "c.mcap": 70, "other.db": 30}
    for age, (name, size) in enumerate(sizes.items()):
        with (tmp_path / name).open("wb") as file:
            file.truncate(size * 1_000_000)
        os.utime(tmp_path / name, (1000.0 + age, 1000.0 + age))

    def usage(_: object) -> Any:
        used = sum(path.stat().st_size for path in tmp_path.iterdir())
        return SimpleNamespace(free=250_000_000 - used)

    monkeypatch.setattr("shutil.disk_usage", usage)
    recordings = Recordings(str(tmp_path))
    recordings.make_room()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.mcap", "other.db"]
    recordings.make_room()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_store_that_refuses_makes_recordings_go(tmp_path: Path) -> None:
    done: list[str] = []
    refuses = [True, True]

    def change() -> None:
        if refuses:
            refuses.pop()
            raise store_error("tasks.db", "the disk is full")
        done.append("changed")

    outbox = Outbox(done.append, lambda: done.append("room"))
    outbox.write(change)
    with pytest.raises(StoreError, match="full"):
        outbox.flush()
    outbox.flush()
    assert done[1:] == ["room", "room", "changed"]
