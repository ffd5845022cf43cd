"""What a recording has is what happened, whatever becomes of the process, the disk and the file."""

from __future__ import annotations

import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given, reject
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.recording.channels import THINGS
from btlang.recording.reader import read_recording
from btlang.run.events import Ended, PeriodPassed, Said, Sampled
from btlang.text.source import Source
from tests.profiles import amount, searches
from tests.recording.runs import changes, recorded, replayed
from tests.world.worlds import LIVELY

ROUND = """
set visits to 0
for each place in the lab, the hall:
  go to the place
  increase visits by 1
  say "I am at {place}"
try to grasp the cup, otherwise say "no cup"
go to a random place
"""
DRIVE = "repeat 50 times: go to the lab then go to the kitchen"


def test_replay_has_each_status_with_its_reason_and_time(tmp_path: Path) -> None:
    mission, events = recorded(ROUND, tmp_path / "run.mcap")
    again = replayed(mission, tmp_path / "run.mcap")
    assert changes(again) == changes(events)
    assert [event.text for event in again if isinstance(event, Said)] == ["I am at lab", "I am at hall", "no cup"]
    ended, known = (next(event for event in found if isinstance(event, Ended)) for found in (again, events))
    assert (ended.outcome, ended.seconds, ended.path) == (known.outcome, round(known.seconds, 6), known.path)


def test_the_robot_and_the_values_are_there_at_each_moment(tmp_path: Path) -> None:
    mission, events = recorded(ROUND, tmp_path / "run.mcap")
    again = replayed(mission, tmp_path / "run.mcap")
    states = [[(e.t, e.ticks, e.state) for e in found if isinstance(e, PeriodPassed)] for found in (again, events)]
    assert states[0] == states[1]
    assert len(states[0]) > 100


