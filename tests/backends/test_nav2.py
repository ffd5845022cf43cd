"""Nav2's navigation tree: it is read, said in English, read back, and its recovery logic runs with scripted leaves."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.engine.engine import Engine
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from tests.conftest import matches_golden
from tests.engine.scripted import World

FILE = Path(__file__).parents[1] / "corpus" / "good" / "nav2_to_pose_with_recovery.xml"
XML = FILE.read_text(encoding="utf-8")
ACTIONS = ("ClearEntireCostmap", "Spin", "Wait", "BackUp")
SELECTORS = ("ControllerSelector", "PlannerSelector")


def test_it_is_said_in_english_that_means_the_same() -> None:
    tree = parse_tree(XML)
    text = str(tree.to("english"))
    matches_golden(text, Path(__file__).parent / "nav2.txt")
    for parser in ("shunting-yard", "lark"):
        again = parse_tree(text, parser=parser)
        assert plain(again.tree) == plain(tree.tree)
    assert parse_tree(text).to("english").splitlines() == [line for line in text.splitlines() if line[0] != "#"]  # type: ignore[union-attr]


@pytest.fixture(params=["xml", "english"])
def tree(request: pytest.FixtureRequest) -> Tree:
    """The tree from its file, and from its English."""
    tree = parse_tree(XML)
    read = tree.tree if request.param == "xml" else parse_tree(str(tree.to("english"))).tree
    return Tree(fold(read.root, lambda node: node.children, _scripted))


def _scripted(node: Node, children: list[Node]) -> Node:
    """Scripted leaves take no ports."""
    return node.replace(children=tuple(children)) if children else Node(node.id)


def robot(**scripts: str) -> World:
    """Leaves that succeed at once, but for those of the scripts: a capital letter begins one that can be halted."""
    world = World()
    usual = dict.fromkeys((*SELECTORS, *ACTIONS, "ComputePathToPose", "WouldAPlannerRecoveryHelp"), "s")
    usual |= {"WouldAControllerRecoveryHelp": "s", "GoalUpdated": "f", "FollowPath": "R"}
    for name, script in {**usual, **scripts}.items():
        (world.cls if script.isupper() else world.fn)(name, script.lower())
    return world


def since(world: World) -> list[str]:
    """What was done, without what chooses and asks."""
    quiet = (*SELECTORS, "WouldAPlannerRecoveryHelp", "WouldAControllerRecoveryHelp", "GoalUpdated")
    return [name for name in world.since() if name.partition(".")[0] not in quiet]


def tick(world: World, engine: Engine, seconds: float = 0.5) -> str:
    letter = world.ticks(engine, 1)
    world.clock.advance(seconds)
    return letter


def test_it_plans_once_a_second_while_it_follows(tree: Tree) -> None:
    world = robot(FollowPath="RRRS")
    engine = world.engine(tree)
    assert [tick(world, engine) for _ in range(4)] == ["r", "r", "r", "s"]
    followed = ["FollowPath.start", "FollowPath.tick", "FollowPath.tick", "FollowPath.tick"]
    assert since(world) == ["ComputePathToPose", *followed[:2], "ComputePathToPose", *followed[2:]]


def test_a_plan_that_fails_clears_the_map_and_is_tried_again(tree: Tree) -> None:
    world = robot(ComputePathToPose="fs")
    assert tick(world, world.engine(tree)) == "r"
    assert since(world) == ["ComputePathToPose", "ClearEntireCostmap", "ComputePathToPose", "FollowPath.start"]


def test_the_recoveries_go_round_robin(tree: Tree) -> None:
    """Each failure of the whole is followed by the next recovery, at most six times."""
    world = robot(ComputePathToPose="f")
    assert tick(world, world.engine(tree)) == "f"
    tried = ["ComputePathToPose", "ClearEntireCostmap", "ComputePathToPose"]
    clearing = ["ClearEntireCostmap", "ClearEntireCostmap"]
    rounds = [clearing, ["Spin"], ["Wait"], ["BackUp"], clearing, ["Spin"]]
    assert since(world) == [*tried, *(name for recovery in rounds for name in (*recovery, *tried))]


def test_no_recovery_where_none_would_help(tree: Tree) -> None:
    world = robot(ComputePathToPose="f", WouldAPlannerRecoveryHelp="f", WouldAControllerRecoveryHelp="f")
    assert tick(world, world.engine(tree)) == "f"
    assert since(world) == ["ComputePathToPose"]


def test_a_new_goal_ends_a_recovery(tree: Tree) -> None:
    """A recovery that runs is halted as soon as the goal changes, and the whole is tried again."""
    world = robot(ComputePathToPose="ffs", ClearEntireCostmap="f", Spin="RRRR", GoalUpdated="ffs", Wait="s", BackUp="s")
    engine = world.engine(tree)
    assert tick(world, engine) == "r"
    assert since(world)[-1] == "Spin.start"
    assert tick(world, engine) == "r"
    assert since(world) == ["Spin.tick"]
    assert tick(world, engine) == "r"
    assert since(world)[:2] == ["Spin.halt", "ComputePathToPose"]
