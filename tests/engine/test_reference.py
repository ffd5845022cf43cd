"""The engine does what the reference interpreter does, on random trees with random leaves."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from btlang.tree.node import Node

from .reference import Reference
from .scripted import LETTER, World, n

IN_ORDER = ("Sequence", "Fallback", "AsyncSequence", "AsyncFallback", "SequenceWithMemory")
REACTIVE = ("ReactiveSequence", "ReactiveFallback")
PLAIN_DECORATORS = ("Inverter", "ForceSuccess", "ForceFailure")


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
        children.map(lambda c: c.replace(ports=(*c.ports, ("_skipIf", "true")))),
    )


LEAVES = st.one_of(
    st.tuples(st.sampled_from("FC"), st.text("rsfk", min_size=1, max_size=4)).map(lambda leaf: Node(":".join(leaf))),
    st.sampled_from((0, 1000, 2000)).map(lambda msec: n("Sleep", msec=msec)),
    st.tuples(st.sampled_from(("Script", "ScriptCondition")), st.sampled_from(("2 > 1", "1 > 2", "gone"))).map(
        lambda script: n(script[0], code=script[1])
    ),
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


@settings(max_examples=1200, deadline=None)
@given(TREES, st.text("tttth", min_size=3, max_size=12), st.booleans())
def test_engine_equals_reference(shape: Node, orders: str, watched: bool) -> None:
    scripts: dict[str, str] = {}
    root = _numbered(shape, scripts)
    world = World()
    for id, script in scripts.items():
        (world.cls if id.startswith("C") else world.fn)(id, script)
    engine = world.engine(root, watched)
    log: list[str] = []
    reference = Reference(root, scripts, log, world.clock)
    for order in orders:
        if order == "h":
            engine.halt()
            reference.reset()
        else:
            ours, theirs = engine.tick(), reference.execute()
            assert LETTER[ours] == LETTER[theirs]
            if LETTER[theirs] in "sf":
                reference.reset_children()
                reference.status = 0
        assert world.log == log
        world.clock.advance(1)
