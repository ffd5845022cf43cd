"""Trees to English and back: the same tree, by both parsers, and the same text again."""

from __future__ import annotations

from hypothesis import given, note, settings

from btlang.api import world_vocabulary
from btlang.backends.english import to_english
from btlang.frontends.mission import read_mission
from btlang.passes import lower_mission
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.tree.node import Tree
from tests.backends.any_tree import trees

PARSERS = ("shunting-yard", "lark")


@settings(max_examples=300)
@given(trees())
def test_any_tree_is_said_and_read_back(tree: Tree) -> None:
    vocabulary = world_vocabulary()
    note(plain(tree))
    text = to_english(tree, vocabulary)
    for parser in PARSERS:
        again = lower_mission(read_mission(Source(text), vocabulary, parser).mission, vocabulary)
        assert plain(again) == plain(tree)
        assert to_english(again.replace(models=tree.models), vocabulary) == text
