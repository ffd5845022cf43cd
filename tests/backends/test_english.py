"""Trees to English and back: the same tree, by both parsers, and the same text again."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, note

from btlang.api import parse_tree, world_vocabulary
from btlang.backends.english import to_english
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import read_source
from btlang.frontends.mission.reader import read_mission
from btlang.passes import lower_mission
from btlang.passes.compilation import Compilation
from btlang.passes.lint.two_readings import two_readings
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from tests.backends.any_tree import trees
from tests.conftest import matches_golden
from tests.profiles import searches

PARSERS = ("shunting-yard", "lark")
CORPUS = sorted((Path(__file__).parents[1] / "corpus" / "good").glob("*.xml"))


@searches(15, 3000)
@given(trees())
def test_any_tree_is_said_and_read_back(tree: Tree) -> None:
    vocabulary = world_vocabulary()
    note(plain(tree))
    text = to_english(tree, vocabulary)
    for parser in PARSERS:
        mission = read_mission(Source(text), vocabulary, parser).mission
        again = lower_mission(mission, vocabulary)
        assert plain(again) == plain(tree)
        for models in (tree.models, (*tree.models, *again.models)):
            assert to_english(again.replace(models=models), vocabulary) == text
        assert not list(two_readings(Compilation(vocabulary, mission, again)))


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_trees_of_the_corpus(path: Path) -> None:
    tree = parse_tree(read_source(str(path)))
    text = str(tree.to("english"))
    for parser in PARSERS:
        again = lower_mission(read_mission(Source(text), tree.vocabulary, parser).mission, tree.vocabulary)
        assert plain(again) == plain(tree.tree)


def test_comments_stand_before_what_they_are_about() -> None:
    folder = Path(__file__).parent
    matches_golden(str(parse_tree(read_source(str(folder / "comments.xml"))).to("english")), folder / "comments.txt")


KINDS = """
<root BTCPP_format="4">
  <BehaviorTree ID="MainTree">
    <Sequence>
      <Condition ID="OnAir"/>
      <Fallback> <OnAir name="still"/> <Wave/> </Fallback>
      <OpenGripper/>
      <IfThenElse> <IsOk/> <IsOk/> <Wave/> </IfThenElse>
    </Sequence>
  </BehaviorTree>
</root>
"""


@pytest.mark.parametrize("parser", PARSERS)
def test_a_condition_without_words_stays_one(parser: str) -> None:
    """Told by a tag, or by where else it stands: `IsOk` is asked by the node around it."""
    text = str(parse_tree(KINDS).to("english"))
    assert text.splitlines() == [
        "check test on air",
        'check test on air called "still" or wave',
        'do "OpenGripper"',
        "if test is ok, check test is ok otherwise wave",
    ]
    again = parse_tree(text, parser=parser)
    assert again.to("english") == text
    assert '<Condition ID="OnAir"/>' in str(again.to("xml", dialect=3))
    assert '<Condition ID="IsOk"/>' in str(again.to("xml"))
    assert '<Action ID="OpenGripper"/>' in str(again.to("xml"))


def test_a_tree_without_a_text() -> None:
    """No quotes hold a line end in the name of a subtree, so that there is a message in place of a wrong mission."""
    tree = Tree(Node("SubTree", (), (("ID", "a\nb"),)), (("a\nb", Node("Wave")),))
    with pytest.raises(MissionError, match="BT142"):
        to_english(tree, world_vocabulary())


def test_explaining_a_tree_of_xml() -> None:
    explained = parse_tree('<root BTCPP_format="4"><BehaviorTree ID="MainTree"><Wave/></BehaviorTree></root>').explain()
    assert explained == "line 1: wave\n  read as: wave\n\n  Wave: wave"
