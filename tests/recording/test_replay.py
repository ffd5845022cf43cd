"""`btc replay` and `btc why`: a recorded run as it was, as a story, and once more."""

from __future__ import annotations

import math
import re
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.engine.compile import outline
from btlang.recording import replay
from btlang.recording.reader import RecordedNodes, read_recording
from btlang.recording.replay import Player, ReplayTimeline
from btlang.recording.story import fold_lines
from btlang.run.controls import Controls
from btlang.run.events import Event, PeriodPassed
from btlang.run.snapshot import RunState
from btlang.vocabulary.shipped import BODIES
from tests.conftest import matches_golden
from tests.recording.runs import recorded

HERE = Path(__file__).parent
ROUNDS = """
if the battery is below 20%, say low
if there is a cup in the lab, wave
if someone is near, wave
repeat 5 times: nod then go to the lab
repeat 4 times: (look for Carol in the hall then fail) if possible
for 3 s, wait until the battery is below 50%
wave
"""
FAILING = """
try to grasp the book up to 2 times, otherwise nod
set n to 3
say "{n} left"
go to a random place
pick up the cup
grasp the book
"""


def run(text: str, path: Path, *options: str) -> int:
    return main(["run", "-c", text, "--speed", "max", "--seed", "7", "--record", str(path), *options])


def timeline_of(text: str, folder: Path) -> ReplayTimeline:
    mission, _ = recorded(text, folder / "run.mcap")
    nodes = RecordedNodes(*outline(mission.tree))
    return ReplayTimeline(list(read_recording(str(folder / "run.mcap")).events(nodes)), nodes)


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    code = main(list(words))
    return code, capsys.readouterr().out


def test_the_lines_of_a_replay_are_those_of_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(FAILING, tmp_path / "run.mcap", "--lines")
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  ")]
    assert printed(capsys, "replay", str(tmp_path / "run.mcap"), "--lines", "--speed", "max")[1].splitlines() == lines


def test_a_replay_that_nobody_watches_prints_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    speeds: list[float] = []
    monkeypatch.setattr(Player, "play", lambda self, speed, start: speeds.append(speed))
    path = str(tmp_path / "run.mcap")
    run("nod", tmp_path / "run.mcap", "--quiet")
    for words in ((), ("--lines",), ("--speed", "real"), ("--speed", "3")):
        assert printed(capsys, "replay", path, *words)[0] == 0
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    printed(capsys, "replay", path, "--lines")
    assert speeds == [math.inf, math.inf, 1.0, 3.0, 1.0]


