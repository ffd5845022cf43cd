"""Why a tree failed: which node is named, with what reason, and what the nodes around it add."""

from __future__ import annotations

from itertools import count, cycle

import pytest

from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.tree.node import Node

from .scripted import World, n, said

A, B, C = Node("A"), Node("B"), Node("C")
LATE = n("Timeout", A, msec=1000)
NO_BRANCH = "its condition was false, and it has no other branch"
BROKEN = "its guard failed on the way"


def bind(world: World, id: str, script: str) -> None:
    """A leaf that returns the statuses of a script; the reason of its n-th failure is `A1`, `A2` ..."""
    letters, number = cycle(script), count(1)

    def call() -> int:
        status = said(next(letters))
        if status == FAILURE:
            raise ActionFailed(f"{id}{next(number)}")
        return status

    world.bind(id, call)


def run(root: Node, scripts: str) -> Engine:
    """Ticks the tree until it completes; a second passes after each tick."""
    world = World()
    for id, script in zip("ABC", scripts.split(), strict=False):
        bind(world, id, script)
    engine = world.engine(root)
    while engine.tick() == RUNNING:
        assert engine.failure is None
        world.clock.advance(1)
    return engine


@pytest.mark.parametrize(
    ("root", "scripts", "path", "reason", "around"),
    [
        (n("Sequence", A, B, C), "s f s", "/1", "B1", []),
        (n("Fallback", A, B, C), "f f f", "/2", "C1", []),
        (n("Fallback", A, n("Inverter", B), C), "f s k", "/1", "it is true", []),
        (n("Fallback", A, n("IfThenElse", B, C, n("AlwaysSuccess", _skipIf="true"))), "f f s", "/0", "A1", []),
        (n("Fallback", A, n("WhileDoElse", B, C, n("AlwaysSuccess", _skipIf="true"))), "f f s", "/0", "A1", []),
        (n("Fallback", A, n("Whenever", B, C, n("AlwaysSuccess", _skipIf="true"))), "f f s", "/0", "A1", []),
        (n("SequenceWithMemory", A, B), "s f", "/1", "B1", []),
        (n("ReactiveSequence", A, B), "sf r", "/0", "A1", [("/", BROKEN)]),
        (n("ReactiveSequence", A, B), "s rf", "/1", "B1", []),
        (n("ReactiveFallback", A, B), "f rf", "/1", "B1", []),
        (n("Parallel", A, B, C), "r f f", "/1", "B1", []),
        (n("Parallel", A, B, success_count=1, failure_count=2), "f f", "/1", "B1", [("/", "2 of 2 failed")]),
        (n("Parallel", A, n("ForceSuccess", B), success_count=2), "rf f", "/0", "A1", []),
        (n("Parallel", A, B, failure_count=0), "s s", "/", "its failure_count allows no child to run", []),
        (n("ParallelAll", A, n("Fallback", B, C)), "f rf s", "/0", "A1", []),
        (n("ParallelAll", A, B), "f rf", "/0", "A1", [("/", "2 of 2 failed")]),
        (n("ParallelAll", A, B, C, max_failures=2), "f f rf", "/1", "B1", [("/", "3 of 3 failed")]),
        (n("ParallelAll", A, max_failures=0), "s", "/", "its max_failures allows no success", []),
        (n("IfThenElse", A, B), "f s", "/0", "A1", [("/", NO_BRANCH)]),
        (n("IfThenElse", A, B), "k s", "/", "its condition was skipped", []),
        (n("IfThenElse", A, B, C), "f s f", "/2", "C1", []),
        (n("WhileDoElse", A, B), "sf r", "/0", "A1", [("/", NO_BRANCH)]),
        (n("WhileDoElse", A, B), "sk r", "/", "its condition was skipped", []),
        (n("WhileDoElse", A, B, C), "f s f", "/2", "C1", []),
        (n("Switch2", A, B, C, variable="2", case_1="1", case_2="2"), "s f s", "/1", "B1", []),
        (n("TryCatch", A, B), "f f", "/0", "A1", []),
        (n("TryCatch", LATE, B), "r rrf", "/0", "took longer than 1 s", []),
        (n("Whenever", A, B, C), "s f r", "/1", "B1", [("/", "its reaction failed")]),
        (n("Whenever", A, B, C), "f s f", "/2", "C1", []),
        (n("PipelineSequence", A, B), "sf r", "/0", "A1", []),
        (n("RecoveryNode", A, B), "f s", "/0", "A2", [("/", "1 recovery did not help")]),
        (n("RecoveryNode", A, B, number_of_retries=2), "f s", "/0", "A3", [("/", "2 recoveries did not help")]),
        (n("RecoveryNode", A, B), "f f", "/1", "B1", [("/", "its recovery failed")]),
        (n("RecoveryNode", A, B), "f k", "/0", "A1", [("/", "its recovery was skipped")]),
        (n("RecoveryNode", A, B, number_of_retries=0), "f s", "/0", "A1", []),
        (n("RoundRobin", A, B), "f f", "/1", "B1", []),
        (n("Inverter", A), "s", "/", "it is true", []),
        (n("Inverter", n("Fallback", A, B)), "f s", "/", "it is true", []),
        (n("ForceFailure", A), "s", "/", "it turns success into failure", []),
        (n("ForceFailure", A), "f", "/0", "A1", []),
        (n("Repeat", A, num_cycles=3), "sf", "/0", "A1", [("/", "in round 2 of 3")]),
        (n("Repeat", A, num_cycles=-1), "ssf", "/0", "A1", [("/", "in round 3")]),
        (n("Repeat", A, num_cycles=3), "f", "/0", "A1", []),
        (n("RetryUntilSuccessful", A, num_attempts=3), "f", "/0", "A3", [("/", "all 3 attempts failed")]),
        (n("RetryUntilSuccessful", A, num_attempts=1), "f", "/0", "A1", []),
        (n("RetryUntilSuccessful", A, num_attempts=0), "f", "/", "it allows no attempt", []),
        (n("KeepRunningUntilFailure", A), "sf", "/0", "A1", []),
        (n("Timeout", A, msec=1500), "r", "/", "took longer than 1.5 s", []),
        (n("Timeout", n("KeepRunningUntilFailure", A), msec=1500), "s", "/", "took longer than 1.5 s", []),
        (n("Timeout", A, msec=1500), "f", "/0", "A1", []),
        (n("Timeout", A, msec="{gone}"), "f", "/", "{gone} has no value", []),
        (n("Delay", A, delay_msec=1000), "f", "/0", "A1", []),
        (n("Sequence", n("Precondition", A, **{"if": "1 > 2"})), "s", "/0", "this is not true: 1 > 2", []),
        (n("WasEntryUpdated", entry="{x}"), "", "/", "nothing has been written to {x} since the last check", []),
        (n("LoopInt", A, queue="", if_empty="FAILURE"), "s", "/", "its queue is empty", []),
        (n("LoopInt", A, queue="1;2"), "sf", "/0", "A1", []),
        (n("RateController", A, hz=1), "f", "/0", "A1", []),
        (n("ScriptCondition", code="1 > 2"), "", "/", "this is not true: 1 > 2", []),
        (n("AlwaysFailure"), "", "/", "the mission says so", []),
        (n("Sequence", A, _onFailure="x := gone"), "f", "/0", "A1", [("/", "{gone} has no value")]),
        (n("Sequence", A, _post="x := gone"), "s", "/", "{gone} has no value", []),
        (
            n("Repeat", n("Sequence", n("RetryUntilSuccessful", A, num_attempts=2)), num_cycles=2),
            "sff", "/0/0/0", "A2", [("/0/0", "both attempts failed"), ("/", "in round 2 of 2")],
        ),
    ],
)  # fmt: skip
def test_what_is_named(root: Node, scripts: str, path: str, reason: str, around: list[tuple[str, str]]) -> None:
    failure = run(root, scripts).failure
    assert failure is not None
    assert (failure.path, failure.reason) == (path, reason)
    assert [(other.path, other.reason) for other in failure.around] == around


