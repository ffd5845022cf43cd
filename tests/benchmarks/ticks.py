"""How fast trees are ticked, beside py_trees: `python -m tests.benchmarks.ticks [--rounds 15]`.

Both run the same tree, with leaves that do nothing, written as each documents it: here functions, and generators or
classes for what takes time; there behaviours. A tick is `Engine.tick` and `BehaviourTree.tick`. Ratios are those of
medians of rounds in which all take turns. The last lines are the ratios without a listener; before them stand those
with every status change sent to the event stream, what depth does to a tick, and what a node costs.

In most of these trees the statuses soon stay as they are. So before all this stand trees in which nearly all of them
change at each tick: alone, with the changes sent to the event stream, and with what each run has follow them.
"""

from __future__ import annotations

import argparse
import gc
import time
import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial
from random import Random
from statistics import median

import py_trees
from py_trees.common import Status

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import LeafBinding
from btlang.run.bus import Bus
from btlang.run.events import Event
from btlang.run.failure_history import FailureHistory
from btlang.run.follower import RunFollower
from btlang.run.recent import RecentEvents
from btlang.run.runner import trace_engine
from btlang.tree.node import Node, Tree
from tests.benchmarks.compile import medians, seconds

CONDITIONS, RUNNERS, ACTIONS = 10, 50, 10_000
MIX, DEPTH = 1_000, 6
BIG = 100_000
DEEP = (10, 100, 1_000)


def run() -> Iterator[None]:
    """An action that never completes."""
    while True:
        yield


class Wait:
    """An action that never completes, as a class."""

    def start(self) -> None: ...

    def tick(self) -> None: ...

    def halt(self) -> None: ...


KEY = "x"
"""A value of the blackboard that leaves read at each tick."""
BINDINGS = {
    "Yes": LeafBinding(lambda: True),
    "No": LeafBinding(lambda: False),
    "Act": LeafBinding(lambda: None),
    "Run": LeafBinding(run),
    "Wait": LeafBinding(Wait),
    "Keyed": LeafBinding(lambda value: True, {"value": float}),
}


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


def n(id: str, *children: Node) -> Node:
    return Node(id, children=children)


def mix() -> Node:
    """MIX nodes of depth DEPTH, all of which a tick visits: conditions, actions, sequences, fallbacks, decorators."""
    random, left = Random(7), MIX

    def grown(depth: int, succeeds: bool, share: int) -> Node:
        """A tree of about `share` nodes that completes at once."""
        nonlocal left
        left -= 1
        if depth == DEPTH or share < 3:
            return n(random.choice(("Yes", "Act")) if succeeds else "No")
        if random.random() < 0.15:
            return n("Inverter", grown(depth + 1, not succeeds, share - 1))
        kind = random.choice(("Sequence", "Fallback", "Parallel") if succeeds else ("Sequence", "Fallback"))
        count = min(random.randint(3, 6), share)
        passes = kind != "Fallback"
        shares = (share - 1) // count
        children = [grown(depth + 1, passes, shares) for _ in range(count - 1)]
        return n(kind, *children, grown(depth + 1, succeeds, shares))

    children: list[Node] = []
    while left > 0:
        children.append(grown(1, True, min(left, 4 * MIX)))
    return n("Sequence", *children)


TREES: dict[str, tuple[str, Node]] = {
    "T1": (
        f"resumed leaf behind {CONDITIONS} conditions",
        n("Sequence", *[n("Yes")] * CONDITIONS, n("Run")),
    ),
    "T2": (f"fresh tick of about {MIX:,} nodes of depth {DEPTH}", mix()),
    "T3": (f"reactive guard of {CONDITIONS} conditions", n("ReactiveSequence", *[n("Yes")] * CONDITIONS, n("Run"))),
    "T4": (f"parallel of {RUNNERS} running leaves", n("Parallel", *[n("Run")] * RUNNERS)),
    "T5": (f"sequence of {ACTIONS:,} actions run to the end", n("Sequence", *[n("Act")] * ACTIONS)),
    "T6": (f"parallel of {RUNNERS} running classes", n("Parallel", *[n("Wait")] * RUNNERS)),
    "T7": (
        f"reactive guard of {CONDITIONS} conditions with a port from the blackboard",
        n("ReactiveSequence", *[Node("Keyed", ports=(("value", f"{{{KEY}}}"),))] * CONDITIONS, n("Run")),
    ),
}


def engine(root: Node) -> Engine:
    """Without a listener."""
    made = Engine(Tree(root), BINDINGS.get, clock=Clock())
    made.blackboard.set(KEY, 1.5)
    return made


def nodes(root: Node) -> Iterator[Node]:
    stack = [root]
    while stack:
        node = stack.pop()
        yield node
        stack += node.children


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
            tick()
            times[name] = max(1, int(0.02 / seconds(tick)))
    taken: dict[str, list[float]] = {name: [] for name in made}
    for _ in range(rounds):
        for name in made:
            tick = makers[name]() if fresh else made[name]
            taken[name].append(seconds(partial(repeated, tick, times[name])) / times[name])
            told.clear()
    return {name: median(values) for name, values in taken.items()}


def again(child: Node) -> Node:
    return Node("Repeat", (child,), (("num_cycles", "-1"),))


ODD = [False]
"""Whether the number of the tick is odd."""
BINDINGS["Odd"] = LeafBinding(lambda: ODD[0])
CHANGING: dict[str, Node] = {
    f"{ACTIONS:,} actions in a loop": again(n("Sequence", *[n("Act")] * ACTIONS)),
    f"{ACTIONS // MIX} times T2 in a loop": again(n("Sequence", *[mix() for _ in range(ACTIONS // MIX)])),
    f"{ACTIONS // 12} times T3 in a loop": again(
        n("Sequence", *[n("ReactiveSequence", *[n("Yes")] * CONDITIONS, n("Act"))] * (ACTIONS // 12))
    ),
    f"{ACTIONS // 4:,} conditions that change": n(
        "ReactiveSequence", *[n("Fallback", n("Odd"), n("Yes"))] * (ACTIONS // 4), n("Run")
    ),
}


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
        for number in range(2 * rounds + 2):
            ODD[0] = number % 2 == 1
            if number == 2:  # at first all are new
                counts.clear()
            for each, tick in ticks.items():
                began = time.thread_time()
                tick()
                taken[each].append(time.thread_time() - began)
        changes = sum(counts) / (2 * rounds)
        alone, there, beside = (median(taken[each][2:]) for each in ticks)
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
        tick()
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
