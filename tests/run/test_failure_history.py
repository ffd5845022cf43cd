"""What is kept of what was tried, and how a failure is told of a tree that was not read from English."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import pytest

from btlang.engine.leaves.leaf import ActionFailed, LeafBinding
from btlang.engine.status import FAILURE, RUNNING
from btlang.run.bus import Bus
from btlang.run.failure_history import MOST, FailureHistory, failure_report
from btlang.run.runner import trace_engine
from btlang.text.source import Source, Span
from btlang.tree.node import Node, Tree

LATE, TURNED = "took longer than 2 s 2-2 x1", "it turns success into failure 0-0 x1"
A, B, C, D = Node("A"), Node("B"), Node("C"), Node("D")


def n(id: str, *children: Node, **ports: object) -> Node:
    return Node(id, children, tuple((port, str(text)) for port, text in ports.items()))


def retry(child: Node, times: int = -1) -> Node:
    return n("RetryUntilSuccessful", child, num_attempts=times)


class Run:
    """A tree whose leaves are generators with scripts such as `rrs`; a digit fails with it as the reason.

    A second passes after each tick.
    """

    def __init__(self, root: Node, **scripts: str) -> None:
        bus = Bus()
        self.clock = bus.clock
        engine = trace_engine(Tree(root), {id: self._leaf(script) for id, script in scripts.items()}.get, bus=bus)
        self.engine, self.story = engine, FailureHistory(engine)
        bus.add(self.story)

    def _leaf(self, script: str) -> LeafBinding:
        letters = cycle(script)

        def leaf() -> Any:
            while (letter := next(letters)) == "r":
                yield
            if letter != "s":
                raise ActionFailed(letter)

        return LeafBinding(leaf)

    def to_its_end(self) -> Run:
        while self.engine.tick() == RUNNING:
            self.clock.advance(1)
        return self

    @property
    def tried(self) -> list[str]:
        """The attempts as `A1 0-5 x3`: id and reason, first and last time, how many."""
        return [
            f"{self.engine.node(a.index).id}{a.reason} {a.first:g}-{a.last:g} x{a.times}" for a in self.story.tried.kept
        ]


@pytest.mark.parametrize(
    ("root", "scripts", "tried"),
    [
        (n("Sequence", A, B), ["s", "r1"], ["B1 1-1 x1"]),
        (n("Fallback", A, B, C), ["1", "r2", "3"], ["A1 0-0 x1", "B2 1-1 x1", "C3 1-1 x1"]),
        (n("Fallback", n("Sequence", A, B), C), ["s", "r1", "2"], ["B1 1-1 x1", "C2 1-1 x1"]),
        (n("Fallback", n("ForceFailure", A), B), ["s", "2"], ["ForceFailure" + TURNED, "B2 0-0 x1"]),
        (n("Fallback", n("Sequence", n("Fallback", A, B), C), D), ["1", "s", "3", "4"], ["C3 0-0 x1", "D4 0-0 x1"]),
        (n("Fallback", n("IfThenElse", A, B, C), D), ["1", "s", "3", "4"], ["C3 0-0 x1", "D4 0-0 x1"]),
        (n("Sequence", n("Fallback", A, B), C), ["1", "s", "3"], ["C3 0-0 x1"]),
        (n("Sequence", n("ForceSuccess", A), B), ["1", "2"], ["B2 0-0 x1"]),
        (n("RoundRobin", A, B), ["1", "r2"], ["A1 0-0 x1", "B2 1-1 x1"]),
        (retry(A, 3), ["r1"], ["A1 1-3 x3"]),
        (retry(A, 3), ["1"], ["A1 0-2 x3"]),
        (retry(n("Sequence", A, B), 3), ["s", "1"], ["B1 0-2 x3"]),
        (retry(A, 3), ["r1r2r1"], ["A2 2-2 x1", "A1 1-3 x2"]),
        (retry(n("Fallback", A, B), 2), ["r1", "r2"], ["A1 1-3 x2", "B2 2-4 x2"]),
        (n("Fallback", retry(A, 2), B), ["r1", "r2"], ["A1 1-2 x2", "B2 3-3 x1"]),
        (n("Timeout", retry(A), msec=2000), ["1"], ["A1 0-1 x2", "Timeout" + LATE]),
        (n("Timeout", retry(n("Sequence", A, B)), msec=2000), ["s", "r1"], ["B1 1-1 x1", "Timeout" + LATE]),
        (n("RecoveryNode", A, B), ["1", "rs"], ["A1 0-1 x2", "B 1-1 x1"]),
        (n("RecoveryNode", A, B), ["1", "r2"], ["A1 0-0 x1", "B2 1-1 x1"]),
        (n("ParallelAll", A, B), ["1", "r2"], ["A1 0-0 x1", "B2 1-1 x1"]),
        (n("WhileDoElse", A, B, C), ["1", "s", "r3"], ["C3 1-1 x1"]),
    ],
)  # fmt: skip
def test_what_was_tried(root: Node, scripts: list[str], tried: list[str]) -> None:
    run = Run(root, **dict(zip("ABCD", scripts, strict=False))).to_its_end()
    assert sorted(run.tried) == sorted(tried)
    assert [a.last for a in run.story.tried.kept] == sorted(a.last for a in run.story.tried.kept)


def test_nothing_is_told_of_what_has_not_failed() -> None:
    assert Run(n("Fallback", A, B), A="1", B="s").to_its_end().tried == []


def test_what_a_failure_stopped() -> None:
    run = Run(n("Parallel", A, B, C), A="r" * 9, B="s", C="rr3").to_its_end()
    [attempt] = run.story.tried.kept
    assert attempt.stopped == ((1, 2.0),)
    run = Run(n("Fallback", n("Timeout", A, msec=2000), B), A="r" * 9, B="rr2").to_its_end()
    assert [attempt.stopped for attempt in run.story.tried.kept] == [((2, 2.0),), ()]


def test_the_latest_different_failures_are_kept() -> None:
    reasons = "abcdefghijklmno"
    run = Run(retry(A, len(reasons)), A=reasons).to_its_end()
    assert [attempt.reason for attempt in run.story.tried.kept] == list(reasons[-MOST:])
    assert run.story.tried.dropped == len(reasons) - MOST
    assert "      ...  and 5 more before\n    5.0 s  A: f\n" in report(run)


def test_days_of_a_mission_are_not_kept() -> None:
    body = n("Fallback", retry(n("Sequence", A, n("Fallback", B, C)), 3), D)
    run = Run(n("Repeat", body, num_cycles=-1), A="rs", B="1234567890", C="rabcdefs", D="rs")
    sizes = []
    for _ in range(4000):
        assert run.engine.tick() != FAILURE
        run.clock.advance(1)
        held = [run.story._tried.values(), *(failed.values() for failed in run.story._failed.values())]
        sizes.append(sum(len(attempts.kept) + 1 for part in held for attempts in part))
    assert max(sizes) <= 8 * (MOST + 1)  # two for each node at most
    assert max(sizes[:2000]) >= max(sizes[2000:])


def report(run: Run) -> str:
    failure = run.engine.failure
    assert failure is not None
    return failure_report(failure, run.story, lambda node: node.id)


def test_a_tree_without_sentences_is_told_by_its_paths() -> None:
    run = Run(n("Sequence", A, n("Repeat", retry(n("Fallback", B, C), 2), num_cycles=2)), A="s", B="r1", C="2")
    assert report(run.to_its_end()).splitlines() == [
        "The mission failed after 2.0 s.",
        "/1/0/0/1: C",
        "  C: 2",
        "It was part of:",
        "  RetryUntilSuccessful: both attempts failed",
        "What had been tried before:",
        "    1.0 s  B: 1 (2 times, last at 2.0 s)",
        "    1.0 s  C: 2",
    ]


def test_only_a_recovery_that_was_done_has_no_reason() -> None:
    run = Run(n("RecoveryNode", A, B, number_of_retries=2), A="1", B="rs").to_its_end()
    assert report(run).splitlines()[3:] == [
        "It was part of:",
        "  RecoveryNode: 2 recoveries did not help",
        "What had been tried before:",
        "    0.0 s  A: 1 (2 times, last at 1.0 s)",
        "    1.0 s  B: done, but it didn't help (2 times, last at 2.0 s)",
    ]


def test_of_a_not_it_is_told_what_it_denies() -> None:
    run = Run(n("Fallback", n("Inverter", A), n("Inverter", n("Inverter", n("Inverter", B)))), A="s", B="s")
    assert report(run.to_its_end()).splitlines()[1:] == [
        "/1: Inverter",
        "  Inverter: it is true",
        "What had been tried before:",
        "    0.0 s  A: it is true",
    ]


def test_sentences_of_other_files_and_long_ones() -> None:
    one, two = Source("first\nsecond", "one.txt"), Source("x" * 100, "two.txt")
    a, b = Node("A", span=Span(two, 0, 100)), Node("B", span=Span(one, 6, 12))
    run = Run(n("Fallback", Node("C", span=Span(one, 0, 5)), a, b), A="1", B="r2", C="3").to_its_end()
    assert report(run).splitlines() == [
        "The mission failed after 1.0 s.",
        "one.txt:2:1: B",
        "  second",
        "  ^^^^^^",
        "  B: 2",
        "What had been tried before:",
        "    0.0 s  C (line 1): 3",
        "    0.0 s  A (two.txt:1): 1",
    ]
    run = Run(n("Fallback", Node("ForceFailure", (A,), span=Span(two, 0, 100)), b), A="s", B="r2").to_its_end()
    assert f"    0.0 s  {'x' * 57}... (two.txt:1): it turns success into failure" in report(run)