def test_people_are_there_at_each_moment_and_kept_only_where_they_change(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    mission, events = recorded("wait 10 s then close the door", path, world=Source(LIVELY, "lively.toml"))
    states = [e.state for e in events if isinstance(e, PeriodPassed)]
    assert [e.state for e in replayed(mission, path) if isinstance(e, PeriodPassed)] == states
    with path.open("rb") as file:
        data = [
            json.loads(m.data) for _, channel, m in make_reader(file).iter_messages() if channel.topic == THINGS.topic
        ]
    assert data[0]["things"] == [["cup", 8.5, 3.6, False], ["Vera", None, None, False]]
    assert [name for each in data[1:] for name, *_ in each["things"] if name != "Vera"] == ["cup"]  # seen at the door
    assert len(data) < len(states)


def test_values_and_scans_are_sampled(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.mcap"
    assert main(["run", "-c", ROUND, "--speed", "max", "--quiet", "--record", str(path)]) == 0
    mission = btlang.parse_tree(ROUND)
    samples = [event for event in replayed(mission, path) if isinstance(event, Sampled)]
    assert [sample.values["visits"] for sample in samples if "visits" in sample.values] == [0, 1, 2]
    with path.open("rb") as file:
        scans = [message for _, channel, message in make_reader(file).iter_messages() if channel.topic == "/robot/scan"]
    assert len(json.loads(scans[0].data)["ranges"]) == 360
    seconds = (scans[-1].log_time - scans[0].log_time) / 1e9
    assert len(scans) == pytest.approx(2 * seconds, rel=0.1)
    assert capsys.readouterr().out == ""


def test_messages_fit_their_schemas_and_foxglove_knows_those_that_it_can(tmp_path: Path) -> None:
    recorded(ROUND, tmp_path / "run.mcap")
    names: Counter[str] = Counter()
    with (tmp_path / "run.mcap").open("rb") as file:
        for schema, _, message in make_reader(file).iter_messages():
            assert schema is not None
            names[schema.name] += 1
            if names[schema.name] <= 20:
                jsonschema.validate(json.loads(message.data), json.loads(schema.data))
    assert names.keys() >= {
        "foxglove.PoseInFrame",
        "foxglove.Log",
        "btlang.StatusesChanged",
        "btlang.Said",
        "btlang.Ended",
    }


_LEAVES = st.sampled_from(
    ["nod", "wave", "say hello", "wait 0.3 s", "fail", "do nothing", "check bumped", "go to the lab"]
)
_FORMS = (
    "({} then {})", "({} and {})", "({} or {})", "({}) twice", "(try {})", "(({}) within 1 s)", "(({}) for 1 s)",
    "(if bumped, {} otherwise {})", "(({}) but stop when bumped)", "(retry ({}) 2 times)", "(({}) every 0.5 s for 2 s)",
)  # fmt: skip
missions = st.recursive(
    _LEAVES, lambda inner: st.builds(str.format, st.sampled_from(_FORMS), inner, inner), max_leaves=6
)


@searches(10, 1000, deadline=None)
@given(missions)
def test_replay_equals_the_run_status_by_status(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.mcap")
        try:
            mission, events = recorded(text, path)
        except MissionError:
            reject()  # two commands need the same part of the robot
        assert changes(replayed(mission, path)) == changes(events)


@pytest.mark.long
def test_a_run_that_is_killed_leaves_all_but_its_last_moment(tmp_path: Path) -> None:
    for number in range(amount(2, 50)):
        path = tmp_path / f"{number}.mcap"
        command = [sys.executable, "-m", "btlang", "run", "-c", DRIVE, "--quiet", "--record", str(path)]
        with subprocess.Popen(command) as process:
            _wait_for(path)
            began = time.monotonic()
            time.sleep(random.Random(number).uniform(0.5, 2.5))
            os.kill(process.pid, signal.SIGKILL)
            seconds = time.monotonic() - began
        events = replayed(btlang.parse_tree(DRIVE), path)
        assert events[-1].t > seconds - 1.0


def _wait_for(path: Path) -> None:
    until = time.monotonic() + 30
    while not path.exists() or b"/robot/state" not in path.read_bytes():
        assert time.monotonic() < until
        time.sleep(0.01)


def test_every_beginning_of_a_recording_can_be_read(tmp_path: Path) -> None:
    recorded("nod then wave", tmp_path / "run.mcap")
    whole = (tmp_path / "run.mcap").read_bytes()
    first = len(read_recording(str(tmp_path / "run.mcap")).entries)
    counts = []
    for end in range(0, len(whole), 997):
        (tmp_path / "cut.mcap").write_bytes(whole[:end])
        try:
            counts.append(len(read_recording(str(tmp_path / "cut.mcap")).entries))
        except MissionError:
            assert not counts  # its head is not there yet
    assert counts == sorted(counts)
    assert counts[-1] > first - 50


@pytest.mark.parametrize("content", [b"", b"no", os.urandom(5000), b"\x89MCAP0\r\n" + os.urandom(5000)])
def test_what_is_no_recording_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "x.mcap").write_bytes(content)
    with pytest.raises(MissionError, match="BT084"):
        read_recording(str(tmp_path / "x.mcap"))


def test_a_full_disk_ends_the_recording_and_not_the_mission(tmp_path: Path) -> None:
    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    path = tmp_path / "run.mcap"
    command = [
        sys.executable,
        "-m",
        "btlang",
        "run",
        "-c",
        "go to the lab then nod",
        "--speed",
        "max",
        "--record",
        path,
    ]
    done = subprocess.run(command, preexec_fn=limit, capture_output=True, text=True, check=False)
    assert "The mission succeeded" in done.stdout
    assert f"error BT009: I can't write {path}: file too large." in done.stderr
    assert "Wrote" not in done.stdout
    assert done.returncode == 2
    assert len(read_recording(str(path)).entries) > 20


def test_files_of_a_size_have_all_that_replaying_needs(tmp_path: Path) -> None:
    mission, events = recorded(ROUND, tmp_path / "run.mcap", most_bytes=100_000)
    paths = sorted(tmp_path.glob("run*.mcap"), key=lambda path: (len(path.name), path.name))
    assert len(paths) > 2
    assert [path.name for path in paths[:3]] == ["run.mcap", "run.2.mcap", "run.3.mcap"]
    assert all(path.stat().st_size < 130_000 for path in paths)
    assert [change for path in paths for change in changes(replayed(mission, path))] == changes(events)
    assert all("mission.txt" in read_recording(str(path)).files for path in paths)


def test_a_whole_recording_has_a_summary(tmp_path: Path) -> None:
    recorded("nod", tmp_path / "run.mcap")
    with (tmp_path / "run.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert {channel.topic for channel in summary.channels.values()} > {"/robot/state", "/btlang/statuses"}
    with (tmp_path / "run.mcap").open("rb") as file:
        assert sum(1 for _ in StreamReader(file).records) > 20


def test_a_recording_that_cannot_be_begun(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in (tmp_path / "no" / "run.mcap", tmp_path):
        assert main(["run", "-c", "nod", "--speed", "max", "--record", str(path)]) == 2
        assert "BT009" in capsys.readouterr().err
