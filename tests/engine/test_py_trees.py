"""The engine does what py_trees 2.6 does, on random trees of the node types that mean the same in both."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hypothesis import given
from hypothesis import strategies as st
from py_trees import composites, decorators
from py_trees.behaviour import Behaviour
from py_trees.common import OneShotPolicy, ParallelPolicy, Status

from btlang.tree.node import Node
from tests.profiles import searches

from .random_trees import letters
from .scripted import World, n
from .their_leaves import LETTERS, Script, TheirLeaf, bind


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


ORDERS = letters("ttttth", 3, 12)


@searches(100, 5000)
@given(trees(actions(0), "Sequence Fallback"), ORDERS)
def test_trees_that_ask_once(shape: Node, orders: str) -> None:
    twins = Twins(shape)
    for order in orders:
        ours, theirs = twins.step(order)
        assert ours == theirs


@searches(100, 10000)
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
