"""What the live view costs: its share of one core at 20 ticks a second, and what it does to the ticks.

    python -m tests.benchmarks.live [--seconds 8] [--rounds 3]

Each run is a process of its own on a pseudo terminal of 80 x 24, in real time, with the view or with nobody watching.
The first second of each is left out. The cost is the difference of the CPU times of the two, medians of the rounds.
"""

from __future__ import annotations

import argparse
import fcntl
import json
import os
import pty
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
from contextlib import nullcontext
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import btlang
from btlang.run.bus import INLINE
from btlang.run.controls import Controls
from btlang.run.events import PeriodPassed
from btlang.run.live.view import LiveView
from btlang.run.runner import Runner

RATE = 20.0
LEFT_OUT = 1.0
WIDTH, HEIGHT = 80, 24


def everyday() -> str:
    """50 tasks in turn, each with commands that take a second or so, and a condition before each."""
    names = [f"task {chr(97 + i // 26)}{chr(97 + i % 26)}" for i in range(50)]
    tasks = [f"{name} is look left, look right, nod, wave, then look ahead" for name in names]
    turns = [f"    if the path is clear, {name}, otherwise say hello" for name in names]
    return "\n".join([*tasks, "repeat:", *turns])


def restless() -> str:
    """500 conditions, all of them asked anew in each tick: 10,000 status changes a second."""
    row = " and ".join(["the path is clear"] * 249)
    return f"repeat:\n    check {row}\n    check {row}\n    wait 0.01 s\n"


MISSIONS = {"everyday": everyday, "restless": restless}


def watched_run(mission: str, view: bool, seconds: float, report: Path) -> None:
    """One run on the terminal of this process; writes figures to a file."""
    tree = btlang.parse_tree(MISSIONS[mission]())
    work: list[float] = []
    marks: list[tuple[float, float]] = []  # real and CPU time at the end of each period
    runners: list[Runner] = []
    plain_tick = Runner._tick

    def timed_tick(runner: Runner, ticking: Any) -> int:
        began = time.perf_counter()
        status = plain_tick(runner, ticking)
        work.append(time.perf_counter() - began)
        runners[:] = [runner]
        return status

    def mark(event: object) -> None:
        if isinstance(event, PeriodPassed) and LEFT_OUT <= event.t < seconds:
            marks.append((time.perf_counter(), time.process_time()))

    Runner._tick = timed_tick  # type: ignore[method-assign, assignment]
    mark.policy = INLINE  # type: ignore[attr-defined]
    controls = Controls()
    live = LiveView(tree, controls, sys.stdout, sys.stdin) if view else None
    with live or nullcontext():
        tree.run(rate=RATE, time_limit=seconds, controls=controls, sinks=[mark, live] if live else [mark])
    (began, cpu_before), (ended, cpu_after) = marks[0], marks[-1]
    late = [abs(b[0] - a[0] - 1 / RATE) for a, b in pairwise(marks)]
    figures = {"share": (cpu_after - cpu_before) / (ended - began), "late": late, "overruns": runners[0]._pace.late}
    report.write_text(json.dumps({**figures, "work": work[int(LEFT_OUT * RATE) :]}), encoding="utf-8")


def measured(mission: str, view: bool, seconds: float, folder: Path) -> dict[str, Any]:
    """The figures of one run in a process of its own."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", HEIGHT, WIDTH, 0, 0))
    report = folder / "report.json"
    options = ["--seconds", str(seconds), "--run", mission, "--report", str(report), *["--view"] * view]
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.benchmarks.live", *options],
        stdin=slave,
        stdout=slave,
        env={**os.environ, "TERM": "xterm-256color"},
    )
    os.close(slave)
    sizes: list[int] = []

    def read() -> None:
        try:
            while data := os.read(master, 65536):
                sizes.append(len(data))
        except OSError:  # the other side is closed
            return

    reader = threading.Thread(target=read)
    reader.start()
    status = process.wait()
    reader.join()
    os.close(master)
    if status:
        sys.exit(f"the run ended with {status}")
    return {**json.loads(report.read_text(encoding="utf-8")), "written": sum(sizes) / seconds}


def told(values: list[float]) -> str:
    """Percentiles in milliseconds."""
    ordered = sorted(values)
    return " ".join(f"{ordered[min(int(len(ordered) * p), len(ordered) - 1)] * 1000:6.2f}" for p in (0.5, 0.9, 0.99, 1))


def compare(mission: str, seconds: float, rounds: int) -> None:
    """Prints a mission's figures without and with the view; the runs of both alternate."""
    tree = btlang.parse_tree(MISSIONS[mission]()).tree
    print(f"{mission}: {sum(1 for _ in tree.walk())} nodes, {RATE:g} ticks a second, terminal {WIDTH} x {HEIGHT}")
    runs: dict[bool, list[dict[str, Any]]] = {False: [], True: []}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            for view in runs:
                runs[view].append(measured(mission, view, seconds, Path(folder)))
    shares = {view: median(run["share"] for run in runs[view]) for view in runs}
    for view, those in runs.items():
        work, late = ([value for run in those for value in run[key]] for key in ("work", "late"))
        overruns, written = sum(run["overruns"] for run in those), median(run["written"] for run in those)
        print(
            f"  {'with the view' if view else 'without':14} CPU {shares[view]:6.2%}, {written / 1000:.1f} kB/s written"
        )
        print(f"    a tick and its step take, ms (p50 p90 p99 max) {told(work)}")
        print(f"    periods differ from 50 ms by                   {told(late)}   overruns {overruns}")
    print(f"  The view costs {shares[True] - shares[False]:.2%} of one core.\n")


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description="What the live view costs.")
    parser.add_argument("--seconds", type=float, default=8.0)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--run", help=argparse.SUPPRESS)
    parser.add_argument("--view", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--report", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.run:
        watched_run(options.run, options.view, options.seconds, options.report)
        return
    for mission in MISSIONS:
        compare(mission, options.seconds, options.rounds)


if __name__ == "__main__":
    main()
