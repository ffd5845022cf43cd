"""The headers of docs/cpp do what the engine does: they are compiled with BehaviorTree.CPP 4.10 and play trees."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from btlang.backends.btcpp import to_xml
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree.node import Node, Tree
from tests.profiles import amount

from ..engine.random_trees import letters
from ..engine.scripted import LETTER, World, n
from ..engine.test_behaviour_tables import built, rows

ROOT = Path(__file__).parents[2]
WORDS = world_vocabulary()
OURS = ("Whenever", "KeepOut", "KeepIn")


class Player:
    """The program of cpp/play.cpp."""

    def __init__(self, program: Path) -> None:
        pipe = subprocess.PIPE
        self.process = subprocess.Popen([program], stdin=pipe, stdout=pipe, encoding="utf-8")

    def play(self, tree: Tree, words: dict[str, str], steps: str) -> tuple[str, str, list[str]]:
        """The letters of the ticks, the calls of the leaves, and what zones hold after each step and at the end."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        xml = " ".join(to_xml(tree, WORDS).split("\n"))
        leaves = " ".join(f"{id}={word}" for id, word in words.items())
        self.process.stdin.write(f"{xml}\t{leaves}\t{steps}\n")
        self.process.stdin.flush()
        happened, calls, held = self.process.stdout.readline().rstrip("\n").split("\t")
        assert happened != "error", calls
        return happened, calls, held.split("|")


@pytest.fixture(scope="module")
def player(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Player]:
    if shutil.which("cmake") is None or shutil.which(os.environ.get("CXX", "c++")) is None:
        pytest.skip("needs CMake and a C++ compiler")
    folder = tmp_path_factory.mktemp("cpp")
    source = Path(__file__).parent / "cpp"
    ran = cmake("-S", source, "-B", folder, f"-DHEADERS={ROOT / 'docs/cpp'}")
    if "BehaviorTree.CPP is missing" in ran:
        pytest.skip("needs BehaviorTree.CPP; CMAKE_PREFIX_PATH says where it is")
    cmake("--build", folder)
    made = Player(folder / "play")
    with made.process:
        yield made
        assert made.process.stdin is not None
        made.process.stdin.close()
    assert made.process.returncode == 0


