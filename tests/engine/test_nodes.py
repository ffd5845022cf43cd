"""Each node type: statuses of successive ticks and the calls of its leaves. Letters: r s f k as in scripted.py."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from btlang.engine.status import RUNNING
from btlang.tree.node import Node

from .scripted import World, leaves, n


def run(id: str, scripts: str, ticks: int, **ports: object) -> tuple[str, str]:
    """Ticks a node over leaves A, B, C (capitals: class leaves); gives its letters and the log in one string."""
    world = World()
    engine = world.engine(n(id, *leaves(world, scripts.split()), **ports))
    return world.ticks(engine, ticks), " ".join(world.log)


@pytest.mark.parametrize(
    ("id", "scripts", "statuses", "log"),
    [
        ("Sequence", "s s", "s", "A B"),
        ("Sequence", "s f s", "f", "A B"),
        ("Sequence", "s rs s", "rs", "A B B C"),
        ("Sequence", "k s", "s", "A B"),
        ("Sequence", "k k", "k", "A B"),
        ("Sequence", "sk kf", "sf", "A B A B"),
        ("Sequence", "s rf", "rfr", "A B B A B"),
        ("Fallback", "f s f", "s", "A B"),
        ("Fallback", "f f", "f", "A B"),
        ("Fallback", "f rs", "rs", "A B B"),
        ("Fallback", "k f", "f", "A B"),
        ("Fallback", "k k", "k", "A B"),
        ("AsyncSequence", "s s s", "rrs", "A B C"),
        ("AsyncSequence", "s rs s", "rrs", "A B B C"),
        ("AsyncSequence", "k s", "s", "A B"),
        ("AsyncFallback", "f f", "rf", "A B"),
        ("AsyncFallback", "f s", "rs", "A B"),
        ("SequenceWithMemory", "s fs s", "rfrs", "A B B C"),
        ("SequenceWithMemory", "sf s", "rsf", "A B A"),
        ("SequenceWithMemory", "k k", "k", "A B"),
        ("ReactiveSequence", "s rs", "rs", "A B A B"),
        ("ReactiveSequence", "sf R", "rf", "A B.start A B.halt"),
        ("ReactiveSequence", "k k", "k", "A B"),
        ("ReactiveSequence", "k s", "s", "A B"),
        ("ReactiveFallback", "fs R", "rs", "A B.start A B.halt"),
        ("ReactiveFallback", "f rf", "rf", "A B A B"),
        ("ReactiveFallback", "k k", "k", "A B"),
        ("ReactiveFallback", "fr R", "rr", "A B.start A B.halt"),
        ("IfThenElse", "s s s", "s", "A B"),
        ("IfThenElse", "f s f", "f", "A C"),
        ("IfThenElse", "f s", "f", "A"),
        ("IfThenElse", "sf rs f", "rsf", "A B B A C"),
        ("IfThenElse", "rs s s", "rs", "A A B"),
        ("IfThenElse", "k s s", "f", "A"),
        ("IfThenElse", "s k s", "k", "A B"),
        ("WhileDoElse", "s rs f", "rs", "A B A B"),
        ("Whenever", "f s rs", "rs", "A C A C"),
        ("Whenever", "s s s", "s", "A B C"),
        ("Whenever", "s f s", "f", "A B"),
        ("Whenever", "s k s", "s", "A B C"),
        ("Whenever", "s rs rs", "rrs", "A B A B C A C"),
        ("Whenever", "fs RS RRS", "rrr", "A C.start A C.halt B.start A B.tick C.start"),
        ("Whenever", "fsss RS RRRR", "rrrr", "A C.start A C.halt B.start A B.tick C.start A C.tick"),
        ("Whenever", "fsfs S RRRR", "rrrr", "A C.start A C.halt B.start C.start A C.tick A C.halt B.start C.start"),
        ("Whenever", "fs F R", "rf", "A C.start A C.halt B.start"),
        ("Whenever", "k s s", "s", "A C"),
        ("Whenever", "r s s", "s", "A C"),
        ("Whenever", "f s k", "k", "A C"),
        ("WhileDoElse", "sf R s", "rs", "A B.start A B.halt C"),
        ("WhileDoElse", "sf R", "rf", "A B.start A B.halt"),
        ("WhileDoElse", "fs s R", "rs", "A C.start A C.halt B"),
        ("WhileDoElse", "srs RR", "rrr", "A B.start A A B.tick"),
        ("WhileDoElse", "sk R s", "rf", "A B.start A B.halt"),
        ("WhileDoElse", "s k s", "k", "A B"),
        ("WhileDoElse", "fk s R", "rf", "A C.start A C.halt"),
        ("Inverter", "rsfk", "rfsk", "A A A A"),
        ("ForceSuccess", "rsfk", "rssk", "A A A A"),
        ("ForceFailure", "rsfk", "rffk", "A A A A"),
        ("ParallelAll", "s rf rrs", "rrf", "A B C B C C"),
        ("ParallelAll", "k k", "k", "A B"),
        ("ParallelAll", "k rs", "rs", "A B A B"),
    ],
)
def test_table(id: str, scripts: str, statuses: str, log: str) -> None:
    assert run(id, scripts, len(statuses)) == (statuses, log)


@pytest.mark.parametrize(
    ("success_count", "failure_count", "scripts", "statuses", "log"),
    [
        (-1, 1, "s rs rrs", "rrs", "A B C B C C"),
        (-1, 1, "s rf R", "rf", "A B C.start B C.halt"),
        (1, -1, "rr rs R", "rs", "A B C.start A B C.halt"),
        (2, 2, "s f R", "r", "A B C.start"),
        (2, 2, "f f R", "f", "A B"),
        (3, 3, "f R", "", "children"),
        (-2, 3, "s f s", "s", "A B C"),
        (-1, 1, "k s", "s", "A B"),
        (1, 1, "k k", "k", "A B"),
        (-1, 1, "k k", "s", "A B"),
    ],
)
def test_parallel(success_count: int, failure_count: int, scripts: str, statuses: str, log: str) -> None:
    ports = {"success_count": success_count, "failure_count": failure_count}
    if not statuses:
        with pytest.raises(Exception, match="success_count must be a whole number from -3 to 2, not '3'"):
            run("Parallel", scripts, 1, **ports)
    else:
        assert run("Parallel", scripts, len(statuses), **ports) == (statuses, log)


@pytest.mark.parametrize(
    ("id", "limit", "script", "statuses"),
    [
        ("Repeat", 2, "s", "rsrs"),
        ("Repeat", 2, "rs", "rrs"),  # the second round starts in the tick in which the first one ends
        ("Repeat", 3, "rsss", "rrs"),  # and if that ends at once, the tick ends too
        ("Repeat", 3, "sf", "rfrf"),
        ("Repeat", -1, "s", "rrrrrr"),
        ("Repeat", 0, "s", "s"),
        ("Repeat", 2, "sk", "rksk"),  # a skipped round counts for nothing, and keeps the count
        ("RetryUntilSuccessful", 2, "f", "rfrf"),
        ("RetryUntilSuccessful", 3, "fs", "rs"),
        ("RetryUntilSuccessful", 2, "rf", "rrf"),
        ("RetryUntilSuccessful", -1, "f", "rrrrrr"),
        ("RetryUntilSuccessful", 0, "s", "f"),
        ("RetryUntilSuccessful", 2, "k", "kk"),
    ],
)
def test_rounds(id: str, limit: int, script: str, statuses: str) -> None:
    port = "num_cycles" if id == "Repeat" else "num_attempts"
    assert run(id, script, len(statuses), **{port: limit})[0] == statuses


def timed_run(world: World, root: Node, ticks: int) -> str:
    engine = world.engine(root)
    letters = ""
    for _ in range(ticks):
        letters += world.ticks(engine, 1)
        world.clock.advance(0.05)
    return letters


def test_sleep_takes_its_time_whatever_floats_sum_to() -> None:
    assert timed_run(World(), n("Sleep", msec=1000), 22) == "r" * 20 + "sr"
    world = World()
    engine = world.engine(n("Sleep", msec=1000))
    for _ in range(10):
        assert engine.tick() == RUNNING
        world.clock.advance(0.1)
    assert world.clock.now < 1
    assert world.ticks(engine, 1) == "s"


def test_sleep_of_nothing_succeeds_at_once() -> None:
    assert timed_run(World(), n("Sleep", msec=0), 2) == "ss"


def test_delay_then_child() -> None:
    world = World()
    assert timed_run(world, n("Delay", world.fn("A", "rs"), delay_msec=100), 5) == "rrrsr"
    assert world.log == ["A", "A"]


def test_a_skipped_child_is_not_delayed_again() -> None:
    assert timed_run(World(), n("Delay", n("AlwaysSuccess", _skipIf="true"), delay_msec=50), 3) == "rkk"


@pytest.mark.parametrize(
    "around",
    [
        lambda child: n("Sequence", child, n("AlwaysSuccess")),
        lambda child: n("ReactiveSequence", child, n("AlwaysSuccess")),
        lambda child: n("IfThenElse", n("AlwaysSuccess"), child),
        lambda child: n("WhileDoElse", n("AlwaysSuccess"), child),
        lambda child: n("Repeat", child, num_cycles=1),
    ],
)
def test_a_parent_that_goes_past_a_skipped_repeat_resets_its_count(around: Callable[[Node], Node]) -> None:
    world = World()
    counted = n("Repeat", world.fn("A", "skss"), num_cycles=2)
    engine = world.engine(around(counted))
    assert world.ticks(engine, 2)[0] == "r"
    world.ticks(engine, 1)
    assert engine.status == RUNNING, "the first of two rounds, not the second"


def test_timeout_halts_the_child_and_does_not_tick_it_again() -> None:
    world = World()
    engine = world.engine(n("Timeout", world.cls("A", "r"), msec=2500))
    assert world.ticks(engine, 1) == "r"
    world.clock.advance(2.4)
    assert world.ticks(engine, 1) == "r"
    world.clock.advance(0.1)
    assert world.ticks(engine, 1) == "f"
    assert world.log == ["A.start", "A.tick", "A.halt"]
    assert engine.failure is not None
    assert (engine.failure.reason, engine.failure.path) == ("took longer than 2.5 s", "/")


def test_timeout_leaves_a_child_alone_that_is_in_time_and_starts_anew() -> None:
    world = World()
    engine = world.engine(n("Timeout", world.fn("A", "rs"), msec=1000))
    letters = ""
    for _ in range(6):
        letters += world.ticks(engine, 1)
        world.clock.advance(0.9)
    assert letters == "rsrsrs"


def test_timeout_of_zero_is_none() -> None:
    world = World()
    assert timed_run(world, n("Timeout", world.fn("A", "r"), msec=0), 50) == "r" * 50


def test_skip_if() -> None:
    world = World()
    skipped = n("Sequence", world.fn("A", "s"), _skipIf="true")
    assert world.ticks(world.engine(n("Fallback", skipped, world.fn("B", "s"))), 1) == "s"
    assert world.since() == ["B"]
    assert world.ticks(world.engine(n("Sequence", world.fn("A", "s"), _skipIf="false")), 1) == "s"
    assert world.ticks(world.engine(skipped), 1) == "k"


def test_if_without_otherwise_skips() -> None:
    world = World()
    nothing = n("AlwaysSuccess", _skipIf="true")
    maybe = n("IfThenElse", world.fn("C", "f"), world.fn("A", "s"), nothing)
    assert world.ticks(world.engine(maybe), 1) == "k"
    for id in ("Sequence", "Fallback", "ReactiveSequence"):
        world.since()
        assert world.ticks(world.engine(n(id, maybe, world.fn("B", "s"))), 1) == "s"
        assert world.log == ["C", "B"]


def test_while_form_runs_the_action_over_and_over_until_the_condition_breaks() -> None:
    world = World()
    loop = n("Repeat", world.cls("A", "rs"), num_cycles=-1)
    engine = world.engine(n("WhileDoElse", world.fn("C", "ssssf"), loop, n("AlwaysSuccess")))
    assert world.ticks(engine, 5) == "rrrrs"
    assert [e for e in world.log if e != "C"] == [
        "A.start", "A.tick", "A.start", "A.tick", "A.start", "A.tick", "A.start", "A.halt",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("id", "scripts", "ports", "statuses"),
    [
        ("Parallel", "RRS RS RRR", {"success_count": 1}, "rs"),
        ("Parallel", "RRS RF RRR", {"success_count": 1}, "rf"),
        ("ParallelAll", "RRS f s", {"max_failures": 2}, "rrs"),  # 2 of 3 have to succeed
        ("ParallelAll", "RRS f f", {"max_failures": 2}, "rrf"),
    ],
)
def test_what_other_libraries_have(id: str, scripts: str, ports: dict[str, int], statuses: str) -> None:
    """As docs/engine.md says it: a race, and a threshold of successes."""
    assert run(id, scripts, len(statuses), **ports)[0] == statuses
