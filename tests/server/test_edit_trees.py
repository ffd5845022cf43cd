"""Trees in XML and JSON with `btc edit`: in English, saved onto the XML and into a copy of the JSON."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.editing.words import RobotWords
from btlang.server.page.editor import TreeEditorFiles, XmlEditorFiles, english_beside, tree_sort

TREE = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main"><Sequence><!-- both --><Open door="kitchen"/><SubTree ID="Grab"/></Sequence></BehaviorTree>
  <BehaviorTree ID="Grab"><RetryUntilSuccessful num_attempts="3"><Grasp/></RetryUntilSuccessful></BehaviorTree>
</root>
"""


def test_a_tree_in_xml_is_opened_in_english_and_saved_onto_itself(tmp_path: Path) -> None:
    tree, beside = tmp_path / "tree.xml", tmp_path / "tree.edited.txt"
    tree.write_text(TREE)
    files = XmlEditorFiles(RobotWords(file=english_beside(str(tree))), str(tree))
    assert (files.name, tree_sort(str(tree))) == (beside.name, "xml")
    first = files.read(files.name)
    assert first["tree"] == "tree.xml"
    assert "# both\n" in first["text"]
    changed = first["text"].replace("3 times", "5 times")
    saved = files.save(files.name, changed, first["revision"])
    assert (saved.ok, saved.data.get("problem")) == (True, None)
    assert tree.read_text() == TREE.replace('"3"', '"5"')
    assert not beside.exists()

    unfinished = files.save(files.name, changed + "wavee\n", saved.data["revision"])
    assert unfinished.ok
    assert "wavee" in unfinished.data["problem"]
    assert (tree.read_text(), beside.read_text()) == (TREE.replace('"3"', '"5"'), changed + "wavee\n")
    again = files.read(files.name)
    assert (again["text"], again["revision"]) == (changed + "wavee\n", unfinished.data["revision"])
    assert files.save(files.name, first["text"], again["revision"]).ok
    assert tree.read_text() == TREE
    assert not beside.exists()


def test_what_others_have_changed_stays(tmp_path: Path) -> None:
    tree = tmp_path / "tree.xml"
    tree.write_text(TREE)
    files = XmlEditorFiles(RobotWords(file=english_beside(str(tree))), str(tree))
    first = files.read(files.name)
    by_hand = TREE.replace('"kitchen"', '"lab"')
    tree.write_text(by_hand)
    stale = files.save(files.name, first["text"], first["revision"])
    assert (stale.ok, stale.code, tree.read_text()) == (False, "BT187", by_hand)
    assert "kitchen" in stale.data["diff"]
    assert files.save(files.name, files.read(files.name)["text"], stale.data["revision"]).ok
    assert tree.read_text() == by_hand


def test_a_tree_in_json_is_saved_as_a_copy(tmp_path: Path) -> None:
    tree = tmp_path / "tree.json"
    tree.write_text(str(parse_tree(TREE).to("json")))
    files = TreeEditorFiles(RobotWords(file=english_beside(str(tree))), str(tree))
    assert (files.name, tree_sort(str(tree))) == ("tree.edited.txt", "json")
    first = files.read(files.name)
    assert (first["tree"], first["copy"], first["revision"]) == ("tree.json", "tree.edited.json", "")
    assert parse_tree(first["text"]).tree == parse_tree(TREE).tree
    changed = first["text"].replace("3 times", "5 times") + "# the end\n"
    saved = files.save(files.name, changed, "")
    assert (saved.ok, saved.data.get("problem")) == (True, None)
    copy = tmp_path / "tree.edited.json"
    assert parse_tree(copy.read_text()).tree == parse_tree(TREE.replace('"3"', '"5"')).tree
    assert parse_tree(tree.read_text()).tree == parse_tree(TREE).tree
    assert files.read(files.name)["text"] == changed  # with what no tree holds

    before = copy.read_text()
    unfinished = files.save(files.name, changed + "wavee\n", saved.data["revision"])
    assert unfinished.ok
    assert "wavee" in unfinished.data["problem"]
    assert (copy.read_text(), files.read(files.name)["text"]) == (before, changed + "wavee\n")
    stale = files.save(files.name, changed, saved.data["revision"])
    assert (stale.ok, stale.code, copy.read_text()) == (False, "BT187", before)

    copy.write_text(before + "\n")
    kept = files.save(files.name, changed, unfinished.data["revision"])
    assert (kept.ok, "another program" in kept.data["problem"]) == (True, True)
    assert copy.read_text() == before + "\n"
    copy.unlink()
    assert "problem" not in files.save(files.name, changed, kept.data["revision"]).data
    assert copy.read_text() == before

    assert "problem" not in files.read(files.name)
    os.utime(tree, (time.time() + 9, time.time() + 9))
    assert "tree.json has changed since" in files.read(files.name)["problem"]


def test_a_file_that_has_the_name_of_a_copy_stays(tmp_path: Path) -> None:
    tree, copy = tmp_path / "tree.json", tmp_path / "tree.edited.json"
    tree.write_text(str(parse_tree(TREE).to("json")))
    copy.write_text("mine")
    files = TreeEditorFiles(RobotWords(file=english_beside(str(tree))), str(tree))
    assert "another program" in files.save(files.name, files.read(files.name)["text"], "").data["problem"]
    assert copy.read_text() == "mine"


@pytest.mark.parametrize("name", ["tree.json", "tree.txt", "tree"])
def test_a_tree_is_known_by_what_is_in_it(tmp_path: Path, name: str) -> None:
    tree = tmp_path / name
    tree.write_text(str(parse_tree(TREE).to("json")))
    files = TreeEditorFiles(RobotWords(file=english_beside(str(tree))), str(tree), "Grab")
    text = files.read(files.name)["text"]
    assert files.save(files.name, text, "").ok
    assert parse_tree((tmp_path / "tree.edited.json").read_text()).tree == parse_tree(TREE, main="Grab").tree
    assert (tmp_path / "tree.edited.txt").read_text() == text


@pytest.mark.parametrize("content", [None, "wave\n", "", "{counter} is 3\n"])
def test_a_mission_is_no_tree(tmp_path: Path, content: str | None) -> None:
    if content is not None:
        (tmp_path / "tour.txt").write_text(content)
    os.mkfifo(tmp_path / "pipe.txt")
    assert [tree_sort(str(tmp_path / name)) for name in ("tour.txt", "pipe.txt", ".")] == ["", "", ""]
