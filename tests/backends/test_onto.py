"""Edits in English give the smallest changes of the XML: samples, all trees there are, and random ones."""

from __future__ import annotations

from difflib import unified_diff
from pathlib import Path

import pytest
from hypothesis import given, reject
from hypothesis import strategies as st

from btlang.backends.btcpp import to_xml
from btlang.backends.btcpp.onto import write_onto
from btlang.backends.english import to_english
from btlang.backends.english.target import remove_editor_attributes
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.mission.reader import read_mission
from btlang.passes import lower_mission
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from tests.backends.any_tree import trees
from tests.corpus.test_team import FILES, edits_of, read
from tests.profiles import searches

WORDS = world_vocabulary()
GOOD = sorted(Path(__file__).parent.parent.joinpath("corpus", "good").rglob("*.xml"))
FURTHER_LINES = 2  # of a difference, beside those of the edit that a careful person makes by hand


def mission_of(text: str) -> Tree:
    """The tree of a text in English."""
    return lower_mission(read_mission(Source(text, "mission.txt"), WORDS).mission, WORDS)


def changed_lines(before: str, after: str) -> list[str]:
    """The lines that a difference shows as gone or come."""
    lines = unified_diff(before.split("\n"), after.split("\n"), n=0, lineterm="")
    return [line for line in lines if line[:1] in "+-" and line[:3] not in ("---", "+++")]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_edits_of_a_team_s_trees(path: Path) -> None:
    """What English says of the edited file is written onto the file as it was; attributes of editors stay its own."""
    before = read_source(str(path))
    for number, (kind, text) in enumerate(edits_of(path), 1):
        wanted = text.removeprefix("\ufeff")
        tree = read(text, path)
        made = write_onto(before, mission_of(to_english(tree, WORDS)), WORDS)
        assert plain(remove_editor_attributes(read(made, path))) == plain(remove_editor_attributes(tree)), (
            f"edit {number}, {kind}"
        )
        most = len(changed_lines(before.text, wanted)) + FURTHER_LINES
        assert len(changed_lines(before.text, made)) <= most, f"edit {number}, {kind}"


@pytest.mark.parametrize("path", [*FILES, *GOOD], ids=lambda path: path.stem)
def test_without_an_edit_no_byte_changes(path: Path) -> None:
    source = read_source(str(path))
    text = to_english(read_xml(source), WORDS)
    assert write_onto(source, mission_of(text), WORDS) == source.text


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_comments_and_models_come_back_without_the_file(path: Path) -> None:
    """English -> XML -> English: what a person reads is the same, and the models of the file are there again."""
    tree = read_xml(read_source(str(path)))
    text = to_english(tree, WORDS)
    again = read_xml(Source(to_xml(mission_of(text), WORDS)))
    assert _read_by_people(to_english(again, WORDS)) == _read_by_people(text)
    written = {model.id: model for model in tree.models if f'ID="{model.id}"' in text.partition("#: <Tree")[2]}
    kept = {model.id: model for model in again.models}
    assert {name: kept[name] for name in written} == written


def _read_by_people(text: str) -> list[str]:
    return [line for line in text.split("\n") if not line.startswith("#:")]


def test_a_node_that_went_elsewhere_is_not_taken_twice() -> None:
    wave, sleep = Node("Wave"), Node("Sleep", ports=(("msec", "1500"),))
    other = Node("Sleep", ports=(("msec", "{_1}"),))
    before = Tree(Node("Sequence", (wave, sleep)))
    round_ = Node("Repeat", (Node("Sequence", (Node("Script", ports=(("code", "_1 := 2"),)), other)),))
    patrol = Node("Sequence", (wave, Node("Sequence", (sleep,))))
    after = Tree(round_.replace(ports=(("num_cycles", "3"),)), (("patrol", patrol),))
    made = write_onto(_written(before), after, WORDS)
    assert _in_any_order(read_xml(Source(made))) == _in_any_order(after)


