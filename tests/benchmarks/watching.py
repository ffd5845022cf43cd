"""What tests, recordings and Groot2 cost, beside the same run without them.

    python -m tests.benchmarks.watching [--minutes 5] [--rounds 5] [--nodes 5000]

First a patrol, as fast as it goes: alone, as a test with four lines, and recorded. Then jumps in the replay of an hour
of it, anywhere: to the state, which a screen then draws. Then a tree of many nodes at 20 Hz
in real time with a client of Groot2 that polls as it does: printed are late ticks, and how long answers took.
"""

from __future__ import annotations

import argparse
import random
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import btlang
from btlang.engine.compile import outline
from btlang.monitor.groot import groot_monitor
from btlang.recording.bundle import files_of
from btlang.recording.reader import RecordedNodes, read_recording
from btlang.recording.recorder import Recorder
from btlang.recording.replay import ReplayTimeline
from btlang.run.controls import Controls
from btlang.session import Session
from btlang.testing.runner import run_test
from btlang.tree.node import Node, Tree
from tests.monitor.client import GrootClient
from tests.testing.files import mission_test

PATROL = "repeat forever: go to the lobby then go to the lab and meanwhile look around"
LINES = (
    "within 2 minutes it has reached the lab", "always the battery is above 1%", "never it has bumped",
    "finally it has never said hello",
)  # fmt: skip
PORT = 18_667


def main() -> None:
    """Prints the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=5.0)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--nodes", type=int, default=5_000)
    options = parser.parse_args()
    seconds = options.minutes * 60
    mission, test = btlang.parse_tree(PATROL), mission_test(PATROL, *LINES).replace(limit=seconds, is_cut=False)

    def recorded() -> None:
        with tempfile.TemporaryDirectory() as folder, Session() as session:
            recorder = Recorder(str(Path(folder, "r.mcap")), mission.label, files_of(mission, ()), {})
            session.run(mission, speed="max", time_limit=seconds, sinks=[recorder])
            recorder.close()

    alone = _median(lambda: mission.run(speed="max", time_limit=seconds), options.rounds)
    print(f"{options.minutes:g} simulated minutes alone: {alone:.2f} s")
    for name, run in (("as a test", lambda: run_test(test)), ("recorded", recorded)):
        taken = _median(run, options.rounds)
        print(f"  {name}: {taken:.2f} s, {taken / alone:.2f} times as long")
    _jumps(mission)
    _groot(options.nodes)


def _median(run: Callable[[], object], rounds: int) -> float:
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        run()
        times.append(time.perf_counter() - began)
    return median(times)


def _jumps(mission: btlang.Mission) -> None:
    with tempfile.TemporaryDirectory() as folder, Session() as session:
        path = str(Path(folder, "r.mcap"))
        recorder = Recorder(path, mission.label, files_of(mission, ()), {})
        session.run(mission, speed="max", time_limit=3600.0, sinks=[recorder])
        recorder.close()
        began = time.perf_counter()
        nodes = RecordedNodes(*outline(mission.tree))
        timeline = ReplayTimeline(list(read_recording(path).events(nodes)), nodes)
        timeline.state(0)
        print(f"a replay of an hour, {len(timeline.events)} events: opened in {time.perf_counter() - began:.1f} s")
    taken = []
    for number in range(500):
        wanted = random.Random(number).uniform(0, 3600)
        began = time.perf_counter()
        timeline.state(timeline.count_before(wanted))
        taken.append(time.perf_counter() - began)
    print(f"  jumps: {median(taken) * 1e3:.1f} ms, the slowest {max(taken) * 1e3:.1f} ms")


def _groot(count: int) -> None:
    leaves = tuple(Node("Wave") for _ in range(count - 2))
    tree = Tree(Node("Repeat", (Node("Parallel", leaves),), (("num_cycles", "-1"),)))
    mission = btlang.parse_tree("wave").replace(tree=tree, syntax=None)
    answers: list[float] = []
    controls = Controls()
    with groot_monitor(PORT, controls) as monitor, Session() as session, GrootClient(PORT) as client:
        run = session.prepare(mission, controls=controls, hooks=monitor.hooks, time_limit=10.0)
        monitor.watch_run(run, mission)
        run.start()
        client.uids()
        while run.wait(0.1) is None:
            began = time.perf_counter()
            client.statuses()
            answers.append(time.perf_counter() - began)
        outcome = run.wait()
        assert outcome is not None
    print(f"{count} nodes at 20 Hz with Groot2: {outcome.overruns} of {outcome.ticks} ticks late")
    print(f"  answers: {median(answers) * 1e3:.1f} ms, the slowest {max(answers) * 1e3:.1f} ms")


if __name__ == "__main__":
    main()
