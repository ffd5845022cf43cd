"""What the server costs: from a tick to its clients, log-in beside that, and what the robot notices of it.

    python -m tests.benchmarks.server [--seconds 60] [--clients 200] [--idle 1000] [--log-ins 20]

A robot is up in a process of its own, with a mission of 500 nodes of which nearly all have another status after each
tick, 20 times a second. First it is alone. Then there is a server, with clients in a niced process that subscribe to
all of that; next one of them stops reading, then people log in, then there are idle clients, too. Last the robot is
alone again. Clients measure from the wall time of the change in the robot to the moment when they have the whole
message. A tick is late by what its period took longer than 50 ms. Figures come with the load of the computer.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack, closing
from itertools import pairwise
from pathlib import Path
from typing import Any

from btlang.api import Mission
from btlang.run.bus import INLINE
from btlang.run.events import Event, PeriodPassed
from btlang.server.live.sockets import MOST_OF_USER
from btlang.session import Run
from btlang.task.layer import keep_ticks_in_time
from tests.benchmarks.server_clients import figures
from tests.server.doors import Door, robot_in
from tests.task.layers import submit

NODES = 500
RATE = 20.0
_SETTLE = 5.0  # seconds before a measurement


def mission() -> str:
    """Conditions of which one half holds in each tick, and the other half in the next."""
    rows = "\n".join(f"        check x is {index % 2}" for index in range(NODES - 10))
    return f"""set x to 0
repeat:
    if x is 1, set x to 0, otherwise set x to 1
    do "ParallelAll" with max_failures "-1":
{rows}
    wait 0.05 s
"""


class _Marks:
    """A sink that keeps when each period was over, and how many statuses were other ones than a tick before."""

    policy = INLINE

    def __init__(self, run: Run) -> None:
        self._run, self._codes = run, b""
        self.moments: list[float] = []
        self.changes: list[int] = []

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed):
            self.moments.append(time.perf_counter())
            before, self._codes = self._codes, self._run.follower.codes()
            self.changes.append(sum(map(int.__ne__, before, self._codes)))

    def report(self) -> dict[str, list[float]]:
        """What there was since the last report."""
        moments, self.moments = self.moments, []
        changes, self.changes = self.changes, []
        return {"late": [max(0.0, b - a - 1 / RATE) for a, b in pairwise(moments)], "changes": list(changes)}


def robot(folder: Path) -> None:
    """The robot's process: answers each line with a report."""
    marks: list[_Marks] = []

    def sinks(task: object, mission: Mission, run: Run) -> list[Any]:
        marks.append(_Marks(run))
        return marks[-1:]

    with robot_in(folder, speed="real", sinks=sinks) as layer:
        submit(layer, mission())
        keep_ticks_in_time()
        print("up", flush=True)
        for _ in sys.stdin:
            print(json.dumps(marks[-1].report()), flush=True)


class Part:
    """A process of this benchmark that answers lines."""

    def __init__(self, *words: str, **environment: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env={**os.environ, **environment},
        )  # fmt: skip
        self.read()

    def ask(self, word: str = "report") -> Any:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{word}\n")
        self.process.stdin.flush()
        return json.loads(self.read())

    def read(self) -> str:
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert line, "a process of the benchmark ended"
        return line

    def close(self) -> None:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        self.process.wait(30)
        self.process.stdout.close()


class Bench:
    """The parts that are up, and what is printed of them."""

    def __init__(self, robot: Part, seconds: float) -> None:
        self.robot, self.seconds = robot, seconds

    def measure(self, name: str, clients: Part | None = None, beside: Callable[[], object] = lambda: None) -> None:
        """Prints how late ticks are during the next seconds, and how late the clients hear of them."""
        parts = [self.robot, *filter(None, [clients])]
        for part in parts:
            part.ask()
        began = time.monotonic()
        beside()
        time.sleep(max(0.0, began + self.seconds - time.monotonic()))
        of_robot, *of_clients = (part.ask() for part in parts)
        changes = sorted(filter(None, of_robot["changes"]))
        print(f"{name}, {self.seconds:g} s {load()}")
        print(f"  ticks late by {figures(of_robot['late'])}; {changes[len(changes) // 2]} statuses change in a tick")
        for report in of_clients:
            share = report["messages"] / max(1, len(changes) * report["subscribed"])
            print(f"  tick to client {report['text']}; {share:.0%} of the ticks came to {report['subscribed']} clients")


def load() -> str:
    """The load of the computer, as each line shows it."""
    return f"(load {os.getloadavg()[0]:.1f})"


def log_ins(door: Door, count: int) -> None:
    """Each with a connection of its own."""
    taken = []
    for _ in range(count):
        began = time.perf_counter()
        door.log_in("ann")
        taken.append(time.perf_counter() - began)
        time.sleep(0.2)
    if taken:
        print(f"  {count} log-ins: {figures(taken)} {load()}")


def cpu(process: int) -> float:
    """Seconds that a process has used."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Prints the figures."""
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--clients", type=int, default=200)
    parser.add_argument("--idle", type=int, default=1000)
    parser.add_argument("--log-ins", type=int, default=20)
    parser.add_argument("--hold", action="store_true", help="wait for Enter at the end, for a profiler")
    parser.add_argument("--robot", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.robot is not None:
        robot(options.robot)
        return
    with tempfile.TemporaryDirectory(prefix="bt") as name, ExitStack() as parts:
        folder = Path(name)
        bench = Bench(parts.enter_context(closing(Part("tests.benchmarks.server", "--robot", name))), options.seconds)
        time.sleep(_SETTLE)
        bench.measure("the robot alone")
        with ExitStack() as others:
            told(bench, others.enter_context(closing(Door(folder))), options, others)
        bench.measure("the robot alone again")  # what a run remembers grows, and garbage collections with it


def told(bench: Bench, door: Door, options: argparse.Namespace, parts: ExitStack) -> None:
    """All that is measured with a server."""
    server = door.process.pid
    door.user("add", "ann", "--role", "administrator")
    users = ["ann", *(f"user{number}" for number in range((options.clients + options.idle) // MOST_OF_USER + 1))]
    for user in users[1:]:
        door.user("add", user)
    tokens = [door.user("token", user, "benchmark").split()[-1] for user in users]

    def clients(count: int, rate: float) -> Part:
        words = "--port", str(door.port), "--count", str(count), "--rate", str(rate)
        own = [tokens.pop() for _ in range(-(-count // MOST_OF_USER))]
        part = Part("tests.benchmarks.server_clients", *words, BTLANG_TOKEN=" ".join(own))
        return parts.enter_context(closing(part))

    time.sleep(1.0)
    print(f"the server: {door.memory:.0f} MB")
    watching = clients(options.clients, RATE)
    time.sleep(_SETTLE)
    used, began = cpu(server), time.monotonic()
    bench.measure(f"{options.clients} clients", watching)
    print(f"  the server: {(cpu(server) - used) / (time.monotonic() - began):.0%} of a core, {door.memory:.0f} MB")
    watching.ask("silence")
    bench.measure("  and one that has stopped reading", watching)
    bench.measure("  and log-ins", watching, lambda: log_ins(door, options.log_ins))
    if options.idle:
        before = door.memory
        clients(options.idle, 0.0)
        time.sleep(_SETTLE)
        bench.measure(f"{options.clients} clients and {options.idle} idle ones", watching)
        now = door.memory
        print(f"  the server: {now:.0f} MB, {(now - before) * 1024 / options.idle:.0f} kB for each idle client")
    if options.hold:
        print(f"the server is process {server}")
        input()


if __name__ == "__main__":
    main()
