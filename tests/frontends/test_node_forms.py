"""Nodes that are said by a form or a name with the children below them, as docs/language/nodes.md lists them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import btlang
from btlang.api import mission_of_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.printer.mission import english
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from btlang.vocabulary.node_forms import node_forms

PAGE = Path(__file__).parents[2] / "docs" / "language" / "nodes.md"
BODY = ":\n  wave\n  nod"
FORMS = [form.say(["3", "3"]) for form in node_forms(world_vocabulary())]


def tree_of(text: str, parser: str = "shunting-yard") -> Tree:
    return btlang.parse_tree(text, parser=parser).tree


@pytest.mark.parametrize("said", FORMS)
def test_a_form_is_its_node_by_both_parsers_and_is_said_again(said: str) -> None:
    children = ":\n  wave" if "a second" in said or "again and again" in said else BODY
    for name in ("", '"first part", '):
        text = f"{name}{said}{children}"
        tree = tree_of(text)
        assert tree == tree_of(text, "lark")
        assert tree.root.name == ("first part" if name else "")
        again = btlang.parse_tree(text).to("english")
        assert tree_of(again) == tree
        if tree.root.id not in ("Sequence", "Fallback", "ForceSuccess"):  # which are said in shorter ways
            assert again.strip() == text


def test_the_page_lists_all_forms() -> None:
    listed = re.findall(r"`([^`|]+):`", PAGE.read_text("utf-8").split("| form | node |")[1].split("\n\n")[0])
    said = {re.sub(r"\d+(\.\d+)?|\"[^\"]*\"|\{\w+\}", "N", text) for text in listed}
    assert said == {form.say("NN") for form in node_forms(world_vocabulary())}


@pytest.mark.parametrize(
    ("root", "said"),
    [
        (Node("Sequence", name="a"), '"a"'),
        (Node("Sequence", name='a "b" c'), 'step by step called "a " \'"\' "b" \'"\' " c"'),
        (Node("Sequence", name="a\nb"), 'step by step called "a" newline "b"'),
        (Node("Sequence", ports=(("_skipIf", "x"),), name="a"), '"a", step by step unless "x"'),
        (Node("RoundRobin", ports=(("wrap_around", "true"),)), 'taking turns with wrap around "true"'),
        (Node("RecoveryNode", ports=(("number_of_retries", "1"),)), "recovering once"),
        (Node("RecoveryNode", ports=(("number_of_retries", "{n}"),)), "recovering up to {n} times"),
        (Node("RecoveryNode"), "do recovery node"),
        (Node("RateController", ports=(("hz", "1"),)), "at most once per second"),
    ],
)
def test_names_and_ports_are_kept(root: Node, said: str) -> None:
    """What a form or a name before it can't hold is said as before."""
    children = (Node("Wave"),) if root.id == "RateController" else (Node("Wave"), Node("Nod"))
    tree = Tree(root.replace(children=children))
    text = mission_of_tree(tree, world_vocabulary()).to("english")
    assert text.split(":\n")[0] == said
    assert plain(tree_of(text)) == plain(tree)


@pytest.mark.parametrize("text", ['say "hello":', "taking turns", 'wave then "a":\n  nod', '"a", wave:\n  nod'])
def test_elsewhere_these_are_no_forms(text: str) -> None:
    with pytest.raises(MissionError):
        btlang.parse_tree(text)


@pytest.mark.parametrize(
    ("said", "ports"),
    [
        ('wave unless "x > 1"', {"_skipIf": "x > 1"}),
        ('"a": wave with speed 2 while "x < 3"', {"speed": "2", "_while": "x < 3"}),
        ('do plan motion with width 2 giving {cup} succeeding if "a == 1" failing if "b"',
         {"width": "2", "cup": "{cup}", "_successIf": "a == 1", "_failureIf": "b"}),
        ('wave if "x == 6"', {"_skipIf": "x != 6"}),
        ('do subtree "Dock" with all values', {"ID": "Dock", "_autoremap": "true"}),
        ('do subtree "Dock" with _autoremap "false"', {"ID": "Dock", "_autoremap": "false"}),
        ('wave with _skipIf "x", speed 2', {"_skipIf": "x", "speed": "2"}),
    ],
)  # fmt: skip
@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
def test_preconditions_in_words(said: str, ports: dict[str, str], parser: str) -> None:
    read = read_mission(Source(said), world_vocabulary(), parser).mission
    root = compile_mission(read, world_vocabulary()).root
    assert dict(root.ports) == ports
    assert english(read, world_vocabulary()).strip() == said


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ('while "x < 3", do push cart with speed 2', 'do push cart with speed 2 while "x < 3"'),
        ('nod; "a": unless "x", do PushCart; wave', 'nod; "a": do PushCart unless "x"; wave'),
        ('if "x == 6", do push cart:\n  wave\nnod', 'do push cart if "x == 6":\n  wave\nnod'),
    ],
)
@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
def test_a_precondition_before_its_node(text: str, same: str, parser: str) -> None:
    assert tree_of(text, parser) == tree_of(same)


@pytest.mark.parametrize(
    "text",
    ['while "x", do push cart then nod', 'nod then while "x", do push cart', 'if "x", do push cart if "y"',
     'unless "x", nod', 'while "x", do push cart, 3 times'],
)  # fmt: skip
def test_a_precondition_before_more_than_its_node_is_refused(text: str) -> None:
    """It would be that of the first node alone."""
    with pytest.raises(MissionError):
        tree_of(text)


@pytest.mark.parametrize(
    "text", ['wave if "a and b"', 'wave unless "x" unless "y"', "wave unless x", 'wave while "x" with _while "y"']
)
def test_preconditions_that_cannot_be_read(text: str) -> None:
    with pytest.raises(MissionError):
        btlang.parse_tree(text)