def test_a_new_node_with_the_id_of_a_tree() -> None:
    wave = Node("Wave")
    before = Tree(wave, (("GraspObject", wave), ("each", wave)))
    after = Tree(wave, (("GraspObject", wave), ("each", Node("Sequence", (wave, Node("GraspObject"))))))
    made = write_onto(_written(before), after, WORDS)
    assert _in_any_order(read_xml(Source(made))) == _in_any_order(after)


@searches(5, 3000, deadline=None)
@given(trees(), trees())
def test_any_tree_onto_any_other(before: Tree, after: Tree) -> None:
    """Nothing that was written onto a file is lost, however much is edited at once."""
    original = _written(before)
    _written(after)
    made = write_onto(original, after, WORDS)
    told = f"{original.text}\n\n{_written(after).text}\n\n{made}"
    assert _in_any_order(read_xml(Source(made))) == _in_any_order(after), told
    assert write_onto(Source(made), after, WORDS) == made


@searches(6, 1000, deadline=None)
@given(trees(), st.data())
def test_a_changed_value_changes_one_line(tree: Tree, data: st.DataObject) -> None:
    original = _written(tree)
    lines = original.text.split("\n")
    at = data.draw(st.sampled_from([number for number, line in enumerate(lines) if ' text="' in line] or [-1]))
    if at < 0:
        return
    lines[at] = lines[at].replace(' text="', ' text="9', 1)
    wanted = read_xml(Source("\n".join(lines)))
    assert write_onto(original, wanted, WORDS) == "\n".join(lines)


def _in_any_order(tree: Tree) -> tuple[Node, str, dict[str, Node]]:
    """What is said of a tree: a file keeps the order of its trees and attributes, and what editors wrote."""

    def sorted_ports(node: Node, children: list[Node]) -> Node:
        return node.replace(children=tuple(children), ports=tuple(sorted(node.ports)))  # type: ignore[no-any-return]

    def in_order(root: Node) -> Node:
        return fold(root, lambda node: node.children, sorted_ports)

    bare = remove_editor_attributes(tree)
    return in_order(bare.root), bare.name, {name: in_order(root) for name, root in bare.subtrees}


def _written(tree: Tree) -> Source:
    """Of trees that XML can hold."""
    try:
        return Source(to_xml(tree, WORDS))
    except MissionError:
        reject()


LINES = """<root BTCPP_format="4" main_tree_to_execute="__Up__">
  <BehaviorTree ID="__Up__">
    <Sequence>
      <PickUp item="cup"/>
      <SubTree ID="_Down"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="_Down">
    <PickUp item="mug"/>
  </BehaviorTree>
  <TreeNodesModel>
    <Action ID="PickUp">
      <description>Picks a thing up.
      It waits.</description>
      <input_port name="item" type="std::string">what
      to pick up</input_port>
    </Action>
  </TreeNodesModel>
</root>
"""


def test_descriptions_of_several_lines_and_ids_with_underscores_come_back() -> None:
    vocabulary = world_vocabulary()
    text = to_english(read_xml(Source(LINES, "up.xml")), vocabulary)
    tree = lower_mission(read_mission(Source(text), vocabulary).mission, vocabulary)
    written = to_xml(tree, vocabulary)
    for line in LINES.splitlines():
        assert line.strip() in written


def test_a_file_with_one_tree_of_its_own_needs_no_main_tree(tmp_path: Path) -> None:
    tree = '<BehaviorTree ID="{}"><AlwaysSuccess/></BehaviorTree>'
    library = f'<root BTCPP_format="4">{tree.format("A")}{tree.format("B")}</root>'
    (tmp_path / "library.xml").write_text(library, encoding="utf-8")
    path = tmp_path / "own.xml"
    path.write_text(
        f'<root BTCPP_format="4"><include path="library.xml"/>{tree.format("Own")}</root>', encoding="utf-8"
    )
    assert read_xml(read_source(str(path))).name == "Own"