def cmake(*words: object) -> str:
    ran = subprocess.run(["cmake", *map(str, words)], capture_output=True, encoding="utf-8", check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def script(children: str) -> dict[str, str]:
    return dict(zip("ABC", children.split(), strict=False))


ONE_TICK = [row for row in rows(6) if row[0].split()[0] in OURS]
OVER_TIME = [
    row
    for row in rows(5)
    # BehaviorTree.CPP can't suspend, and starts a condition that is an action before it halts the work
    if row[0].split()[0] in OURS and "~" not in row[2] and not (row[0].startswith("Whenever") and row[1][0].isupper())
]


@pytest.mark.parametrize(("node", "children", "statuses"), [(row[0], row[1], "".join(row[2:])) for row in ONE_TICK])
def test_one_tick(player: Player, node: str, children: str, statuses: str) -> None:
    for letter, status in zip("rsfk", statuses, strict=True):
        words = children.replace("?", letter)
        assert player.play(built(World(), node, words), script(words), ".")[0] == status


@pytest.mark.parametrize(("node", "children", "ticks", "calls"), [row[:4] for row in OVER_TIME])
def test_over_time(player: Player, node: str, children: str, ticks: str, calls: str) -> None:
    happened, called, held = player.play(built(World(), node, children), script(children), ticks)
    if "zones=" in node:
        called += " closed" if held[-2] else " open"
    assert (happened, called) == (ticks, calls)


def test_every_node_is_in_the_tables() -> None:
    assert {row[0].split()[0] for row in ONE_TICK} == set(OURS)
    assert {row[0].split()[0] for row in OVER_TIME} == {"Whenever", "KeepOut"}


def leaf(weighted: str, least: int, most: int) -> st.SearchStrategy[Node]:
    """A leaf that has its word in place of an id; in capitals, an action."""
    word = letters(weighted, least, most)
    return st.one_of(word, word.map(str.upper)).map(Node)


SKIPPED = st.sampled_from(("k", "K")).map(Node)
"""In BehaviorTree.CPP a leaf that runs is never SKIPPED."""
ZONES = st.sampled_from(("a", "b", "A", "a; b", "b ,a", "c", "nowhere", "a; nowhere"))
KEEPS = st.sampled_from(("KeepOut", "KeepIn"))


def kept(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    return st.tuples(KEEPS, children, ZONES).map(lambda drawn: n(drawn[0], drawn[1], zones=drawn[2]))


def parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    several = st.lists(children, min_size=1, max_size=3)
    ids = st.sampled_from(("Sequence", "Fallback", "Parallel"))
    inverted = children.map(lambda child: n("Inverter", child))
    return st.one_of(kept(children), kept(children), inverted, st.tuples(ids, several).map(lambda d: n(d[0], *d[1])))


LEAVES = st.one_of(leaf("rrsf", 1, 4), leaf("rrsf", 1, 4), SKIPPED)
TREES = st.recursive(LEAVES, parents, max_leaves=6)
CONDITIONS = letters("fffs", 3, 6).map(Node)
REACTIONS = leaf("rrsf", 1, 4)
WORK = kept(st.recursive(leaf("rrrs", 2, 4), kept, max_leaves=4))
"""Work that starts over after a reaction as it goes on after a suspension: BehaviorTree.CPP can't suspend."""
RULES = st.tuples(CONDITIONS, REACTIONS | kept(REACTIONS), WORK, st.booleans()).map(
    lambda d: n("Whenever", *d[:3], once=str(d[3]).lower())
)
SOME = {"max_examples": amount(100, 10000), "suppress_health_check": [HealthCheck.function_scoped_fixture]}


@pytest.mark.long
@settings(**SOME)
@given(shape=TREES, steps=letters("ttttt!", 1, 10))
def test_random_trees(player: Player, shape: Node, steps: str) -> None:
    compare(player, shape, steps)


@pytest.mark.long
@settings(**SOME)
@given(shape=RULES, steps=letters("ttttt!", 3, 10))
def test_zones_of_interrupted_work(player: Player, shape: Node, steps: str) -> None:
    compare(player, shape, steps)


def compare(player: Player, shape: Node, steps: str) -> None:
    world = World()
    words: dict[str, str] = {}
    tree = Tree(named(world, shape, words))
    engine = world.engine(tree)
    happened, held = "", []
    for step in steps:
        if step == "!":
            engine.halt()
            happened += step
        else:
            happened += LETTER[engine.tick()]
        held.append(in_small(world.robot.zones.text))
    theirs, calls, their_zones = player.play(tree, words, steps)
    assert (theirs, calls) == (happened, " ".join(world.log))
    assert [in_small(zones) for zones in their_zones] == [*held, ""]


def named(world: World, shape: Node, words: dict[str, str]) -> Node:
    """The tree with its leaves bound, and called L0, L1 ...; `words` gets their words."""
    if shape.children:
        return shape.replace(children=tuple(named(world, child, words) for child in shape.children))
    id = f"L{len(words)}"
    words[id] = shape.id
    return world.cls(id, shape.id.lower()) if shape.id.isupper() else world.fn(id, shape.id)


def in_small(zones: str) -> str:
    """What holds, where the case of names doesn't count."""
    return " ".join(sorted({":".join(sorted(set(entry.lower().split(":")))) for entry in zones.split()}))


def test_zones_add_up(player: Player) -> None:
    inner = n("Fallback", n("KeepOut", n("A"), zones="hall; lab"), n("B"))
    both = Tree(n("KeepOut", n("Parallel", inner, n("KeepOut", n("C"), zones="Lab")), zones="lab"))
    words = {"A": "RFR", "B": "RRR", "C": "RRS"}
    assert player.play(both, words, "ttt")[2] == ["out:hall out:lab", "out:lab", "out:lab", ""]
    both = Tree(n("Parallel", n("KeepIn", n("A"), zones="lab; hall"), n("KeepIn", n("B"), zones="hall; Lab")))
    assert player.play(both, {"A": "RSR", "B": "RRS"}, "ttt")[2] == ["in:hall:lab", "in:hall:lab", "", ""]


def test_zones_open_with_the_end_of_the_tree(player: Player) -> None:
    tree = Tree(n("KeepOut", n("A"), zones="lab"))
    assert player.play(tree, {"A": "R"}, "t-")[2] == ["out:lab", "", ""]
    assert player.play(tree, {"A": "R"}, "t")[2] == ["out:lab", ""]


def rule(work: Node, condition: str = "C", reaction: str = "R") -> Node:
    return n("Whenever", Node(condition), Node(reaction), work)


def test_zones_stay_closed_through_rules_within_rules(player: Player) -> None:
    """The inner reaction is interrupted by the outer one, which begins at the third tick and ends at the fourth."""
    inner = rule(n("KeepOut", n("W"), zones="lab"), "D", "S")
    words = {"C": "ffsff", "R": "RS", "D": "fsfff", "S": "RRRR", "W": "RRRRR"}
    held = player.play(Tree(rule(inner)), words, "ttttt!")[2]
    assert held == ["out:lab", "out:lab", "out:lab", "out:lab", "out:lab", "", ""]


def test_zones_open_where_work_starts_over(player: Player) -> None:
    work = n("Sequence", n("A"), n("KeepIn", n("B"), zones="hall"))
    words = {"C": "fsf", "R": "s", "A": "srr", "B": "RRR"}
    assert player.play(Tree(rule(work)), words, "ttt")[2] == ["in:hall", "", "", ""]


@pytest.mark.parametrize("steps", ["tt!t", "ttt"])
def test_zones_of_interrupted_work_open_when_the_rule_ends(player: Player, steps: str) -> None:
    words = {"C": "fsf", "R": "RF", "W": "RR"}
    happened, _, held = player.play(Tree(rule(n("KeepOut", n("W"), zones="lab"))), words, steps)
    assert happened == {"tt!t": "rr!r", "ttt": "rrf"}[steps]
    assert held[:3] == ["out:lab", "out:lab", ""]
    assert held[-1] == ""


def test_after_an_exception_zones_stay_closed_until_the_halt(player: Player) -> None:
    tree = Tree(n("KeepOut", n("A"), zones="lab"))
    assert player.play(tree, {"A": "rx"}, "tt!") == ("rx!", "A A", ["out:lab", "out:lab", "", ""])
    assert player.play(tree, {"A": "x"}, "t") == ("x", "A", ["out:lab", ""])


def test_a_zone_that_nobody_names(player: Player) -> None:
    for zones in (" ; ", "{gone}"):
        assert player.play(Tree(n("KeepIn", n("A"), zones=zones)), {"A": "r"}, "t") == ("x", "", ["", ""])


def test_times_of_day(player: Player) -> None:
    assert player.play(Tree(n("WaitForTime", time="00:00")), {}, "t!")[0] == "r!"
    assert player.play(Tree(n("WaitForTime", time="24:00")), {}, "t")[0] == "x"
