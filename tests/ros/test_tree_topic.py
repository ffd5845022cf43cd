"""The tree of a run as a topic: what programs get that join late."""

from __future__ import annotations

import itertools
import json
from types import SimpleNamespace
from typing import Any

import pytest

import btlang
from btlang.ros.mission.progress import MissionProgress, RunUpdate, TreeTopic
from btlang.run.bus import INLINE


@pytest.mark.parametrize("pause", [0.01, 0.05, 0.3, 2.0])
def test_the_last_snapshot_has_the_last_statuses(pause: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where a snapshot has just been taken when the run ends; `pause` are seconds between two looks."""
    looks = itertools.count()
    clock = SimpleNamespace(monotonic=lambda: next(looks) * pause)
    monkeypatch.setattr("btlang.ros.mission.progress.time", clock)
    snapshots: list[str] = []
    changes: list[str] = []
    with btlang.Session() as session:
        topics: list[Any] = []

        class Sink:
            policy = INLINE

            def __call__(self, event: Any) -> None:
                topics[0](event)

        mission = btlang.parse_tree("repeat 3 times: nod then print hello")
        run = session.prepare(mission, speed="max", sinks=[Sink()])
        tree = TreeTopic(mission, run, snapshots.append, changes.append)

        def reached(news: RunUpdate) -> None:
            tree.publish_snapshot(news, is_last=news.is_last)

        topics.append(MissionProgress(run.snapshot, tree.publish_changes, reached))
        assert run.execute().succeeded
    known: dict[str, str] = {}
    for change in map(json.loads, changes):
        known |= change["changes"]
    last = json.loads(snapshots[-1])
    assert last["statuses"] == known
    assert known["/"] == "SUCCESS"
    assert last["sequence"] == len(changes)