def test_why_tells_the_story(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(FAILING, tmp_path / "run.mcap", "--quiet")
    capsys.readouterr()
    code, story = printed(capsys, "why", str(tmp_path / "run.mcap"))
    assert code == 0
    matches_golden(re.sub(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d", "(when)", story), HERE / "why.out")


def test_why_folds_rounds_and_shows_what_was_false(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(ROUNDS, tmp_path / "run.mcap", "--quiet", "--for", "100s")
    capsys.readouterr()
    story = printed(capsys, "why", str(tmp_path / "run.mcap"))[1].splitlines()
    lines = [re.sub(r"^ *[0-9.]+ s  | is [0-9.]+%|, last at .*", "", line).strip() for line in story[1:-1]]
    assert lines == [
        "battery is below 20%: false (battery)",
        "cup in lab: failed (I know no cup in the lab)",
        "someone is near: false",
        "nod",
        "go to lab",
        "...  these 2 lines 5 times",
        "look for Carol in hall: failed (I haven't found Carol in the hall)",
        "...  this 4 times",
        "wave",
    ]


def test_why_shows_which_rule_acted_on_what_and_what_it_halted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = """whenever the battery is below 99.5% and it is not the case that Alice is near, say low then charge
repeat 2 times: go to the lab, then go to the lobby
whenever the battery is below 20%, nod
"""
    run(text, tmp_path / "run.mcap", "--quiet", "--for", "100s")
    capsys.readouterr()
    story = printed(capsys, "why", str(tmp_path / "run.mcap"))[1].splitlines()
    rule = next(line for line in story if ": true" in line)
    said = story[story.index(rule) + 1]
    assert re.fullmatch(
        r" +\d+\.\d s  battery is below 99\.5% and it is not the case that Alice is near: true"
        r" \(battery is 99\.4\d*%\), so it halted 'go to lab'",
        rule,
    ), story
    assert 'say "low"' in said
    assert rule.split()[0] == said.split()[0]


@pytest.mark.parametrize(
    ("said", "lines"),
    [
        ("ab", ["a", "b"]),
        ("aab", ["a", "a", "b"]),
        ("aaab", ["a", "this 3 times, last at 2.0 s", "b"]),
        ("cabababab", ["c", "a", "b", "these 2 lines 4 times, last at 7.0 s"]),
        ("aaabaaab", ["a", "this 3 times, last at 2.0 s", "b", "a", "this 3 times, last at 6.0 s", "b"]),
        ("aabaabaab", ["a", "a", "b", "these 3 lines 3 times, last at 6.0 s"]),
    ],
)
def test_rounds_of_lines_are_folded(said: str, lines: list[str]) -> None:
    noted = [(float(at), text, f" ({at})") for at, text in enumerate(said)]
    assert [re.sub(r" \(\d\)", "", line[12:]) for line in fold_lines(noted)] == lines


def test_why_says_that_a_run_was_stopped_or_its_recording_cut(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.mcap"
    run("go to the lab then go to the kitchen", path, "--quiet", "--for", "3s")
    assert "It was stopped (time limit) after 3.0 s." in printed(capsys, "why", str(path))[1]
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    story = printed(capsys, "why", str(path))[1]
    assert "go to lab: still under way as the recording ends" in story
    assert re.search(r"The recording ends after 1\.\d s\. The mission goes on", story)


def test_the_mission_runs_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.mcap"
    run(FAILING, path, "--quiet")
    capsys.readouterr()
    assert printed(capsys, "replay", str(path), "--as-mission") == (0, "The run was the same.\n")


def test_where_it_goes_otherwise_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Another seed chooses another place."""
    path = tmp_path / "run.mcap"
    run("go to a random place then nod", path, "--quiet")
    path.write_bytes(path.read_bytes().replace(b"\x04\0\0\0seed\x01\0\0\x007", b"\x04\0\0\0seed\x01\0\0\x009"))
    assert main(["replay", str(path), "--as-mission"]) == 0  # statuses alone are the same
    run("go to a random place; if you are in the lobby, nod, otherwise wave", path, "--quiet")
    path.write_bytes(path.read_bytes().replace(b"\x04\0\0\0seed\x01\0\0\x007", b"\x04\0\0\0seed\x01\0\0\x002"))
    capsys.readouterr()
    codes = [main(["replay", str(path), "--as-mission"])]
    told = capsys.readouterr()
    assert codes == [1]
    assert told.err.startswith("before: at ")
    assert "\nnow:    at " in told.err


def test_a_recording_runs_no_code_that_came_with_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = tmp_path / "words.toml"
    words.write_text('[[action]]\nphrase = "hop"\nid = "Hop"\ncall = "hop_code:hop"\n', encoding="utf-8")
    (tmp_path / "hop_code.py").write_text("from pathlib import Path\ndef hop():\n    pass\n", encoding="utf-8")
    path = tmp_path / "run.mcap"
    assert run("hop", path, "--quiet", "--keywords", str(words)) == 0
    marker = tmp_path / "ran"
    (tmp_path / "hop_code.py").write_text(f"open({str(marker)!r}, 'w')\ndef hop():\n    pass\n", encoding="utf-8")
    capsys.readouterr()
    assert "hop" in printed(capsys, "why", str(path))[1]
    assert main(["replay", str(path), "--as-mission"]) == 2
    assert not marker.exists()
    assert main(["replay", str(path), "--as-mission", "--keywords", str(words)]) == 0


def test_pace_pause_step_and_stop(tmp_path: Path) -> None:
    timeline = timeline_of("wait 1 s", tmp_path)
    events, controls, seen = timeline.events, Controls(), list[Event]()
    began = time.monotonic()
    assert Player(timeline, [seen.append], controls).play(4.0)
    assert time.monotonic() - began == pytest.approx(events[-1].t / 4, rel=0.3)
    assert seen == events
    seen.clear()
    controls.pause()
    thread = threading.Thread(target=Player(timeline, [seen.append], controls).play, args=(1.0,))
    thread.start()
    for _ in range(3):
        time.sleep(0.1)
        controls.step()
    time.sleep(0.1)
    assert sum(isinstance(event, PeriodPassed) for event in seen) == 4
    controls.stop()
    thread.join(5)
    assert not thread.is_alive()
    assert len(seen) < len(events)


def test_it_begins_where_one_wants(tmp_path: Path) -> None:
    timeline = timeline_of("wait 5 s then try to grasp the book then wait 5 s", tmp_path)
    assert timeline.failures == [pytest.approx(5.0, abs=0.1)]
    seen = list[Event]()
    began = time.monotonic()
    Player(timeline, [seen.append], Controls()).play(5.0, start=9.0)
    assert time.monotonic() - began < 1.5  # from the beginning it would be 2 or more
    assert seen == timeline.events  # a sink without jumps gets all


class Screen:
    """A sink that notes what it is shown."""

    def __init__(self, timeline: ReplayTimeline) -> None:
        self.state = timeline.state(0)
        self.jumps: list[float] = []

    def __call__(self, event: Event) -> None:
        self.state.take(event)

    def jump(self, state: RunState) -> None:
        self.state = state
        self.jumps.append(state.now)


def test_the_state_after_any_event_is_that_of_all_before_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replay, "_KEPT", 20)
    timeline = timeline_of(FAILING, tmp_path)
    state = timeline.state(0)
    for count, event in enumerate(timeline.events):
        assert vars(timeline.state(count)) == vars(state)
        state.take(event)


def test_one_goes_on_and_back_and_to_the_next_failure(tmp_path: Path) -> None:
    timeline = timeline_of("repeat twice: wait 20 s then try to grasp the book", tmp_path)
    screen, controls = Screen(timeline), Controls()
    player = Player(timeline, [screen], controls)
    thread = threading.Thread(target=player.play, args=(1.0,))
    controls.pause()
    thread.start()

    def jumped(ask: Callable[[], object]) -> float:
        before = len(screen.jumps)
        ask()
        until = time.monotonic() + 5
        while len(screen.jumps) == before and time.monotonic() < until:
            time.sleep(0.01)
        return screen.jumps[-1]

    assert jumped(partial(player.move, 10)) == pytest.approx(10, abs=0.1)
    assert jumped(player.next_failure) == pytest.approx(20, abs=0.2)
    assert screen.state.statuses == timeline.state(timeline.count_before(screen.jumps[-1])).statuses
    controls.resume()
    assert jumped(player.next_failure) == pytest.approx(40, abs=0.3)
    assert controls.paused
    player.next_failure()  # none follows
    assert jumped(partial(player.move, -100)) == pytest.approx(0, abs=0.1)
    assert jumped(partial(player.seek, 1e9)) == pytest.approx(timeline.events[-1].t, abs=0.2)
    controls.resume()
    thread.join(5)
    assert not thread.is_alive()


def test_a_condition_that_is_false_is_no_failure(tmp_path: Path) -> None:
    text = """whenever the battery is below 99.9% or Alice is near, wait 30 s
if the battery is below 20% or Alice is near, nod otherwise wave
go to the lab but stop when Alice is near
wait until the battery is below 99.9%
{}"""
    assert timeline_of(text.format(""), tmp_path).failures == []
    failing = timeline_of(text.format("try to grasp the book, otherwise nod"), tmp_path)
    assert len(failing.failures) == 1


def test_the_robot_file_is_in_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, file = tmp_path / "small.toml", str(tmp_path / "r.mcap")
    robot.write_text((Path(BODIES) / "small.toml").read_text())
    run = ["run", "-c", "move forward 1 m, then turn left", "--speed", "max", "--quiet", "--record", file]
    for named in (str(robot), "small"):
        assert main([*run, "--robot", named]) == 0
        robot.unlink(missing_ok=True)
        assert main(["replay", "--as-mission", file]) == 0
        assert "The run was the same." in capsys.readouterr().out
