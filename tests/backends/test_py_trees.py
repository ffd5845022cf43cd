"""What a tree becomes in py_trees, and what is refused."""

from __future__ import annotations

import pytest
from py_trees import composites, decorators
from py_trees.behaviour import Behaviour
from py_trees.behaviours import Success
from py_trees.common import Status
from py_trees.trees import BehaviourTree

import btlang
from btlang.api import parse_tree
from btlang.backends.py_trees.build import to_py_trees
from btlang.backends.py_trees.module import to_module
from btlang.backends.py_trees.plan import DEEPEST
from btlang.backends.py_trees.sequences import SkippableSequence
from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree.node import Node, NodeModel, Tree

from ..engine.scripted import World, Zoned, n
from ..engine.their_leaves import Script, TheirLeaf

WORDS = world_vocabulary()


def refusals(root: Node) -> list[str]:
    """The ids of the nodes that cannot be told."""
    with pytest.raises(MissionError) as refused:
        to_py_trees(Tree(root), WORDS)
    with pytest.raises(MissionError) as again:
        to_module(Tree(root), WORDS)
    assert refused.value.diagnostics == again.value.diagnostics
    assert {problem.code for problem in refused.value.diagnostics} == {"BT134"}
    return sorted(dict(problem.arguments)["id"] for problem in refused.value.diagnostics)


def test_nodes_of_py_trees_are_used_where_they_mean_the_same() -> None:
    tree = Tree(n("Sequence", n("Wave"), n("ForceSuccess", n("Nod"))))
    root = to_py_trees(tree, WORDS, bind=lambda node: Success("x"))
    assert type(root) is composites.Sequence
    assert root.memory
    assert type(root.children[1]) is decorators.FailureIsSuccess
    skippable = to_py_trees(Tree(n("Sequence", n("AlwaysSuccess"), n("AlwaysSuccess", _skipIf="true"))), WORDS)
    assert type(skippable) is SkippableSequence
    assert isinstance(skippable, composites.Sequence)


class Failing(Behaviour):
    """Fails: it cannot know, or it knows that it is not so."""

    def __init__(self, known: bool) -> None:
        super().__init__("?")
        self.known = known

    def update(self) -> Status:
        return Status.FAILURE


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize(
    ("around", "if_no"),
    [
        (n("Inverter", n("Asked")), Status.SUCCESS),
        (n("Inverter", n("Sequence", n("Wave"), n("Asked"))), Status.SUCCESS),
        (n("IfThenElse", n("Asked"), n("AlwaysFailure"), n("Wave")), Status.SUCCESS),
        (n("WhileDoElse", n("Asked"), n("AlwaysFailure"), n("Wave")), Status.SUCCESS),
    ],
)
def test_what_a_leaf_cannot_know_is_no_no(around: Node, if_no: Status, known: bool) -> None:
    tree = Tree(around, models=(NodeModel("Condition", "Asked"),))

    def bound(node: Node) -> Behaviour:
        return Failing(known) if node.id == "Asked" else Success("x")

    root = to_py_trees(tree, WORDS, bind=bound)
    root.tick_once()
    assert root.status == (if_no if known else Status.FAILURE)


def test_leaves_do_what_their_keyword_entries_name() -> None:
    tree = parse_tree('set count to 2; increase count by 1\nif {count} is above 2, print "more"')
    root = to_py_trees(tree.tree, tree.vocabulary, services={"robot": btlang.Session().robot})
    root.tick_once()
    assert root.status == Status.SUCCESS


def test_leaves_that_cannot_be_bound_are_told() -> None:
    with pytest.raises(MissionError) as refused:
        to_py_trees(Tree(n("GoTo")), WORDS)
    assert [problem.code for problem in refused.value.diagnostics] == ["BT132"]


def test_what_py_trees_cannot_do_is_refused_all_at_once() -> None:
    leaf = n("Wave")
    root = n(
        "Sequence",
        n("AsyncSequence", leaf),
        n("Switch2", leaf, leaf, leaf, variable="{x}", case_1="1", case_2="2"),
        n("TryCatch", leaf, leaf, catch_on_halt="true"),
        n("Repeat", leaf, num_cycles="{x}"),
        n("Nod", _failureIf="x == 1"),
        n("KeepOut", leaf, zones="{x}"),
    )
    assert refusals(root) == ["AsyncSequence", "KeepOut", "Nod", "Repeat", "Switch2", "TryCatch"]


