"""A run over ROS 2 that is recorded: its replay equals it, status by status."""

from __future__ import annotations

import random
from functools import partial
from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.recording.bundle import files_of
from btlang.recording.recorder import Recorder
from btlang.ros.connectors import connect_ros
from btlang.run.events import Event
from btlang.session import Session
from tests.profiles import amount
from tests.recording.runs import changes, replayed

from .conftest import ROOM

COMMANDS = (
    "wave", "nod", "look left", 'say "here"', "turn left 20 degrees", "move forward 10 cm", "wait 0.3 s",
    "try to grasp the cup", 'print "{n}"', "open the left hand",
)  # fmt: skip
FRAMES = (
    "{0} then {1}", "repeat twice: {0}", "try to ({0} then {1}), otherwise {2}",
    "{0} and meanwhile wait 0.2 s then {1}",
    "if the battery is below 50%, {0}, otherwise {1}", "for at most 1 s, {0}", "try to {0} up to 2 times",
)  # fmt: skip


@pytest.fixture(autouse=True)
def _in_domain(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))


@pytest.mark.long
def test_a_replay_equals_its_run(start_sim, tmp_path: Path) -> None:
    start_sim()
    compared = 0
    with Session(partial(connect_ros, sim_time=True), world=str(ROOM)) as session:
        for number in range(amount(3, 100)):
            draw = random.Random(number)
            frames = [draw.choice(FRAMES).format(*draw.sample(COMMANDS, 3)) for _ in range(2)]
            mission = parse_tree("set n to 3\n" + "\n".join(frames), world=str(ROOM))
            path, events = tmp_path / f"{number}.mcap", list[Event]()
            recorder = Recorder(str(path), mission.label, files_of(mission, []), {})
            session.run(mission, sinks=[recorder, events.append], time_limit=20)
            recorder.close()
            assert changes(replayed(mission, path)) == changes(events)
            compared += len(changes(events))
    assert compared > 10
