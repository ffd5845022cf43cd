"""The engine does what the reference interpreter does, on random trees with random leaves.

After every tick, halt and suspension: the same status, the same calls and halts of leaves in the same order, the same
blackboard.
"""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from btlang.engine.blackboard import Blackboard
from btlang.engine.status import IDLE
from btlang.tree.node import Node

from .reference import Reference
from .reference_nodes import Board
from .scripted import LETTER, World, n

IN_ORDER = ("Sequence", "Fallback", "AsyncSequence", "AsyncFallback", "SequenceWithMemory")
REACTIVE = ("ReactiveSequence", "ReactiveFallback")
PLAIN_DECORATORS = ("Inverter", "ForceSuccess", "ForceFailure", "KeepRunningUntilFailure")
ASKED = st.sampled_from(("x > 1", "x < 3", "true", "false", "y == '1'", "gone"))
DONE = st.sampled_from(("x := 1", "x += 1", "z := x", "gone"))
CONDITIONS = st.one_of(
    st.tuples(st.sampled_from(("_failureIf", "_successIf", "_skipIf", "_while")), ASKED),
    st.tuples(st.sampled_from(("_onSuccess", "_onFailure", "_onHalted", "_post")), DONE),
)


def _parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    def many(id: str, **ports: object) -> st.SearchStrategy[Node]:
        return st.lists(children, min_size=1, max_size=4).map(lambda c: n(id, *c, **ports))

    def parallel(c: list[Node]) -> st.SearchStrategy[Node]:
        share = st.integers(-len(c), len(c))
        return st.tuples(share, share).map(lambda s: n("Parallel", *c, success_count=s[0], failure_count=s[1]))

    branches = st.lists(children, min_size=2, max_size=3)
    return st.one_of(
        st.sampled_from(IN_ORDER + REACTIVE).flatmap(many),
        st.sampled_from(REACTIVE).flatmap(many),
        st.lists(children, min_size=1, max_size=4).flatmap(parallel),
        many("ParallelAll", max_failures=1),
        branches.map(lambda c: n("IfThenElse", *c)),
        branches.map(lambda c: n("WhileDoElse", *c)),
        st.tuples(st.sampled_from(PLAIN_DECORATORS), children).map(lambda d: n(d[0], d[1])),
        st.tuples(st.sampled_from((-1, 0, 1, 2, 3)), children).map(lambda d: n("Repeat", d[1], num_cycles=d[0])),
        st.tuples(st.sampled_from((-1, 0, 1, 2, 3)), children).map(
            lambda d: n("RetryUntilSuccessful", d[1], num_attempts=d[0])
        ),
        st.tuples(st.sampled_from((1000, 2000, 3000)), children).map(lambda d: n("Timeout", d[1], msec=d[0])),
        st.tuples(st.sampled_from((0, 1000, 2000)), children).map(lambda d: n("Delay", d[1], delay_msec=d[0])),
        st.tuples(children, st.lists(CONDITIONS, min_size=1, max_size=3)).map(_conditioned),
        *_more_parents(children),
    )


def _conditioned(drawn: tuple[Node, list[tuple[str, str]]]) -> Node:
    node, conditions = drawn
    return node.replace(ports=tuple({**dict(node.ports), **dict(conditions)}.items()))


def _more_parents(children: st.SearchStrategy[Node]) -> list[st.SearchStrategy[Node]]:
    def several(id: str, least: int, most: int, **ports: object) -> st.SearchStrategy[Node]:
        return st.lists(children, min_size=least, max_size=most).map(lambda c: n(id, *c, **ports))

    def around(id: str, **ports: st.SearchStrategy[object]) -> st.SearchStrategy[Node]:
        return st.tuples(children, st.fixed_dictionaries(ports)).map(lambda d: n(id, d[0], **d[1]))

    return [
        several("Switch2", 3, 3, variable="{x}", case_1=1, case_2=2),
        several("Switch3", 4, 4, variable="{x}", case_1=2, case_2=1, case_3=3),
        several("TryCatch", 2, 4),
        several("Whenever", 3, 3),
        several("Whenever", 3, 3),
        several("PipelineSequence", 1, 4),
        several("PipelineSequence", 1, 4),
        several("RoundRobin", 1, 4),
        st.integers(0, 2).flatmap(lambda retries: several("RecoveryNode", 2, 2, number_of_retries=retries)),
        around("RateController", hz=st.sampled_from((0.4, 0.5, 2))),
        around("RunOnce", then_skip=st.sampled_from(("true", "false"))),
        around("Precondition", **{"if": ASKED, "else": st.sampled_from(("SUCCESS", "FAILURE", "SKIPPED", "RUNNING"))}),
        around(
            "LoopString",
            queue=st.sampled_from(("1;2", "1", "{q}")),
            value=st.just("{y}"),
            if_empty=st.sampled_from(("SUCCESS", "FAILURE", "SKIPPED")),
        ),
        around("SkipUnlessUpdated", entry=st.just("{x}")),
        around("WaitValueUpdate", entry=st.just("x")),
    ]


LEAVES = st.one_of(
    st.tuples(st.sampled_from("FC"), st.text("rrssffkx", min_size=1, max_size=4)).map(
        lambda leaf: Node(":".join(leaf))
    ),
    st.sampled_from((0, 1000, 2000)).map(lambda msec: n("Sleep", msec=msec)),
    ASKED.map(lambda code: n("ScriptCondition", code=code)),
    DONE.map(lambda code: n("Script", code=code)),
    st.sampled_from((("x", 1), ("x", 2), ("q", "1;2"))).map(lambda s: n("SetBlackboard", output_key=s[0], value=s[1])),
    st.sampled_from((n("UnsetBlackboard", key="x"), n("WasEntryUpdated", entry="{x}"))),
)
TREES = st.recursive(LEAVES, _parents, max_leaves=12)


def _numbered(node: Node, scripts: dict[str, str]) -> Node:
    """The tree with an id of its own for each leaf, whose script goes into the table."""
    if ":" in node.id:
        kind, script = node.id.split(":")
        id = f"{kind}{len(scripts)}"
        scripts[id] = script
        return Node(id, ports=node.ports)
    return Node(node.id, tuple(_numbered(child, scripts) for child in node.children), node.ports)


@settings(max_examples=2000, deadline=None)
@given(TREES, st.text("ttttthp", min_size=3, max_size=12), st.booleans())
def test_engine_equals_reference(shape: Node, orders: str, watched: bool) -> None:
    scripts: dict[str, str] = {}
    root = _numbered(shape, scripts)
    world = World()
    for id, script in scripts.items():
        (world.cls if id.startswith("C") else world.fn)(id, script)
    engine = world.engine(root, watched)
    log: list[str] = []
    board = Board()
    reference = Reference(root, scripts, log, world.clock, board)
    for order in orders:
        if order == "h":
            engine.halt()
            reference.reset()
        elif order == "p":
            engine.suspend()
            reference.suspend()
        else:
            ours, theirs = engine.tick(), reference.execute()
            assert LETTER[ours] == LETTER[theirs]
            if LETTER[theirs] in "sf":
                reference.reset_children()
                reference.status = IDLE
        assert world.log == log
        assert _values(engine.blackboard) == _values(board)
        world.clock.advance(1)


def _values(board: Blackboard) -> list[object]:
    return [board.get(key) if key in board else None for key in "qxyz"]