def test_trees_that_are_too_deep_are_refused() -> None:
    root = n("AlwaysSuccess")
    for _ in range(DEEPEST):
        root = n("Repeat", root, num_cycles=1)
    made = to_py_trees(Tree(root), WORDS)
    made.tick_once()
    assert made.status == Status.SUCCESS
    assert refusals(n("Inverter", root)) == ["AlwaysSuccess"]
    for _ in range(10_000):
        root = n("Inverter", root)
    assert refusals(root) == ["Inverter"]


class Clockwork:
    """A robot that knows what time it is."""

    time_of_day = 0.0


def test_times_of_day_are_those_of_the_robot() -> None:
    robot = Clockwork()
    root = n("Sequence", n("WaitForTime", time="00:01"), n("TimeOfDay", at_least="00:01", below="00:02"))
    now = [0.0]
    tree = to_py_trees(Tree(root), WORDS, now=lambda: now[0], services={"robot": robot})
    for seconds, status in ((0, Status.RUNNING), (59, Status.RUNNING), (61, Status.SUCCESS), (62, Status.RUNNING)):
        now[0] = robot.time_of_day = seconds
        tree.tick_once()
        assert tree.status == status


def test_else_they_are_those_of_this_computer() -> None:
    tree = to_py_trees(Tree(n("TimeOfDay", at_least="00:00")), WORDS)
    tree.tick_once()
    assert tree.status == Status.SUCCESS


def kept_out(word: str, robot: object, zones: str = "lab") -> Behaviour:
    """A KeepOut over a leaf with this word."""
    tree = Tree(n("KeepOut", n("A"), zones=zones))
    return to_py_trees(tree, WORDS, bind=lambda node: TheirLeaf(Script("A", word, [])), services={"robot": robot})


@pytest.mark.parametrize(
    ("robot", "zones", "reason"),
    [
        (Zoned(), "lab; nowhere", "there's no zone called 'nowhere'"),
        (Zoned(), ";", "it names no zone"),
        (Clockwork(), "lab", "this robot has no zones"),
    ],
)
def test_zones_that_cannot_be_closed_are_a_failure_with_the_reason_of_the_engine(
    robot: object, zones: str, reason: str
) -> None:
    tree = kept_out("s", robot, zones)
    tree.tick_once()
    assert (tree.status, tree.feedback_message) == (Status.FAILURE, reason)
    world = World()
    engine = world.engine(n("KeepOut", world.fn("A", "s"), zones=zones), services={"robot": robot})
    engine.tick()
    assert engine.failure is not None
    assert engine.failure.reason == reason


def test_zones_stay_closed_while_their_node_is_suspended() -> None:
    robot = Zoned()
    scripts = {id: Script(id, words, []) for id, words in (("FC", "f,s,f"), ("R", "rf"), ("W", "rr"))}
    work = n("KeepOut", n("W"), zones="lab")
    tree = Tree(n("Whenever", n("FC"), n("R"), work), models=(NodeModel("Condition", "FC"),))
    root = to_py_trees(tree, WORDS, bind=lambda node: TheirLeaf(scripts[node.id]), services={"robot": robot})
    root.tick_once()
    assert robot.zones.held == ["out:lab"]
    root.tick_once()
    assert (root.tip().name, robot.zones.held) == ("R", ["out:lab"])
    root.tick_once()
    assert (root.status, robot.zones.held) == (Status.FAILURE, [])


def test_zones_open_when_a_leaf_raises_an_exception_and_when_the_tree_is_shut_down() -> None:
    robot = Zoned()
    tree = kept_out("rx", robot)
    tree.tick_once()
    assert robot.zones.held == ["out:lab"]
    with pytest.raises(KeyError):
        tree.tick_once()
    assert robot.zones.held == []
    tree = kept_out("r", robot)
    tree.tick_once()
    assert robot.zones.held == ["out:lab"]
    BehaviourTree(tree).shutdown()
    assert robot.zones.held == []


def test_a_journey_keeps_out_of_zones_of_the_simulated_robot() -> None:
    tree = parse_tree("go to the lab without entering the reading corner")
    robot = btlang.Session().robot
    root = to_py_trees(tree.tree, tree.vocabulary, services={"robot": robot})
    root.tick_once()
    assert robot.zones.is_closed("reading corner")
    root.stop(Status.INVALID)
    assert not robot.zones.is_closed("reading corner")
