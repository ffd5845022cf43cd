"""Trees in XML and JSON with `btc edit`: in English beside them, and copies that are saved."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.editing.words import Words
from btlang.server.files import TreeFiles, english_beside, tree_sort

TREE = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main"><Sequence><!-- both --><Open door="kitchen"/><SubTree ID="Grab"/></Sequence></BehaviorTree>
  <BehaviorTree ID="Grab"><RetryUntilSuccessful num_attempts="3"><Grasp/></RetryUntilSuccessful></BehaviorTree>
</root>
"""


def test_a_tree_is_opened_in_english_and_saved_as_a_copy(tmp_path: Path) -> None:
    tree = tmp_path / "tree.xml"
    tree.write_text(TREE)
    files = TreeFiles(Words(file=english_beside(str(tree))), str(tree))
    assert (files.name, tree_sort(str(tree))) == ("tree.edited.txt", "xml")
    first = files.read(files.name)
    assert (first["tree"], first["copy"], first["revision"]) == ("tree.xml", "tree.edited.xml", "")
    assert "# both\n" in first["text"]
    assert parse_tree(first["text"]).tree == parse_tree(TREE).tree
    changed = first["text"].replace("3 times", "5 times") + "# the end\n"
    saved = files.save(files.name, changed, "")
    assert (saved.ok, saved.data.get("problem")) == (True, None)
    copy = tmp_path / "tree.edited.xml"
    assert parse_tree(copy.read_text()).tree == parse_tree(TREE.replace('"3"', '"5"')).tree
    assert tree.read_text() == TREE
    assert files.read(files.name)["text"] == changed  # with what no tree holds

    before = copy.read_text()
    unfinished = files.save(files.name, changed + "wavee\n", saved.data["revision"])
    assert unfinished.ok
    assert "wavee" in unfinished.data["problem"]
    assert (copy.read_text(), files.read(files.name)["text"]) == (before, changed + "wavee\n")
    stale = files.save(files.name, changed, saved.data["revision"])
    assert (stale.ok, stale.code, copy.read_text()) == (False, "BT187", before)

    copy.write_text(before + "<!-- by hand -->\n")
    kept = files.save(files.name, changed, unfinished.data["revision"])
    assert (kept.ok, "another program" in kept.data["problem"]) == (True, True)
    assert copy.read_text() == before + "<!-- by hand -->\n"
    copy.unlink()
    assert "problem" not in files.save(files.name, changed, kept.data["revision"]).data
    assert copy.read_text() == before

    assert "problem" not in files.read(files.name)
    os.utime(tree, (time.time() + 9, time.time() + 9))
    assert "tree.xml has changed since" in files.read(files.name)["problem"]


def test_a_file_that_has_the_name_of_a_copy_stays(tmp_path: Path) -> None:
    tree, copy = tmp_path / "tree.xml", tmp_path / "tree.edited.xml"
    tree.write_text(TREE)
    copy.write_text("mine")
    files = TreeFiles(Words(file=english_beside(str(tree))), str(tree))
    assert "another program" in files.save(files.name, files.read(files.name)["text"], "").data["problem"]
    assert copy.read_text() == "mine"


@pytest.mark.parametrize("name", ["tree.json", "tree.txt", "tree"])
def test_a_tree_is_known_by_what_is_in_it(tmp_path: Path, name: str) -> None:
    tree = tmp_path / name
    tree.write_text(str(parse_tree(TREE).to("json")))
    files = TreeFiles(Words(file=english_beside(str(tree))), str(tree), "Grab")
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