def test_a_run_that_is_not_repeated_fails_for_its_old_reason() -> None:
    world = World()
    bind(world, "A", "f")
    bind(world, "B", "f")
    engine = world.engine(n("Sequence", n("ForceSuccess", B), n("RunOnce", A, then_skip="false")))
    for around in ([], [("/1", "its one run had failed")]):
        engine.tick()
        failure = engine.failure
        assert failure is not None
        assert (failure.path, failure.reason) == ("/1/0", "A1")
        assert [(other.path, other.reason) for other in failure.around] == around


def test_each_node_is_asked_for_its_own_reason() -> None:
    engine = run(n("Repeat", n("RetryUntilSuccessful", n("Sequence", A), num_attempts=2), num_cycles=2), "sff")
    assert [engine.reason(index) for index in range(4)] == ["in round 2 of 2", "both attempts failed", "", "A2"]


def test_failures_without_end_are_not_kept() -> None:
    world = World()
    bind(world, "A", "f")
    engine = world.engine(n("Inverter", n("RetryUntilSuccessful", n("IfThenElse", A, A), num_attempts=2)))
    for _ in range(50):
        assert engine.tick() in (RUNNING, SUCCESS)
    fault, depth = engine._state.fault, 0
    while fault is not None:
        fault, depth = fault.cause, depth + 1
    assert depth == 3
