"""What the live view knows of a run: statuses of the present round only, times, pauses."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.snapshot import HALTED, SUSPENDED, RunState, Shape
from btlang.tree.node import Node

from .trees import Run


def n(id: str, *children: Node, **ports: object) -> Node:
    return Node(id, children, tuple((port, str(text)) for port, text in ports.items()))


def letters(statuses: bytes) -> str:
    """`.` not started, r s f k the statuses, h halted, p paused."""
    return "".join("fsrk.hp"[status] for status in statuses)


def test_an_earlier_round_is_forgotten() -> None:
    run = Run(n("Repeat", n("Sequence", n("A:rs"), n("B:s"), n("C:rs")), num_cycles=-1))
    assert [letters(run.tick()) for _ in range(4)] == ["rrr..", "rrssr", "rrr..", "rrssr"]


def test_a_round_within_one_tick() -> None:
    run = Run(n("Repeat", n("Sequence", n("A:s"), n("Fallback", n("B:f"), n("C:r"))), num_cycles=-1))
    assert [letters(run.tick()) for _ in range(2)] == ["rrsrfr", "rrsrfr"]


def test_a_round_that_lasts_after_one_within_one_tick() -> None:
    run = Run(n("RetryUntilSuccessful", n("Fallback", n("A:fr"), n("B:f"), n("Inverter", n("C:s"))), num_attempts=-1))
    assert [letters(run.tick()) for _ in range(2)] == ["rffffs", "rrr..."]
    run = Run(n("RetryUntilSuccessful", n("Sequence", n("A:s"), n("B:fr"), n("C:s")), num_attempts=-1))
    assert [letters(run.tick()) for _ in range(2)] == ["rfsf.", "rrsr."]


def test_another_branch_halts_the_first() -> None:
    run = Run(n("WhileDoElse", n("A:ssf"), n("Sequence", n("B:s"), n("C:r")), n("D:r")))
    assert [letters(run.tick()) for _ in range(4)] == ["rsrsr.", "rsrsr.", "rfhshr", "rsrsrh"]


def test_a_pause_keeps_what_was_done() -> None:
    run = Run(n("Sequence", n("A:s"), n("Parallel", n("B:rrrrrs"), n("C:rs")), n("D:r")))
    assert letters(run.tick(2)) == "rsrrs."
    assert letters(run.suspend()) == "pspps."
    assert letters(run.tick()) == "rsrrs."
    assert run.state.started[2] == 0.0  # what is above goes on
    assert run.state.started[3] == 2.0  # the command starts anew


def test_what_a_pause_interrupted_may_not_go_on() -> None:
    run = Run(n("WhileDoElse", n("A:sf"), n("B:r"), n("C:r")))
    assert letters(run.tick()) == "rsr."
    assert letters(run.suspend()) == "psp."
    assert letters(run.tick()) == "rfhr"


def test_times() -> None:
    run = Run(n("Sequence", n("A:rrs"), n("B:s"), n("C:rf")))
    run.tick(4)
    state = run.state
    assert [(state.started[i], state.ended.get(i)) for i in range(4)] == [(0, 3), (0, 2), (2, 2), (2, 3)]


def test_depth_does_not_matter() -> None:
    depth = 10_000
    state = RunState(Shape(range(-1, depth - 1)), [Node("Sequence")] * depth)
    for t in range(3):
        for status in (RUNNING, SUCCESS):
            for index in range(depth - 1, -1, -1):
                state.change(index, status, float(t))
        assert state.statuses == bytes([SUCCESS] * depth)
    state.change(depth - 1, RUNNING, 9.0)
    assert state.statuses[:-1].count(IDLE) == depth - 2


def parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    many = st.lists(children, min_size=1, max_size=4)
    return st.one_of(
        st.tuples(st.sampled_from(["Sequence", "Fallback", "Parallel", "ReactiveSequence"]), many).map(
            lambda made: n(made[0], *made[1])
        ),
        st.tuples(st.integers(-1, 3), children).map(lambda made: n("Repeat", made[1], num_cycles=made[0])),
        st.tuples(st.integers(1, 3), children).map(
            lambda made: n("RetryUntilSuccessful", made[1], num_attempts=made[0])
        ),
        st.tuples(st.sampled_from(["Inverter", "ForceSuccess"]), children).map(lambda made: n(made[0], made[1])),
        st.lists(children, min_size=3, max_size=3).map(lambda made: n("WhileDoElse", *made)),
    )


LEAVES = st.tuples(st.integers(0, 10**6), st.text("rsfk", min_size=1, max_size=4)).map(
    lambda made: Node(f"L{made[0]}:{made[1]}")
)


@given(st.recursive(LEAVES, parents, max_leaves=12), st.lists(st.sampled_from("tttp"), max_size=12))
def test_it_agrees_with_the_engine(root: Node, deeds: list[str]) -> None:
    run = Run(root)
    for deed in deeds:
        statuses = run.tick() if deed == "t" else run.suspend()
        shape = run.state.shape
        for node, status in enumerate(statuses):
            assert (status == RUNNING) == (run.latest.get(node) == RUNNING)
            if status in (RUNNING, SUCCESS, FAILURE, SKIPPED):
                continue
            if status == IDLE:
                assert set(statuses[node : shape.ends[node]]) == {IDLE}
            else:
                assert status in (HALTED, SUSPENDED)
        assert (statuses[0] == SUSPENDED) == (run.latest.get(0) == IDLE and deed == "p")
        for node, made in enumerate(run.nodes):
            if made.id in ("Sequence", "Fallback") and statuses[node] == RUNNING:
                row = [statuses[child] for child in shape.children(node)]
                at = row.index(RUNNING)
                passes = SUCCESS if made.id == "Sequence" else FAILURE
                assert set(row[:at]) <= {passes, SKIPPED}
                if "p" not in deeds:  # that what was suspended does not go on is no change of a status
                    assert set(row[at + 1 :]) <= {IDLE}
