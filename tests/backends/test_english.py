"""Trees to English and back: the same tree, by both parsers, and the same text again."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, note

from btlang.api import parse_tree
from btlang.backends.english import to_english
from btlang.backends.english.target import remove_editor_attributes
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.frontends.mission.reader import read_mission
from btlang.passes import lower_mission
from btlang.passes.compilation import Compilation
from btlang.passes.lint.two_readings import find_two_readings
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from tests.backends.any_tree import trees
from tests.conftest import matches_golden
from tests.profiles import searches

PARSERS = ("shunting-yard", "lark")
CORPUS = sorted((Path(__file__).parents[1] / "corpus" / "good").glob("*.xml"))


@searches(8, 3000)
@given(trees())
def test_any_tree_is_said_and_read_back(tree: Tree) -> None:
    vocabulary = world_vocabulary()
    note(plain(tree))
    text = to_english(tree, vocabulary)
    for parser in PARSERS:
        mission = read_mission(Source(text), vocabulary, parser).mission
        again = lower_mission(mission, vocabulary)
        assert plain(again) == plain(remove_editor_attributes(tree))
        for models in (tree.models, (*tree.models, *again.models), again.models):
            assert to_english(again.replace(models=models), vocabulary) == text
        told = {model.id for model in tree.models if model.kind == "Condition"}
        conditions = {model.id for model in again.models if model.kind == "Condition"} - told
        assert all(id in ("IsOk", "CheckDoor") or vocabulary.entry(id) or CATALOGUE[id].kind for id in conditions)
        assert not list(find_two_readings(Compilation(vocabulary, mission, again)))


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_trees_of_the_corpus(path: Path) -> None:
    tree = parse_tree(read_source(str(path)))
    text = str(tree.to("english"))
    for parser in PARSERS:
        again = lower_mission(read_mission(Source(text), tree.vocabulary, parser).mission, tree.vocabulary)
        assert plain(again) == plain(remove_editor_attributes(tree.tree))


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
        "do OpenGripper",
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


def said(xml: str) -> list[str]:
    """The English of the nodes of a tree, which both parsers read back as it."""
    tree = parse_tree(f'<root BTCPP_format="4"><BehaviorTree ID="MainTree">{xml}</BehaviorTree></root>')
    text = str(tree.to("english"))
    for parser in PARSERS:
        again = parse_tree(text, parser=parser)
        assert plain(again.tree) == plain(remove_editor_attributes(tree.tree))
        again_said = str(again.to("english")).splitlines()
        assert again_said == [line for line in text.splitlines() if line[:1] != "#"]
    return [line for line in text.splitlines() if not line.startswith("#:")]


IDS = [
    ("OpenBox", "do open box"),
    ("Move2Box", "do move2 box"),
    ("GetXYZ", "do get XYZ"),
    ("InitializeMTCTask", "do initialize MTC task"),
    ("UIShowRRT2Path", "do UI show RRT2 path"),
    ("MoveX", "do move x"),
    ("GetMasks3D", "do GetMasks3D"),
    ("XYZ", 'do "XYZ"'),
    *((odd, f"do {odd}") for odd in ("MoveTHEArm", "GoToA", "WAVENow", "PickAThing")),  # shouted, or with an article
    *((odd, f"do {odd}") for odd in ("openBox", "Move_To", "move_to")),  # no CamelCase
    *((odd, f'do "{odd}"') for odd in ("open", "ReadyÄ", "Box-1", "MOVE_TO")),
    *((known, f"do {known}") for known in ("OpenGripper", "SayHello", "TurnLeft2M", "GoToTheLab")),  # phrases
    ("Say", 'do "Say"'),
    ("RecoveryNodes", "do RecoveryNodes"),  # near to what is known
    *((slip, f'do "{slip}"') for slip in ("Wavee", "Sequence2")),
    *((joins, f"do {joins}") for joins in ("PickAndPlace", "MoveUntilWall", "DoorIsOpen", "RunTwice")),
    ("IncreaseSpeed", "do IncreaseSpeed"),
    ("WaitForGoal", "do wait for goal"),
    ("CheckBattery", "do check battery"),
]  # fmt: skip


@pytest.mark.parametrize(("node_id", "text"), IDS)
def test_an_id_in_words_where_they_are_free(node_id: str, text: str) -> None:
    assert said(f'<Action ID="{node_id}"/>') == [text]
    assert said(f'<Sequence><Action ID="{node_id}" speed="2"/><Wave/></Sequence>') == [f"{text} with speed 2", "wave"]


def test_ports_stand_behind_one_with_and_outputs_last() -> None:
    models = (
        '</BehaviorTree><TreeNodesModel><Action ID="Plan"><output_port name="path"/><output_port name="cost"/>'
        '<inout_port name="map"/></Action></TreeNodesModel><BehaviorTree ID="Other"><Plan path="{path}"/>'
    )
    text = said('<Sequence><Plan path="{path}" goal="{goal}" say="x" place="a, b" map="{map}"/>'
                '<Plan cost="{c}" path="{path}"/><Plan path="{route}"/><Plan path="p"/></Sequence>'
                + models)  # fmt: skip
    assert text == [
        '"Other" means do plan giving {path}',
        'do plan with {goal} with say "x", place "a, b", {map} giving {path}',
        "do plan giving cost {c}, {path}",
        "do plan giving path {route}",
        'do plan with path "p"',
    ]


PORTS_LIKE_WORDS = [
    ('with="3"', 'with "with" 3'),
    ('speed="2" with="{k}"', 'with speed 2 with "with" {k}'),
    ('speed="2" with_care="1" use_with="2"', "with speed 2, with_care 1, use with 2"),
    ('is_open="true" door_is_open="{k}"', 'with is_open "true", door_is_open {k}'),
    ('is="{is}" means="{means}"', 'with "is" "{is}", "means" "{means}"'),
    ('increase_rate="2" rate="{decrease}"', 'with increase_rate 2, rate "{decrease}"'),
    ('then="{then}" called="{k}" giving="4"', "with {then}, called {k}, giving 4"),
]


@pytest.mark.parametrize(("ports", "text"), PORTS_LIKE_WORDS)
def test_ports_and_keys_may_be_words_of_the_language(ports: str, text: str) -> None:
    assert said(f"<OpenBox {ports}/>") == [f"do open box {text}"]
    assert said(f"<Gate {ports}><OpenBox/></Gate>") == [f"do gate {text}:", "  do open box"]


def test_what_only_editors_write_is_not_said() -> None:
    ports = '_uid="3" _fullpath="a/b" _collapsed="1" _skipIf="x &gt; 1" _onSuccess="y := 2"'
    assert said(f"<!-- ////// --><OpenBox {ports}/><!-- ---\n===\nlid -->") == [
        "# lid",
        'do open box with _onSuccess "y := 2" unless "x > 1"',
    ]


def test_a_subtree_whose_name_would_change_a_value_is_said_in_quotes() -> None:
    text = said('<SubTree ID="slowly increase"/></BehaviorTree><BehaviorTree ID="slowly increase"><Wave/>')
    assert text == ['"slowly increase" means wave', 'do "slowly increase"']


def test_a_subtree_is_said_by_its_name() -> None:
    text = said(
        '<Sequence><SubTree ID="Back off"/><SubTree ID="Approach Shelf" n="1"/><SubTree ID="move_arm"/>'
        '<SubTree ID="Else"/>'
        '<Action ID="Move arm"/><Action ID="ApproachShelf"/><Action ID="move_arm"/></Sequence></BehaviorTree>'
        '<BehaviorTree ID="Approach Shelf"><Wave/></BehaviorTree><BehaviorTree ID="move_arm"><Nod/>'
    )  # fmt: skip
    assert text[-7:] == [
        'do "Back off"',
        "do approach shelf with n 1",
        "do move_arm",
        'do subtree "Else"',
        'do node "Move arm"',
        "do ApproachShelf",
        'do node "move_arm"',
    ]


@pytest.mark.parametrize("parser", PARSERS)
def test_the_older_ways_are_still_read(parser: str) -> None:
    for older, now in [
        ("do open box with a b 1 with c 2", "do open box with b 1, c 2"),
        ('do "OpenBox" with c 2, with d 3 giving {e}', "do open box with c 2, d 3 giving {e}"),
        ('"The Tour" is wave\ndo subtree "The Tour"', '"The Tour" is wave\ndo "The Tour"'),
        ("patrol is wave\npatrol twice", "patrol is wave\ndo patrol twice"),
        ("do twist is wave\ndo twist twice", "do twist means wave\n(do twist) twice"),
        ("do open box with c 2, then wave 3 times", "do open box with c 2, wave 3 times"),
    ]:
        assert parse_tree(older, parser=parser).tree == parse_tree(now, parser=parser).tree


def test_no_long_lines() -> None:
    """A line that would be too long goes on below a comma, also the head of a block and a condition."""
    ports = " ".join(f'the_name_of_port_{number}="a text, and more {number}"' for number in range(9))
    for xml in (
        f"<OpenBox {ports}/>",
        f"<Sequence><Wave/><RateController {ports}><Sequence><OpenBox {ports}/><Wave/></Sequence></RateController>"
        "</Sequence>",
        f'<IfThenElse><Condition ID="LidOpen" {ports}/><Action ID="OpenBox" {ports}/><Wave/></IfThenElse>',
        f'<SubTree ID="The Way" {ports}/></BehaviorTree><BehaviorTree ID="The Way"><Fallback><OpenBox {ports}/><Nod/>'
        "</Fallback>",
    ):
        lines = said(xml)
        assert max(map(len, lines)) <= 100, lines
    assert lines[-2:] == [
        '    the_name_of_port_6 "a text, and more 6", the_name_of_port_7 "a text, and more 7",',
        '    the_name_of_port_8 "a text, and more 8"',
    ]
