"""The table of front ends: which one reads a text, and what each takes."""

from __future__ import annotations

from importlib import import_module
from inspect import signature

import pytest

import btlang
from btlang.frontends.table import FRONTENDS, frontend_of
from btlang.text.source import Source


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("wave", "english"),
        ("", "english"),
        ("{counter} is 3", "english"),
        ("{", "english"),
        ('{"format": 1}', "json"),
        ("\ufeff\n { }", "json"),
        ("<root/>", "xml"),
        ("\ufeff \t\r\n<", "xml"),
    ],
)
def test_how_a_text_begins_says_who_reads_it(text: str, name: str) -> None:
    assert frontend_of(Source(text)) == name


@pytest.mark.parametrize("name", FRONTENDS)
def test_a_front_end_is_a_function_that_takes_its_options(name: str) -> None:
    frontend = FRONTENDS[name]
    module, _, function = frontend.read.partition(":")
    assert set(frontend.options) <= set(signature(getattr(import_module(module), function)).parameters)


@pytest.mark.parametrize(
    "text", ["wave", '<root BTCPP_format="4"><BehaviorTree ID="a"><AlwaysSuccess/></BehaviorTree></root>']
)
def test_a_tree_that_there_is_not_cannot_be_chosen(text: str) -> None:
    with pytest.raises(btlang.MissionError) as caught:
        btlang.parse_tree(text, main="other")
    assert [problem.code for problem in caught.value.diagnostics] == ["BT126"]


def test_one_of_several_trees_in_json_is_chosen() -> None:
    tree = btlang.parse_tree("the dance is nod\nwave then dance").tree
    document = str(btlang.parse_tree("the dance is nod\nwave then dance").to("json"))
    assert [name for name, _ in tree.subtrees] == ["dance"]
    assert btlang.parse_tree(document, main="dance").tree.name == "dance"
    with pytest.raises(btlang.MissionError):
        btlang.parse_tree(document, main="other")
