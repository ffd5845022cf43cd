"""Live trees of py_trees as trees of btlang."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given
from py_trees import behaviours, composites, decorators, timers
from py_trees.behaviour import Behaviour
from py_trees.common import OneShotPolicy, ParallelPolicy, Status
from py_trees.trees import BehaviourTree

import btlang
from btlang.backends.py_trees.build import to_py_trees
from btlang.backends.py_trees.lift import read_py_trees
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from tests.profiles import searches

from ..engine.scripted import World, Zoned, n
from ..engine.test_py_trees import ORDERS, SAME, actions, trees
from ..engine.their_leaves import LETTERS, Script, TheirLeaf


def made(shape: Node, log: list[str], count: list[int]) -> Behaviour:
    if ":" in shape.id:
        kind, words = shape.id.split(":")
        count[0] += 1
        return TheirLeaf(Script(f"{kind}{count[0]}", words, log))
    return SAME[shape.id]([made(child, log, count) for child in shape.children], shape)


@searches(200, 5000)
@given(trees(actions(0), "Sequence Fallback ReactiveSequence ReactiveFallback"), ORDERS)
def test_a_lifted_tree_does_what_py_trees_does(shape: Node, orders: str) -> None:
    """Also the halts come in the order of py_trees: a behaviour isn't known to be an action."""
    assume(all(node.id != "EternalGuard" for node in Tree(shape).walk()))
    their_log, our_log = [], []  # type: ignore[var-annotated]
    theirs, world = made(shape, their_log, [0]), World()
    root, leaves = read_py_trees(made(shape, our_log, [0]))
    for leaf_id, leaf in leaves.items():
        world.bind(leaf_id, leaf)
    engine = world.engine(root)
    for order in orders:
        their_log.clear()
        our_log.clear()
        if order == "h":
            engine.halt()
            theirs.stop(Status.INVALID)
        else:
            theirs.tick_once()
            assert world.ticks(engine, 1) == LETTERS[theirs.status]
        assert our_log == their_log


EACH = (
    n("Sequence", n("Wave"), n("Nod")),
    n("Fallback", n("Wave"), n("AlwaysFailure")),
    n("ReactiveSequence", n("Bumped"), n("Wave")),
    n("ReactiveFallback", n("Wave"), n("Nod")),
    n("SequenceWithMemory", n("Wave"), n("Nod")),
    n("PipelineSequence", n("Wave"), n("Nod")),
    n("RoundRobin", n("Wave"), n("Nod")),
    n("IfThenElse", n("Bumped"), n("Wave"), n("Nod")),
    n("IfThenElse", n("Bumped"), n("GoTo", place="lab"), n("AlwaysSuccess", _skipIf="true")),
    n("WhileDoElse", n("Bumped"), n("Wave")),
    n("Whenever", n("Bumped"), n("Wave"), n("Nod"), once="true"),
    n("TryCatch", n("Wave"), n("Nod")),
    n("RecoveryNode", n("Wave"), n("Nod"), number_of_retries=3),
    n("Parallel", n("Wave"), n("Sleep", msec=1500), success_count=1),
    n("ParallelAll", n("Wave"), n("Say", text="hi")),
    n("Inverter", n("Bumped")),
    n("ForceSuccess", n("Wave")),
    n("ForceFailure", n("Wave")),
    n("KeepRunningUntilFailure", n("Wave")),
    n("RunOnce", n("Wave"), then_skip="false"),
    n("RunOnce", n("Wave")),
    n("Repeat", n("Wave"), num_cycles=3),
    n("RetryUntilSuccessful", n("Wave"), num_attempts=-1),
    n("Timeout", n("Wave"), msec=2500),
    n("Delay", n("Wave"), delay_msec=500),
    n("PipelineSequence", n("RateController", n("Wave"), hz=0.4), n("Nod")),
    n("KeepOut", n("Wave"), zones="lab"),
    n("KeepIn", n("Wave"), zones="lab; hall"),
    n("Sequence", n("Script", code="x := 1"), n("Say", text="{x}")),
)


