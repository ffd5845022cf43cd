"""The engine does what py_trees 2.6 does, on random trees of the node types that mean the same in both.

The section "py_trees" of docs/engine.md says which do not, and why; each of its rows is shown here.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from itertools import cycle
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from py_trees import composites, decorators
from py_trees.behaviour import Behaviour
from py_trees.blackboard import Blackboard
from py_trees.common import OneShotPolicy, ParallelPolicy, Status

from btlang.tree.node import Node

from .scripted import STATUS, World, n

PAGE = Path(__file__).parents[2] / "docs" / "engine.md"
STATUSES = {"r": Status.RUNNING, "s": Status.SUCCESS, "f": Status.FAILURE}
LETTERS = {status: letter for letter, status in STATUSES.items()}


class Script:
    """What a leaf returns: each run takes the next of some words, each call in it the next letter."""

    def __init__(self, id: str, words: str, log: list[str]) -> None:
        self.id, self.log = id, log
        self.is_function = id.startswith("F")
        self.words = cycle(words.split(","))
        self.letters = iter("")

    def call(self, step: str) -> str:
        if self.is_function:
            self.log.append(self.id)
            return next(self.words)
        self.log.append(f"{self.id}.{step}")
        if step == "start":
            self.letters = iter(next(self.words))
        return next(self.letters)


class TheirLeaf(Behaviour):
    """A behaviour that is halted where it is stopped while RUNNING; py_trees stops what has completed as well."""

    def __init__(self, script: Script) -> None:
        super().__init__(script.id)
        self.script = script
        self.step = ""

    def initialise(self) -> None:
        self.step = "start"

    def update(self) -> Status:
        letter = self.script.call(self.step)
        self.step = "tick"
        return STATUSES[letter]

    def terminate(self, new_status: Status) -> None:
        if self.status == Status.RUNNING and new_status == Status.INVALID and not self.script.is_function:
            self.script.log.append(f"{self.name}.halt")


def bind(world: World, id: str, words: str) -> Node:
    """Our leaf: a function where the id begins with F, else a class."""
    script = Script(id, words, world.log)
    if script.is_function:
        return world.bind(id, lambda: STATUS[script.call("")])

    class Leaf:
        def start(self) -> int:
            return STATUS[script.call("start")]

        def tick(self) -> int:
            return STATUS[script.call("tick")]

        def halt(self) -> None:
            world.log.append(f"{id}.halt")

    return world.bind(id, Leaf)


def on_all(children: Sequence[Behaviour]) -> Behaviour:
    return composites.Parallel("", ParallelPolicy.SuccessOnAll(synchronise=True), children)


SAME: dict[str, Callable[[list[Behaviour], Node], Behaviour]] = {
    "Sequence": lambda children, node: composites.Sequence("", True, children),
    "Fallback": lambda children, node: composites.Selector("", True, children),
    "ReactiveSequence": lambda children, node: composites.Sequence("", False, children),
    "ReactiveFallback": lambda children, node: composites.Selector("", False, children),
    "Parallel": lambda children, node: on_all(children),
    "ParallelAll": lambda children, node: on_all(children),
    "Inverter": lambda children, node: decorators.Inverter("", *children),
    "ForceSuccess": lambda children, node: decorators.FailureIsSuccess("", *children),
    "ForceFailure": lambda children, node: decorators.SuccessIsFailure("", *children),
    "KeepRunningUntilFailure": lambda children, node: decorators.SuccessIsRunning("", *children),
    "RunOnce": lambda children, node: decorators.OneShot("", *children, OneShotPolicy.ON_COMPLETION),
    "Repeat": lambda children, node: decorators.Repeat("", *children, int(node.port("num_cycles"))),
    "RetryUntilSuccessful": lambda children, node: decorators.Retry("", *children, int(node.port("num_attempts"))),
}
"""The node of py_trees that means the same, by ours; see the strategies below for the limits."""

CONDITIONS = st.lists(st.sampled_from("rsf"), min_size=1, max_size=4).map(lambda w: Node("F:" + ",".join(w)))
ANSWERS = st.lists(st.sampled_from("sf"), min_size=1, max_size=4).map(lambda w: Node("F:" + ",".join(w)))


def actions(shortest: int) -> st.SearchStrategy[Node]:
    """Actions that are RUNNING for at least so many calls."""
    runs = st.tuples(st.integers(shortest, 3), st.sampled_from("sf")).map(lambda run: "r" * run[0] + run[1])
    return st.lists(runs, min_size=1, max_size=3).map(lambda words: Node("C:" + ",".join(words)))


def one_of(ids: str, children: st.SearchStrategy[Node], most: int) -> st.SearchStrategy[Node]:
    return st.tuples(st.sampled_from(ids.split()), st.lists(children, min_size=1, max_size=most)).map(
        lambda drawn: n(drawn[0], *drawn[1])
    )


def rounds(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    """Loops over what completes within one tick."""
    return st.one_of(
        st.tuples(children, st.sampled_from((-1, 1, 2, 3))).map(lambda d: n("Repeat", d[0], num_cycles=d[1])),
        st.tuples(children, st.integers(1, 3)).map(lambda d: n("RetryUntilSuccessful", d[0], num_attempts=d[1])),
    )


INSTANT = st.recursive(ANSWERS, lambda c: one_of("Sequence Fallback", c, 3) | one_of("Inverter", c, 1), max_leaves=3)


def trees(leaves: st.SearchStrategy[Node], controls: str) -> st.SearchStrategy[Node]:
    def parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
        unfailing = children.map(lambda child: n("ForceSuccess", child))
        return st.one_of(
            one_of(controls, children, 4),
            one_of(controls, children, 4),
            one_of("Parallel ParallelAll", unfailing, 3),
            one_of("Inverter ForceSuccess ForceFailure KeepRunningUntilFailure", children, 1),
            children.map(lambda child: n("RunOnce", child, then_skip="false")),
            rounds(INSTANT),
            *([st.tuples(ANSWERS, children).map(lambda d: n("EternalGuard", *d))] if "Reactive" in controls else []),
        )

    return st.recursive(st.one_of(leaves, CONDITIONS), parents, max_leaves=12)


class Twins:
    """The same tree in both; leaves that are alike and a log for each."""

    def __init__(self, shape: Node) -> None:
        self.world = World()
        self.log: list[str] = []
        self.leaves = 0
        ours, self.theirs = self._made(shape)
        self.ours = self.world.engine(ours)

    def _made(self, shape: Node) -> tuple[Node, Behaviour]:
        if ":" in shape.id:
            kind, words = shape.id.split(":")
            id = f"{kind}{self.leaves}"
            self.leaves += 1
            return bind(self.world, id, words), TheirLeaf(Script(id, words, self.log))
        pairs = [self._made(child) for child in shape.children]
        ours = [our for our, _ in pairs]
        theirs = [their for _, their in pairs]
        if shape.id == "EternalGuard":
            condition, guarded = theirs
            return n("ReactiveSequence", *ours), decorators.EternalGuard("", guarded, lambda: condition.update())
        return Node(shape.id, tuple(ours), shape.ports), SAME[shape.id](theirs, shape)

    def step(self, order: str) -> tuple[list[str], list[str]]:
        """Ticks or halts both, compares the statuses, and returns what each has logged."""
        self.log.clear()
        self.world.log.clear()
        if order == "h":
            self.ours.halt()
            self.theirs.stop(Status.INVALID)
        else:
            self.theirs.tick_once()
            assert self.world.ticks(self.ours, 1) == LETTERS[self.theirs.status]
        return self.world.log, self.log


ORDERS = st.text("ttttth", min_size=3, max_size=12)


@settings(max_examples=500)
@given(trees(actions(0), "Sequence Fallback"), ORDERS)
def test_trees_that_ask_once(shape: Node, orders: str) -> None:
    twins = Twins(shape)
    for order in orders:
        ours, theirs = twins.step(order)
        assert ours == theirs


@settings(max_examples=1000)
@given(trees(actions(1), "Sequence Fallback ReactiveSequence ReactiveFallback"), ORDERS)
def test_trees_with_reactive_nodes(shape: Node, orders: str) -> None:
    """Here the halts of a tick come before the starts, there after them; otherwise all is the same."""
    twins = Twins(shape)
    for order in orders:
        ours, theirs = twins.step(order)
        assert without_halts(ours) == without_halts(theirs)
        assert sorted(ours) == sorted(theirs)


def without_halts(log: list[str]) -> list[str]:
    return [call for call in log if not call.endswith(".halt")]


# What is not the same


class Both:
    """Leaves A, B, C ... for a tree of theirs and one of ours; a function `FA` where the words are in small letters."""

    def __init__(self, *words: str) -> None:
        self.world = World()
        self.log: list[str] = []
        named = [(id if text.isupper() else f"F{id}", text.lower()) for id, text in zip("ABC", words, strict=False)]
        self.our_leaves = [bind(self.world, id, text) for id, text in named]
        self.their_leaves = [TheirLeaf(Script(id, text, self.log)) for id, text in named]

    def theirs(self, make: Callable[..., Behaviour], ticks: int) -> str:
        """What each tick of `make(*leaves)` returns and calls, as in `r: A.start; s: A.tick`."""
        root = make(*self.their_leaves)

        def tick() -> str:
            root.tick_once()
            return LETTERS[root.status]

        return self._played(tick, self.log, ticks)

    def ours(self, id: str, ticks: int, **ports: object) -> str:
        engine = self.world.engine(n(id, *self.our_leaves, **ports))
        return self._played(lambda: self.world.ticks(engine, 1), self.world.log, ticks)

    def _played(self, tick: Callable[[], str], log: list[str], ticks: int) -> str:
        words = []
        for _ in range(ticks):
            log.clear()
            words.append(f"{tick()}: {' '.join(log)}".strip())
            self.world.clock.advance(1)
        return "; ".join(words)


def parallel(policy: ParallelPolicy.Base) -> Callable[..., Behaviour]:
    return lambda *children: composites.Parallel("", policy, children)


def reactive_actions() -> None:
    both = Both("F,RS", "RS")
    assert both.theirs(lambda *c: composites.Selector("", False, c), 2) == "r: A.start B.start; r: A.start B.halt"
    assert both.ours("ReactiveFallback", 2) == "r: A.start B.start; r: B.halt A.start"
    both = Both("F", "RRS")
    assert both.theirs(lambda *c: composites.Selector("", False, c), 2) == "r: A.start B.start; r: A.start B.tick"
    assert both.ours("ReactiveFallback", 2) == "r: A.start B.start; r: B.halt A.start B.start"


def parallel_with_failures() -> None:
    both = Both("f", "s")
    assert both.theirs(parallel(ParallelPolicy.SuccessOnAll(synchronise=True)), 1) == "f: FA FB"
    assert both.ours("Parallel", 1) == "f: FA"
    both = Both("r,f", "f,s")
    assert both.theirs(parallel(ParallelPolicy.SuccessOnAll(synchronise=True)), 1) == "f: FA FB"
    assert both.ours("ParallelAll", 2) == "r: FA FB; f: FA"


def parallel_that_is_not_synchronised() -> None:
    both = Both("s", "r,s")
    assert both.theirs(parallel(ParallelPolicy.SuccessOnAll(synchronise=False)), 2) == "r: FA FB; s: FA FB"
    assert both.ours("Parallel", 2) == "r: FA FB; s: FB"


def parallel_on_one() -> None:
    both = Both("s", "f")
    assert both.theirs(parallel(ParallelPolicy.SuccessOnOne()), 1) == "f: FA FB"
    assert both.ours("Parallel", 1, success_count=1, failure_count=-1) == "s: FA"


def parallel_on_selected() -> None:
    both = Both("r", "s")
    policy = ParallelPolicy.SuccessOnSelected
    assert both.theirs(lambda *c: composites.Parallel("", policy([c[1]]), c), 1) == "s: FA FB"
    assert both.ours("Parallel", 1, success_count=1) == "s: FA FB"
    both = Both("s", "r")
    assert both.theirs(lambda *c: composites.Parallel("", policy([c[1]]), c), 1) == "r: FA FB"
    assert both.ours("Parallel", 1, success_count=1) == "s: FA"


def repeat() -> None:
    both = Both("RS")
    rounds = "r: A.start; r: A.tick; r: A.start; s: A.tick"
    assert both.theirs(lambda child: decorators.Repeat("", child, 2), 4) == rounds
    assert both.ours("Repeat", 3, num_cycles=2) == "r: A.start; r: A.tick A.start; s: A.tick"
    assert Both("s").theirs(lambda child: decorators.Repeat("", child, 0), 2) == "r: FA; r: FA"
    assert Both("s").ours("Repeat", 1, num_cycles=0) == "s:"


def retry() -> None:
    both = Both("RF")
    attempts = "r: A.start; r: A.tick; r: A.start; f: A.tick"
    assert both.theirs(lambda child: decorators.Retry("", child, 2), 4) == attempts
    assert both.ours("RetryUntilSuccessful", 3, num_attempts=2) == "r: A.start; r: A.tick A.start; f: A.tick"
    assert Both("f").theirs(lambda child: decorators.Retry("", child, -1), 1) == "f: FA"
    assert Both("f").ours("RetryUntilSuccessful", 2, num_attempts=-1) == "r: FA; r: FA"


def failure_is_running() -> None:
    both = Both("RF,RS")
    theirs = "r: A.start; r: A.tick; r: A.start; s: A.tick"
    assert both.theirs(lambda child: decorators.FailureIsRunning("", child), 4) == theirs
    assert both.ours("RetryUntilSuccessful", 3, num_attempts=-1) == "r: A.start; r: A.tick A.start; s: A.tick"


def running_is() -> None:
    assert Both("RS").theirs(lambda child: decorators.RunningIsSuccess("", child), 1) == "s: A.start A.halt"
    assert Both("RS").theirs(lambda child: decorators.RunningIsFailure("", child), 1) == "f: A.start A.halt"
    assert Both("RRS").ours("Timeout", 2, msec=1) == "r: A.start; f: A.halt"


def one_shot() -> None:
    policy = OneShotPolicy.ON_SUCCESSFUL_COMPLETION
    both = Both("f,s")
    assert both.theirs(lambda child: decorators.OneShot("", child, policy), 3) == "f: FA; s: FA; s:"
    assert both.ours("RunOnce", 3, then_skip="false") == "f: FA; f:; f:"


def timeout() -> None:
    both = Both("RRRS")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(decorators.time, "monotonic", lambda: both.world.clock.now)
        theirs = both.theirs(lambda child: decorators.Timeout("", child, duration=1.5), 3)
    assert theirs == "r: A.start; r: A.tick; f: A.tick A.halt"
    both.world.clock.now = 0
    assert both.ours("Timeout", 3, msec=1500) == "r: A.start; r: A.tick; f: A.halt"


def for_each() -> None:
    Blackboard.set("items", [1, 2])
    both = Both("s")
    assert both.theirs(lambda child: decorators.ForEach("", child, "items", "item"), 2) == "r: FA; s: FA"
    assert both.ours("LoopString", 3, queue="1;2") == "r: FA; r: FA; s:"
    Blackboard.set("items", [])
    assert Both("s").theirs(lambda child: decorators.ForEach("", child, "items", "item"), 1) == "s: FA"
    assert Both("s").ours("LoopString", 1, queue="{gone}") == "s:"
    Blackboard.clear()


def condition() -> None:
    theirs = Both("s,f").theirs(lambda child: decorators.Condition("", child, Status.FAILURE), 2)
    assert theirs == "r: FA; s: FA"
    assert Both("s,f").ours("Inverter", 2) == "f: FA; s: FA"


def recorders() -> None:
    for make in (
        lambda child: decorators.Count("", child),
        lambda child: decorators.PassThrough("", child),
        lambda child: decorators.StatusToBlackboard("", child, "status"),
    ):
        assert Both("RF").theirs(make, 2) == "r: A.start; f: A.tick"
    assert Blackboard.get("status") == Status.FAILURE
    Blackboard.clear()


def exceptions() -> None:
    def lost() -> None:
        raise ValueError("lost")

    class Lost(Behaviour):
        def update(self) -> Status:
            raise ValueError("lost")

    world = World()
    assert world.ticks(world.engine(world.bind("A", lost)), 1) == "f"
    with pytest.raises(ValueError, match="lost"):
        Lost("A").tick_once()


def skipped() -> None:
    assert {status.name for status in Status} == {"RUNNING", "SUCCESS", "FAILURE", "INVALID"}
    world = World()
    assert world.ticks(world.engine(n("Sequence", world.fn("A", "k"), world.fn("B", "k"))), 1) == "k"


SHOWN = {
    "`Sequence` and `Selector` with `memory=False`": reactive_actions,
    "`Parallel` of children that fail": parallel_with_failures,
    "`SuccessOnAll(synchronise=False)`": parallel_that_is_not_synchronised,
    "`SuccessOnOne`": parallel_on_one,
    "`SuccessOnSelected`": parallel_on_selected,
    "`Repeat`": repeat,
    "`Retry`": retry,
    "`FailureIsRunning`": failure_is_running,
    "`RunningIsSuccess`, `RunningIsFailure`": running_is,
    "`OneShot` with `ON_SUCCESSFUL_COMPLETION`": one_shot,
    "`Timeout`": timeout,
    "`ForEach`": for_each,
    "`Condition`": condition,
    "`Count`, `PassThrough`, `StatusToBlackboard`": recorders,
    "an exception in a leaf": exceptions,
    "SKIPPED": skipped,
}


@pytest.mark.parametrize("show", SHOWN.values(), ids=lambda show: show.__name__)
def test_difference(show: Callable[[], None]) -> None:
    show()


def section() -> str:
    text = PAGE.read_text(encoding="utf-8")
    return text[text.index("## py_trees") :].split("\n## ")[0]


def test_each_row_of_the_page_is_shown() -> None:
    rows = [line.split("|")[1].strip() for line in section().splitlines() if line.startswith("| ")]
    assert rows[0] == "py_trees"
    assert rows[1:] == list(SHOWN)


def test_no_type_of_either_is_left_out() -> None:
    named = set(re.findall(r"\w+", section()))
    for module in (composites, decorators):
        types = {
            name for name, kind in inspect.getmembers(module, inspect.isclass) if kind.__module__ == module.__name__
        }
        assert types - named <= {"Composite", "Decorator"}
    assert set(SAME) <= named
