"""Recorded runs for tests."""

from __future__ import annotations

from pathlib import Path

from btlang.api import Mission, parse_tree
from btlang.engine.compile import outline
from btlang.recording.bundle import files_of
from btlang.recording.reader import RecordedNodes, read_recording
from btlang.recording.recorder import Recorder
from btlang.run.events import Event, StatusesChanged
from btlang.session import Session
from btlang.text.source import Source

Changes = list[tuple[float, int, int, int, str]]


def recorded(
    text: str, path: Path, seed: int = 7, most_bytes: int | None = None, world: Source | None = None
) -> tuple[Mission, list[Event]]:
    """Runs a mission as fast as possible with a recording; the events that another sink got."""
    mission = parse_tree(text, world=world)
    events: list[Event] = []
    files = files_of(mission, [])
    recorder = Recorder(str(path), mission.label, files, {"seed": str(seed), "rate": "20"}, most_bytes)
    with Session(world=world) as session:
        run = session.run(mission, speed="max", sinks=[recorder, events.append], seed=seed, time_limit=120)
    recorder.close()
    assert run.sink_errors == []
    return mission, events


def changes(events: list[Event]) -> Changes:
    """Each change of status, with all that is known of it."""
    return [
        (event.t, *change) for event in events if isinstance(event, StatusesChanged) for change in event.without_paths()
    ]


def replayed(mission: Mission, path: Path) -> list[Event]:
    """The events of a recording."""
    return list(read_recording(str(path)).events(RecordedNodes(*outline(mission.tree))))