@pytest.mark.parametrize("node", EACH, ids=lambda node: node.id)
def test_what_btlang_made_for_py_trees_is_found_again(node: Node) -> None:
    with btlang.Session() as session:
        words = btlang.parse_tree("wave").vocabulary
        root = to_py_trees(Tree(node), words, services={"robot": session.robot})
        back = btlang.from_py_trees(root).mission()
    assert plain(back.tree) == plain(Tree(node))


def test_a_mission_goes_through_py_trees_and_back_to_english() -> None:
    text = "wave\nif the battery is low, go to the dock\nretry say hello 3 times\nwait 2 s"
    mission = btlang.parse_tree(text)
    with btlang.Session() as session:
        root = to_py_trees(mission.tree, mission.vocabulary, services={"robot": session.robot})
    english = btlang.from_py_trees(BehaviourTree(root)).to("english")
    assert english == mission.to("english")


class Steps(Behaviour):
    """RUNNING until its last tick, and notes what is called."""

    def __init__(self, name: str, ticks: int = 3, ends: Status = Status.SUCCESS) -> None:
        super().__init__(name)
        self.ticks, self.ends = ticks, ends
        self.log: list[str] = []

    def initialise(self) -> None:
        self.log.append("initialise")

    def update(self) -> Status:
        self.log.append("update")
        if self.log[::-1].index("initialise") < self.ticks:
            return Status.RUNNING
        self.feedback_message = "no grip"
        return self.ends

    def terminate(self, new_status: Status) -> None:
        self.log.append(new_status.value)


def test_plain_behaviours_run_as_leaves() -> None:
    steps = Steps("pick up!")
    tree = btlang.sequence("wave", btlang.from_py_trees(composites.Sequence("pick", True, [steps])), "nod")
    outcome = tree.run(speed="max")
    assert outcome.succeeded, outcome.why()
    assert steps.log == ["initialise", "update", "update", "update", "SUCCESS"]
    assert outcome.statuses()["pick up!"] is btlang.Status.SUCCESS
    assert tree.run(speed="max").succeeded
    assert "BehaviourPickUp: pick up!" in str(tree)


def test_a_behaviour_that_is_stopped_is_terminated() -> None:
    steps = Steps("dig", 1000)
    root = decorators.Timeout("", steps, duration=1.0)
    steps.status = Status.RUNNING  # as one that was ticked before
    outcome = btlang.from_py_trees(root).run(speed="max")
    assert not outcome.succeeded
    assert steps.log[:2] == ["INVALID", "initialise"]
    assert steps.log[-1] == "INVALID"
    assert steps.status is Status.INVALID


def test_a_failure_has_the_message_and_the_line() -> None:
    root = composites.Selector("try", False, [Steps("grip", 2, Status.FAILURE), Steps("grip", 1, Status.INVALID)])
    tree = btlang.from_py_trees(root)  # here
    why = tree.run(speed="max").why()
    line = 1 + next(at for at, text in enumerate(Path(__file__).read_text().splitlines()) if text.endswith(")  # here"))
    assert f"{Path(__file__)}:{line}:5: grip" in why
    assert "BehaviourGrip_2: it is INVALID after a tick" in why
    assert "no grip" in why


class Guarded(composites.Sequence):
    """A class of a user that only fills in its children."""

    def __init__(self) -> None:
        super().__init__("guarded", memory=False, children=[behaviours.Success("ok"), Steps("move", 1)])


def test_counterparts() -> None:
    leaf = behaviours.Success
    root = composites.Sequence(
        "all",
        True,
        [
            Guarded(),
            decorators.Repeat("", leaf("s"), 0),
            decorators.Retry("", leaf("s"), 0),
            decorators.Timeout("", leaf("s"), 0.25),
            decorators.PassThrough("", decorators.Inverter("", behaviours.Failure("f"))),
            decorators.OneShot("once", leaf("s"), OneShotPolicy.ON_COMPLETION),
            composites.Parallel("", ParallelPolicy.SuccessOnAll(), [leaf("a"), leaf("b")]),
            composites.Parallel("", ParallelPolicy.SuccessOnOne(), [leaf("a"), leaf("b")]),
        ],
    )
    assert plain(btlang.from_py_trees(root).mission().tree).splitlines() == [
        "Sequence name=all",
        "  ReactiveSequence name=guarded",
        "    AlwaysSuccess",
        "    BehaviourMove name=move",
        "  Repeat num_cycles=-1",
        "    AlwaysSuccess",
        "  RetryUntilSuccessful num_attempts=1",
        "    AlwaysSuccess",
        "  Timeout msec=250",
        "    AlwaysSuccess",
        "  Inverter",
        "    AlwaysFailure",
        "  RunOnce name=once then_skip=false",
        "    AlwaysSuccess",
        "  Parallel",
        "    AlwaysSuccess",
        "    AlwaysSuccess",
        "  Parallel success_count=1",
        "    AlwaysSuccess",
        "    AlwaysSuccess",
    ]
    assert "name=" not in plain(btlang.from_py_trees(root, names=False).mission().tree)


