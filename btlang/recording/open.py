"""Opens recordings: their events, with the mission that they belong to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from btlang.api import Mission
from btlang.engine.compile import outline
from btlang.recording.bundle import open_mission
from btlang.recording.reader import RecordedNodes, Recording, read_recording

_MAGIC = b"\x89MCAP0\r\n"


def is_recording(path: str) -> bool:
    """Return whether the file begins as a recording does."""
    try:
        with open(path, "rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except OSError:
        return False


@contextmanager
def open_recording(
    path: str, keywords: Sequence[str] | None = None
) -> Iterator[tuple[Recording, Mission, RecordedNodes]]:
    """Give a recording, its mission and the nodes of that; with `keywords` the mission may be run.

    Raises MissionError.
    """
    recording = read_recording(path)
    name, language = recording.about.get("mission", "a mission"), recording.about.get("language", "en")
    with open_mission(recording.files, name, language, keywords) as mission:
        yield recording, mission, RecordedNodes(*outline(mission.tree))
