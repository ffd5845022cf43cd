"""How fast trees are ticked, beside py_trees: `python -m tests.benchmarks.ticks [--rounds 15]`.

Both run the same tree, with leaves that do nothing, written as each documents it: here functions, and generators or
classes for what takes time; there behaviours. A tick is `Engine.tick` and `BehaviourTree.tick`. Ratios are those of
medians of rounds in which all take turns. The last lines are the ratios without a listener; before them stand those
with every status change sent to the event stream, what depth does to a tick, and what a node costs.

Except T5, whose first tick is measured, all trees are ticked first until the engine has generated what it will. In most
of these trees the statuses soon stay as they are. So before all this stand trees in which nearly all of them
change at each tick: alone, with the changes sent to the event stream, and with what each run has follow them.
"""

from __future__ import annotations

import argparse
import gc
import time
import tracemalloc
from collections.abc import Callable
from functools import partial
from statistics import median

import py_trees
from py_trees.common import Status

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.run.bus import Bus
from btlang.run.events import Event
from btlang.run.failure_history import FailureHistory
from btlang.run.follower import RunFollower
from btlang.run.recent import RecentEvents
from btlang.run.runner import trace_engine
from btlang.tree.node import Node, Tree
from tests.benchmarks.compile import medians, seconds
from tests.benchmarks.trees import BINDINGS, CHANGING, KEY, MIX, ODD, SETTLED, TREES, mix, n, nodes

BIG = 100_000
DEEP = (10, 100, 1_000)


class Answer(py_trees.behaviour.Behaviour):
    """The same leaves for py_trees: one status for ever."""

    def __init__(self, name: str, status: Status) -> None:
        super().__init__(name)
        self.answer = status

    def update(self) -> Status:
        return self.answer


ANSWERS = {"Yes": Status.SUCCESS, "No": Status.FAILURE, "Act": Status.SUCCESS, "Run": Status.RUNNING}
ANSWERS |= {"Wait": Status.RUNNING, "Keyed": Status.SUCCESS}
DECORATORS = {
    "Inverter": py_trees.decorators.Inverter,
    "ForceSuccess": py_trees.decorators.FailureIsSuccess,
    "ForceFailure": py_trees.decorators.SuccessIsFailure,
}


def peer(node: Node) -> py_trees.behaviour.Behaviour:
    """The same tree in py_trees."""
    if node.id in ANSWERS:
        return Answer(node.id, ANSWERS[node.id])
    children = [peer(child) for child in node.children]
    if node.id in DECORATORS:
        return DECORATORS[node.id](node.id, children[0])  # type: ignore[abstract]
    if node.id == "Parallel":
        policy = py_trees.common.ParallelPolicy.SuccessOnAll(synchronise=True)
        return py_trees.composites.Parallel(node.id, policy, children)
    kind = py_trees.composites.Selector if node.id.endswith("Fallback") else py_trees.composites.Sequence
    return kind(node.id, memory=not node.id.startswith("Reactive"), children=children)


def engine(root: Node) -> Engine:
    """Without a listener."""
    made = Engine(Tree(root), BINDINGS.get, clock=Clock())
    made.blackboard.set(KEY, 1.5)
    return made


def repeated(tick: Callable[[], object], times: int) -> None:
    for _ in range(times):
        tick()


def compared(root: Node, rounds: int, fresh: bool) -> dict[str, float]:
    """Median seconds of a tick of each. `fresh`: each round is the only tick of a tree that was built for it."""

    def traced() -> Callable[[], object]:
        bus = Bus()
        bus.add(told.append)
        made = trace_engine(Tree(root), BINDINGS.get, bus=bus)
        made.blackboard.set(KEY, 1.5)
        return made.tick

    told: list[object] = []
    makers: dict[str, Callable[[], Callable[[], object]]] = {
        "py_trees": lambda: py_trees.trees.BehaviourTree(peer(root)).tick,
        "btlang": lambda: engine(root).tick,
        "traced": traced,
    }
    made = {name: make() for name, make in makers.items()}
    times = dict.fromkeys(made, 1)
    if not fresh:
        for name, tick in made.items():
            repeated(tick, 1 if name == "py_trees" else SETTLED)
            times[name] = max(1, int(0.02 / seconds(tick)))
    taken: dict[str, list[float]] = {name: [] for name in made}
    for _ in range(rounds):
        for name in made:
            tick = makers[name]() if fresh else made[name]
            taken[name].append(seconds(partial(repeated, tick, times[name])) / times[name])
            told.clear()
    return {name: median(values) for name, values in taken.items()}


