"""XML files in the place of keyword files: their nodes have the words that `btc words --from` would write."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.api import parse_file, parse_tree
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.words import RobotWords
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source

NODES = """<root BTCPP_format="4">
  <TreeNodesModel>
    <Action ID="MoveToPose">
      <input_port name="pose"/>
      <input_port name="grip" type="" default="top">top|side</input_port>
      <output_port name="error" type="int"/>
    </Action>
    <Condition ID="IsLidOpen"/>
  </TreeNodesModel>
</root>
"""
SAID = "if the lid is open, move to pose table grip side\n"


@pytest.fixture
def nodes(tmp_path: Path) -> str:
    path = tmp_path / "nodes.xml"
    path.write_text(NODES)
    return str(path)


def test_words_are_those_of_the_pack(nodes: str, tmp_path: Path) -> None:
    pack = tmp_path / "nodes.toml"
    assert main(["words", "--from", nodes, "-o", str(pack)]) == 0
    for parser in ("shunting-yard", "lark"):
        by_models, by_pack = (parse_tree(SAID, parser=parser, keywords=[words]) for words in (nodes, str(pack)))
        assert by_models.tree == by_pack.tree
        assert str(by_models.to("english")) == str(by_pack.to("english")) == SAID.replace("the ", "")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["nodes.toml", "nodes.xml"]


def test_every_verb_takes_them(nodes: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--keywords", nodes]
    for verb in (["check"], ["tree"], ["explain"], ["compile", "--to", "xml"], ["compile", "--to", "python"]):
        assert main([*verb, *words, "-c", SAID]) == 0, verb
    assert main(["words", *words, "lid"]) == 0
    assert "lid is open" in capsys.readouterr().out
    tree = tmp_path / "tree.xml"
    tree.write_text('<root BTCPP_format="4"><BehaviorTree ID="M"><MoveToPose pose="{dock}"/></BehaviorTree></root>')
    assert main(["compile", str(tree), "--to", "english", *words]) == 0
    assert 'move to pose "{dock}"' in capsys.readouterr().out
    source = Source("", str(tmp_path / "mission.txt"), may_load=True)
    assert "IsLidOpen" in RobotWords([nodes]).vocabulary(source).entries  # of the page


def test_to_run_them_takes_functions(nodes: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--keywords", nodes, "-c", "move to pose table"]) == 2
    assert f"{nodes}:3:5: error BT080: The command 'MoveToPose' can't run" in capsys.readouterr().err


def test_a_mission_names_them(nodes: str, tmp_path: Path) -> None:
    mission = tmp_path / "mission.txt"
    mission.write_text(f'words "nodes.xml"\n{SAID}')
    assert parse_file(str(mission)).tree == parse_tree(SAID, keywords=[nodes]).tree
    (tmp_path / "nodes.xml").write_text("<root>")
    with pytest.raises(MissionError) as caught:
        parse_file(str(mission))
    [problem] = caught.value.diagnostics
    assert (problem.code, problem.span.source.name) == ("BT120", nodes)
    assert problem.notes[-1][0].text == 'words "nodes.xml"'


def test_words_of_others_stay(nodes: str, tmp_path: Path) -> None:
    """Those that a keyword file has, in whatever order the files are named; changes of a file count."""
    own = tmp_path / "own.toml"
    own.write_text('[[action]]\nphrase = "drive over {pose}"\nid = "MoveToPose"\nslots = {pose = "text"}\n')
    for files in ([str(own), nodes], [nodes, str(own)]):
        entries = world_vocabulary(files).entries
        assert [entry.phrases for entry in entries["MoveToPose"]] == [("drive over {pose}",)]
        assert [entry.phrases for entry in entries["IsLidOpen"]] == [("lid is open",)]
    Path(nodes).write_text(NODES.replace("IsLidOpen", "IsLidShut"))
    assert "IsLidShut" in world_vocabulary([nodes]).entries


def test_several_files_count_together(nodes: str, tmp_path: Path) -> None:
    """A port that a tree leaves out is optional, whichever file has the tree."""
    tree = tmp_path / "tree.btproj"
    tree.write_text('<root BTCPP_format="4"><BehaviorTree ID="M"><MoveToPose grip="top"/></BehaviorTree></root>')
    [entry] = world_vocabulary([nodes, str(tree)]).entries["MoveToPose"]
    assert "[pose {pose}]" in entry.phrases[0]


def test_what_cannot_be_read_is_reported_where_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.xml"
    bad.write_text('<root BTCPP_format="4">\n<TreeNodesModel><Action ID="A"></TreeNodesModel></root>')
    assert main(["check", "--keywords", str(bad), "-c", "wave"]) == 2
    assert f"{bad}:2:32: error BT120" in capsys.readouterr().err
    assert main(["check", "--keywords", str(tmp_path / "no.xml"), "-c", "wave"]) == 2
    assert "error BT001" in capsys.readouterr().err