class Stubborn(composites.Selector):
    """A class of a user that does something else."""

    def stop(self, new_status: Status = Status.INVALID) -> None:
        """Goes on."""


class Own(composites.Composite):
    """A kind of node that only its user knows."""

    def tick(self) -> Any:
        yield self

    def stop(self, new_status: Status = Status.INVALID) -> None:
        """Does nothing."""


def test_all_nodes_without_a_counterpart_are_named() -> None:
    some = [behaviours.Success("a"), behaviours.Success("b")]
    root = composites.Sequence(
        "root",
        True,
        [
            decorators.Count("laps", behaviours.Success("s")),
            decorators.OneShot("once", behaviours.Success("s"), OneShotPolicy.ON_SUCCESSFUL_COMPLETION),
            composites.Parallel("some", ParallelPolicy.SuccessOnSelected(some[:1]), some),
            composites.Parallel("again", ParallelPolicy.SuccessOnAll(synchronise=False), [timers.Timer(), Steps("x")]),
            Stubborn("mine", False, [behaviours.Success("s")]),
            Own("own", [behaviours.Success("s")]),
            behaviours.Running("ok"),
        ],
    )
    with pytest.raises(btlang.MissionError) as caught:
        btlang.from_py_trees(root)
    assert {problem.message for problem in caught.value.diagnostics} == {
        f"btlang can't express the node '{words}."
        for words in (
            "laps': it is a py_trees.decorators.Count, which has no counterpart",
            "once': it is a py_trees.decorators.OneShot, which has no counterpart",
            "some': it is a py_trees.composites.Parallel, and btlang can't select the children that must succeed",
            "again': it is a py_trees.composites.Parallel, and btlang doesn't tick children again that have succeeded: "
            "set synchronise=True",
            f"mine': it is a {__name__}.Stubborn, which changes what a Selector does",
            f"own': it is a {__name__}.Own, which isn't a node of py_trees itself",
        )
    }
    assert {problem.code for problem in caught.value.diagnostics} == {"BT134"}
    with pytest.raises(TypeError, match="not a str"):
        btlang.from_py_trees("root")


def test_values_of_subtrees_are_refused() -> None:
    """Its nodes would share them with the rest of the tree."""
    inner = ("Inner", n("Script", code="x := 2"))
    tree = Tree(n("Sequence", n("Script", code="x := 1"), n("SubTree", ID="Inner")), (inner,))
    words = btlang.parse_tree("wave").vocabulary
    with pytest.raises(btlang.MissionError, match="values are those of a subtree"):
        btlang.from_py_trees(to_py_trees(tree, words))
    shared = tree.replace(root=n("Sequence", n("Script", code="x := 1"), n("SubTree", ID="Inner", _autoremap="true")))
    back = btlang.from_py_trees(to_py_trees(shared, words)).mission().tree
    assert [node.port("code") for node in back.root.children] == ["x := 1", "x := 2"]


def test_zones_need_no_robot() -> None:
    root = to_py_trees(Tree(n("KeepOut", n("AlwaysSuccess"), zones="lab")), btlang.parse_tree("wave").vocabulary,
                       services={"robot": Zoned()})  # fmt: skip
    assert plain(btlang.from_py_trees(root).mission().tree) == "KeepOut zones=lab\n  AlwaysSuccess"


def test_a_behaviour_among_the_children_of_a_node() -> None:
    with pytest.raises(TypeError, match=r"a Success can't be .*; write btlang.from_py_trees\(...\) round"):
        btlang.sequence("wave", behaviours.Success("done"))  # type: ignore[arg-type]
