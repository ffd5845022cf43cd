"""What the gate compares, as JSON: the least time of each of several rounds. See gate.py, which runs it on two commits.

So it uses nothing of the package but what has been there for long.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path

import btlang
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.run.bus import Bus
from btlang.run.runner import trace_engine
from btlang.session import Session
from btlang.tree.node import Node, Tree
from tests.benchmarks.missions import mission
from tests.benchmarks.trees import BINDINGS, CHANGING, ODD, SETTLED, TREES, mix, n, nodes

ROUNDS = 7
_LONG = 0.01  # seconds of a round


def least(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """The seconds of the thread that one call takes, when nothing else slows it down."""
    began = time.thread_time()
    work()
    times = max(1, int(_LONG / max(time.thread_time() - began, 1e-9)))
    taken = []
    for _ in range(rounds):
        began = time.thread_time()
        for _ in range(times):
            work()
        taken.append((time.thread_time() - began) / times)
    return min(taken)


def ticks() -> Iterator[tuple[str, float]]:
    """Trees without a listener, then with the status of each node told, in trees where most statuses change."""
    for name in ("T1", "T2", "T3", "T4"):
        engine = Engine(Tree(TREES[name][1]), BINDINGS.get, clock=Clock())
        for _ in range(SETTLED):
            engine.tick()
        yield name, least(engine.tick)
    taken = []
    for _ in range(ROUNDS):  # the only tick of a tree
        engine = Engine(Tree(TREES["T5"][1]), BINDINGS.get, clock=Clock())
        began = time.thread_time()
        engine.tick()
        taken.append(time.thread_time() - began)
    yield "T5", min(taken)
    for name in ("T1", "T2", "T3", "T4"):
        engine = trace_engine(Tree(TREES[name][1]), BINDINGS.get, bus=Bus())
        for _ in range(SETTLED):
            engine.tick()
        yield f"told without a change: {name}", least(engine.tick)
    for name, root in CHANGING.items():
        engine = trace_engine(Tree(root), BINDINGS.get, bus=Bus())

        def both(engine: Engine = engine) -> None:
            for ODD[0] in (False, True):
                engine.tick()

        for _ in range(SETTLED // 2):
            both()
        yield f"told: {name}", least(both)


def missions() -> Iterator[tuple[str, float]]:
    """Reading, and reading once more in the same process."""
    text = mission(500)
    btlang.parse_tree(text)
    yield "compile 500 lines", least(lambda: btlang.parse_tree(text), 3)
    yield "a short sentence again", least(lambda: btlang.parse_tree("move forward 1 m then say done"))


def runs() -> Iterator[tuple[str, float]]:
    """A run on the simulated robot, and what its conditions cost."""

    def drive() -> None:
        with Session() as session:
            session.run("go to the kitchen then go to the lab then look around", speed="max", seed=1)

    yield "simulated run", least(drive, 3)
    leaf = next(node for node in btlang.parse_tree("if Bob is near then stop").tree.walk() if not node.children)
    asked = tuple(Node("ForceSuccess", (leaf,)) for _ in range(100))
    guarded = Tree(Node("ReactiveSequence", (*asked, Node("Sleep", (), (("msec", "1000000000"),)))))
    with Session() as session:
        run = session.prepare(btlang.parse_tree("stop").replace(tree=guarded, syntax=None))
        run.nodes.tick()
        yield "100 conditions", least(run.nodes.tick)


def start() -> Iterator[tuple[str, float]]:
    """`btc check` of a line beside what any command imports, in time of the processor; -S leaves out the machine's."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "mission.txt")
        file.write_text("go to the kitchen then wave\n", encoding="utf-8")
        plain = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        plain["XDG_CACHE_HOME"] = folder

        def spent(*arguments: str) -> float:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            command = [sys.executable, "-S", *arguments]
            subprocess.run(command, env=plain, check=True, stdout=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

        commands = ("-m", "btlang", "check", str(file)), ("-c", "import argparse, re")
        spent(*commands[0])  # bytecode and words are written
        taken = [[spent(*command) for command in commands] for _ in range(ROUNDS)]
    check, python = (min(each) for each in zip(*taken, strict=True))
    yield "btc check / import argparse, re", check / python


def memory() -> Iterator[tuple[str, float]]:
    """Bytes of a node of a tree that a run follows."""
    root = n("Sequence", *[mix() for _ in range(5)])
    gc.collect()
    tracemalloc.start()
    kept = trace_engine(Tree(root), BINDINGS.get, bus=Bus())
    used, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    yield "bytes a node", used / sum(1 for _ in nodes(root)) if kept else 0.0


def main() -> None:
    """Prints the figures."""
    groups = (ticks, missions, runs, start, memory)
    print(json.dumps({name: value for group in groups for name, value in group()}))


if __name__ == "__main__":
    main()
