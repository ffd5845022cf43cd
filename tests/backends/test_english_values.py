"""Missions with values, parameters and loops as English: natural words again, and the same tree."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import given

from btlang.api import parse_tree
from btlang.backends.english import to_english
from btlang.frontends.mission.reader import read_mission
from btlang.passes import lower_mission
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree import ast
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon
from tests.examples.cases import world_of
from tests.language.letters import letters
from tests.printer import trees
from tests.profiles import cases, searches

PARSERS = ("shunting-yard", "lark")
ROOT = Path(__file__).parent.parent.parent
MISSIONS = sorted([*(ROOT / "examples").glob("*.txt"), *(ROOT / "tests" / "samples" / "good").glob("*.txt")])
NOT_ALL_NATURAL = {
    "nodes": "it is about nodes that no phrase says",
    "given": "one of its nodes gives values",
    "node_forms": "it has a tree of another file",
}
_BY_ID = re.compile(r'\b(do|test) ("|subtree|script|sequence|set blackboard|recovery|reactive|pipeline)')


def said_and_read(tree: Tree, vocabulary: Lexicon, facts: Sequence[ast.Fact] = ()) -> str:
    """The English of a tree, which both parsers read back as an equal one, that is said in the same words."""
    text = to_english(tree, vocabulary, facts=facts)
    for parser in PARSERS:
        again = lower_mission(read_mission(Source(text), vocabulary, parser).mission, vocabulary)
        assert plain(again) == plain(tree)
        assert to_english(again, vocabulary, facts=facts) == text
    return text


def natural(text: str) -> str:
    """What the tree of a text is said as."""
    vocabulary = world_vocabulary()
    return said_and_read(lower_mission(read_mission(Source(text), vocabulary).mission, vocabulary), vocabulary)


@cases("path", MISSIONS, usual=34, first=1, ids=lambda path: path.stem)
def test_missions_that_ship(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)  # where it includes from
    text = path.read_text(encoding="utf-8-sig")
    own = path.with_suffix(".toml")
    vocabulary = world_vocabulary([str(own)] if own.exists() else [], world=world_of(path, text))
    mission = read_mission(Source(text, str(path)), vocabulary).mission
    said = said_and_read(lower_mission(mission, vocabulary), vocabulary, ast.all_facts(mission))
    assert (_BY_ID.search(said) is not None) == (path.stem in NOT_ALL_NATURAL), said


@searches(8, 1500)
@given(trees.missions())
def test_missions_with_values(mission: ast.Program) -> None:
    text = said_and_read(lower_mission(mission, letters()), letters())
    assert _BY_ID.search(text.replace("do sequence:", "")) is None  # a sequence with a rule, inside another one


@pytest.mark.parametrize(
    "text",
    [
        "set counter to 3\nincrease counter by 2\ndecrease counter by 0.5\n",
        "set gap to 0.5 m\nmove forward {gap}\n",
        'set mood to "it\'s fine"\nif {mood} is "it\'s bad", say "{mood}"\n',
        'set count to 0\n(for each item in 1, {count}: say "{item} of {count}" then nod) 3 times with 2 s in between\n',
        "set goal to lab\nset other goal to {goal}\ngo to {other_goal}\n",
        "set x to 1\nset y to {x}\nincrease y by {x}\nif {x} is below {y}, wave\n",
        "remember battery as start level\nif battery is below {start_level}, dock\n",
        "remember distance to lab as gap\ncheck {gap} is between 1 m and 2 m\n",
        "set pause to 2 s\nwait {pause}\nwave within {pause}\nwave every {pause}\n",
        "set pause to 2 s\nwave for {pause}\nwave after {pause}\n",
        "set n to 2\nnod {n} times\n(wave then nod) {n} times\nretry wave {n} times\n",
        'greet {who} means say "hello {who}" then wave at {who}\ngreet Alice\ngreet Bob\n',
        'tell {what} for {time} means say "{what}!" then wait {time}\nset n to 3\ntell "{n} rounds" for 2 s\n',
        "enough means {count} is above 9\nset count to 0\nuntil enough, increase count by 1\n",
        'for each guest in Alice, Bob: wave at {guest} then say "hello {guest}"\n',
        'for each n in 1, 2: for each m in {n}, 3: say "{n} {m}"\nfor each n in 3: nod {n} times\n',
        'visit {place} means for each n in 1, 2: say "{place} {n}"\nvisit lab\n',
        'set x to 1\nsay "{x} {{really}}"\n',
        'set greeting to "hi"\nsay "{greeting}"\n',  # not Hindi
        "set language to Hindi\nspeak {language}\n",
    ],
)
def test_said_as_it_was_written(text: str) -> None:
    assert natural(text) == text


def script(code: str) -> Node:
    return Node("Script", (), (("code", code),))


def say(text: str) -> Node:
    return Node("Say", (), (("text", text),))


@pytest.mark.parametrize(
    ("nodes", "lines"),
    [
        (
            [say("{nothing}"), script("x := 1")],
            ["this mission is given {nothing}", 'say "{nothing}"', "set x to 1"],
        ),
        ([script("x := 1"), script("x := 'a'")], ['do script "x := 1"', "do script \"x := 'a'\""]),
        ([script("x := 1.0"), say("{x}")], ['do script "x := 1.0"', 'say "{x}"']),
        ([script("x := sqrt(2); y += 1")], ['do script "x := sqrt(2); y += 1"']),
        ([script("The_key := 1")], ['do script "The_key := 1"']),
        (
            [script("x := 1"), Node("Sequence", (script("_2 := 'a' .. x"), say("{_2}"))), say("{x}")],
            [
                "set x to 1",
                '(do script "_2 := \'a\' .. x" then do "Say" with text {_2})',
                'say "{x}"',
            ],
        ),
    ],
)
def test_what_has_no_name_is_said_by_its_id(nodes: list[Node], lines: list[str]) -> None:
    """A key that is of two types, codes that no words say, keys out of their order: no others."""
    tree = Tree(nodes[0] if len(nodes) == 1 else Node("Sequence", tuple(nodes)))
    assert said_and_read(tree, world_vocabulary()).splitlines() == lines


def test_a_loop_that_is_none() -> None:
    """Its rounds give no value, or one is elsewhere."""
    rounds = [Node("SubTree", (), (("ID", "each_n"), ("n", text))) for text in ("1", "2")]
    body = ("each_n", say("{n}"))
    loop = Node("Sequence", tuple(rounds))
    assert said_and_read(Tree(loop, (body,)), world_vocabulary()) == 'for each n in 1, 2: say "{n}"\n'
    elsewhere = said_and_read(Tree(Node("Fallback", (loop, rounds[0])), (body,)), world_vocabulary())
    assert elsewhere.splitlines()[0] == '"each_n" means say "{n}"'


def test_a_type_that_only_the_first_use_tells() -> None:
    """The name is given up, not the other values."""
    uses = [Node("SubTree", (), (("ID", "greet {who}"), ("who", text))) for text in ("Alice", "3")]
    tree = Tree(Node("Sequence", (script("x := 1"), *uses)), (("greet {who}", Node("Wave")),))
    assert "set x to 1" in said_and_read(tree, world_vocabulary())


def test_comments_of_what_is_said_as_one_stand_before_it() -> None:
    mission = 'for each n in 1, 2: say "round {n}"\nset x to 1\nsay "{x} more"\n'
    lines = str(parse_tree(mission).to("xml")).splitlines()
    start, end = (
        next(i for i, line in enumerate(lines) if tag in line) for tag in ("<BehaviorTree", "<TreeNodesModel")
    )
    for at in range(end - 1, start - 1, -1):
        if "</" not in lines[at]:
            lines.insert(at, f"<!-- {lines[at].split()[0][1:].strip('>')} -->")
    said = str(parse_tree(Source("\n".join(lines), "tree.xml")).to("english"))
    assert "\n".join(line for line in said.splitlines() if line[0] != "#") == mission.strip()
    assert said.count("# ") == sum("<!--" in line for line in lines)