def count(counts: list[int], event: Event) -> None:
    counts.append(event.count)


def changing(rounds: int) -> None:
    """Ticks in which nearly all statuses change, by the time of the thread: what it costs to tell them."""
    for name, root in CHANGING.items():
        bus, followed = Bus(), Bus()
        counts: list[int] = []
        told = trace_engine(Tree(root), BINDINGS.get, bus=bus)
        session = trace_engine(Tree(root), BINDINGS.get, bus=followed)
        bus.add(partial(count, counts))
        for sink in (RunFollower(session), FailureHistory(session), RecentEvents()):
            followed.add(sink)
        ticks = {"alone": engine(root).tick, "told": told.tick, "followed": session.tick}
        taken: dict[str, list[float]] = {each: [] for each in ticks}
        for number in range(2 * rounds + SETTLED):
            ODD[0] = number % 2 == 1
            if number == SETTLED:
                counts.clear()
            for each, tick in ticks.items():
                began = time.thread_time()
                tick()
                taken[each].append(time.thread_time() - began)
        changes = sum(counts) / (2 * rounds)
        alone, there, beside = (median(taken[each][SETTLED:]) for each in ticks)
        print(
            f"{name}, {told.size:,} nodes, {changes:,.0f} changes a tick: {alone * 1e3:.2f} ms alone, told in "
            f"{there / alone:.2f} times that, {(beside - alone) / changes * 1e9:.0f} ns a change with its followers"
        )


def depths(rounds: int) -> None:
    """A resumed tick of a leaf below ever more nodes."""
    ticks: dict[str, Callable[[], object]] = {}
    for depth in DEEP:
        root = n("Run")
        for _ in range(depth):
            root = n("Sequence", n("Yes"), root)
        tick = engine(root).tick
        repeated(tick, SETTLED)
        ticks[f"{depth:,}"] = partial(repeated, tick, 200)
    taken = medians(ticks, rounds)
    told = ", ".join(f"{taken[name] / 200 * 1e6:.2f} µs below {name} sequences" for name in ticks)
    print(f"resumed tick: {told}")


def size(rounds: int) -> None:
    """What a node of a big tree costs."""
    root = n("Sequence", *[mix() for _ in range(BIG // MIX)])
    count = sum(1 for _ in nodes(root))
    built = medians({"build": partial(engine, root)}, max(3, rounds // 3))["build"]
    gc.collect()
    tracemalloc.start()
    kept = engine(root)
    used, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del kept
    print(f"{count:,} nodes: {used / count:.0f} bytes and {built / count * 1e6:.1f} µs to build a node")


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="How fast trees are ticked.")
    options.add_argument("--rounds", type=int, default=15)
    rounds = options.parse_args().rounds
    py_trees.logging.level = py_trees.logging.Level.WARN
    changing(rounds)
    ratios: dict[str, tuple[float, float]] = {}
    for name, (what, root) in TREES.items():
        taken = compared(root, rounds, fresh=name == "T5")
        ratios[name] = taken["py_trees"] / taken["btlang"], taken["py_trees"] / taken["traced"]
        told = ", ".join(f"{who} {taken[who] * 1e6:,.2f} µs" for who in taken)
        print(f"{name} {what}, {sum(1 for _ in nodes(root)):,} nodes: {told}")
    depths(rounds)
    size(rounds)
    print("with every status change sent to the event stream:")
    for name, (_, traced) in ratios.items():
        print(f"  {name} {traced:.1f}")
    for name, (plain, _) in ratios.items():
        print(f"{name} {plain:.1f}")


if __name__ == "__main__":
    main()
