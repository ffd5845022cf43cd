"""A tree that was compiled to py_trees has the statuses of the engine, tick for tick, and closes the same zones."""

from __future__ import annotations

from functools import cache
from typing import Any

from hypothesis import given
from hypothesis import strategies as st
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from btlang.backends.py_trees.build import to_py_trees
from btlang.backends.py_trees.module import to_module
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree.node import Node, NodeModel, Tree
from btlang.vocabulary.lexicon import Lexicon
from tests.profiles import searches

from ..engine.random_trees import letters
from ..engine.scripted import World, Zoned, n
from ..engine.their_leaves import LETTERS, Script, TheirLeaf, bind

ALL_LETTERS = {**LETTERS, Status.INVALID: "k"}
CONDITIONS = st.lists(st.sampled_from("rsf"), min_size=1, max_size=4).map(lambda w: Node("F:" + ",".join(w)))
RUNS = st.tuples(st.integers(0, 3), st.sampled_from("sf")).map(lambda run: "r" * run[0] + run[1])
ACTIONS = st.lists(RUNS, min_size=1, max_size=3).map(lambda words: Node("C:" + ",".join(words)))
CODES = st.sampled_from(("x := 1", "x += 1", "y := x", "gone"))
LEAVES = st.one_of(
    CONDITIONS,
    ACTIONS,
    ACTIONS,
    st.just(n("AlwaysSuccess", _skipIf="true")),
    st.sampled_from((n("AlwaysSuccess"), n("AlwaysFailure"))),
    st.sampled_from((0, 1000, 2000)).map(lambda msec: n("Sleep", msec=msec)),
    st.sampled_from(("x > 1", "x < 3", "y == 1")).map(lambda code: n("ScriptCondition", code=code)),
    CODES.map(lambda code: n("Script", code=code)),
)
MANY = (
    "Sequence", "Fallback", "SequenceWithMemory", "ReactiveSequence", "ReactiveFallback", "PipelineSequence",
    "RoundRobin", "ParallelAll",
)  # fmt: skip
ZONES = ("a", "b", "a; b", "nowhere")
AROUND = ("Inverter", "ForceSuccess", "ForceFailure", "KeepRunningUntilFailure")


def parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    def around(id: str, port: str, texts: tuple[object, ...]) -> st.SearchStrategy[Node]:
        return st.tuples(children, st.sampled_from(texts)).map(lambda d: n(id, d[0], **{port: d[1]}))

    def several(least: int, most: int) -> st.SearchStrategy[list[Node]]:
        return st.lists(children, min_size=least, max_size=most)

    counts = st.tuples(several(1, 4), st.integers(-2, 2), st.integers(-2, 2))
    parallel = counts.map(
        lambda d: n("Parallel", *d[0], success_count=min(d[1], len(d[0])), failure_count=min(d[2], len(d[0])))
    )
    many = st.tuples(st.sampled_from(MANY), several(1, 4)).map(lambda d: n(d[0], *d[1]))
    branches = st.tuples(st.sampled_from(("IfThenElse", "WhileDoElse")), several(2, 3))
    return st.one_of(
        many,
        many,
        parallel,
        branches.map(lambda d: n(d[0], *d[1])),
        several(3, 3).map(lambda c: n("Whenever", *c)),
        several(2, 4).map(lambda c: n("TryCatch", *c)),
        several(2, 2).map(lambda c: n("RecoveryNode", *c, number_of_retries=1)),
        st.tuples(st.sampled_from(AROUND), children).map(lambda d: n(*d)),
        around("Repeat", "num_cycles", (-1, 0, 1, 2, 3)),
        around("RetryUntilSuccessful", "num_attempts", (-1, 0, 1, 2, 3)),
        around("Timeout", "msec", (0, 1000, 2000)),
        around("Delay", "delay_msec", (0, 1000, 2000)),
        around("RateController", "hz", (0.4, 0.5, 2)),
        around("RunOnce", "then_skip", ("true", "false")),
        around("KeepOut", "zones", ZONES),
        around("KeepIn", "zones", ZONES),
        st.tuples(children, st.booleans()).map(used),
    )


def used(drawn: tuple[Node, bool]) -> Node:
    """A tree as a subtree, used once or twice; `Twins` moves the child to where it belongs."""
    body, twice = drawn
    use = n("SubTree", body, x="{y}", _autoremap="true")
    return n("Sequence", use, use) if twice else use


TREES = st.recursive(LEAVES, parents, max_leaves=12)


@cache
def vocabulary() -> Lexicon:
    return world_vocabulary()


class Twins:
    """The same tree in both, with leaves that are alike."""

    def __init__(self, shape: Node, in_module: bool) -> None:
        self.world = World()
        self.words: dict[str, str] = {}
        self.scripts: dict[str, Script] = {}
        self.subtrees: dict[int, tuple[str, Node]] = {}
        tree = Tree(self._named(shape), ())
        models = tuple(NodeModel("Condition", id) for id in self.words if id.startswith("F"))
        tree = tree.replace(subtrees=tuple(self.subtrees.values()), models=models)
        self.ours = self.world.engine(tree)
        self.their_robot = Zoned()
        if not in_module:
            self.theirs = to_py_trees(
                tree,
                vocabulary(),
                bind=lambda node: self._their_leaf("", node.id, {}),
                now=self._now,
                services={"robot": self.their_robot},
            )
        else:
            names: dict[str, Any] = {"__name__": "made"}
            exec(to_module(tree, vocabulary()), names)
            more = {"zones": self.their_robot.zones} if "RestrictableZones" in names else {}
            self.theirs = names["create_root"](self._their_leaf, self._now, **more)

    def _now(self) -> float:
        return self.world.clock.now

    def _named(self, node: Node) -> Node:
        if ":" in node.id:
            kind, words = node.id.split(":")
            name = f"{kind}{len(self.words)}"
            self.words[name] = words
            return bind(self.world, name, words)
        if node.id == "SubTree":
            [body] = node.children
            if id(body) not in self.subtrees:
                named = self._named(body)
                self.subtrees[id(body)] = (f"t{len(self.subtrees)}", named)
            return Node("SubTree", ports=(("ID", self.subtrees[id(body)][0]), *node.ports))
        return Node(node.id, tuple(self._named(child) for child in node.children), node.ports)

    def _their_leaf(self, name: str, id: str, ports: dict[str, str]) -> Behaviour:
        return TheirLeaf(self.scripts.setdefault(id, Script(id, self.words[id], [])))

    def step(self, order: str) -> tuple[str, str]:
        """Ticks or halts both; the letters of their statuses."""
        if order == "h":
            self.ours.halt()
            self.theirs.stop(Status.INVALID)
            return "", ""
        self.theirs.tick_once()
        found = self.world.ticks(self.ours, 1), ALL_LETTERS[self.theirs.status]
        self.world.clock.advance(1)
        return found


@searches(200, 10000)
@given(TREES, letters("ttttth", 3, 12))
def test_statuses_are_the_same(shape: Node, orders: str) -> None:
    compare(Twins(shape, in_module=False), orders)


@searches(20, 1000, deadline=None)
@given(TREES, letters("ttttth", 3, 12))
def test_statuses_of_a_module_are_the_same(shape: Node, orders: str) -> None:
    compare(Twins(shape, in_module=True), orders)


def compare(twins: Twins, orders: str) -> None:
    for order in orders:
        ours, theirs = twins.step(order)
        assert ours == theirs
        assert sorted(twins.world.robot.zones.held) == sorted(twins.their_robot.zones.held)
