"""Where py_trees does something else: each row of the section "py_trees" in docs/engine.md is shown."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from py_trees import composites, decorators
from py_trees.behaviour import Behaviour
from py_trees.blackboard import Blackboard
from py_trees.common import OneShotPolicy, ParallelPolicy, Status

from .scripted import World, n
from .test_py_trees import SAME
from .their_leaves import LETTERS, Script, TheirLeaf, bind

PAGE = Path(__file__).parents[2] / "docs" / "engine.md"


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
