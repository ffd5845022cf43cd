"""Trees as teams have them: each is read, and so is what a careful person makes of it in a text editor.

Beside each file stand its edits (`[[edit]]`), as texts that stand once in it and what replaces them, in order. The
edited file is the ideal: what editing the same in English is measured by.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.reader import read_xml
from btlang.text.source import Source
from btlang.tree.node import Tree
from tests.corpus.same import content

TEAM = Path(__file__).parent / "team"
FILES = sorted(TEAM.glob("*.xml"))
KINDS = {"value", "add", "remove", "move", "wrap", "comment"}
MORE_KINDS = {"rename", "tree", "port"}


def edits_of(path: Path) -> list[tuple[str, str]]:
    """The kind of each edit of a file, and the file after it."""
    before = path.read_bytes().decode()
    edits = []
    for number, edit in enumerate(tomllib.loads(path.with_suffix(".edits.toml").read_text("utf-8"))["edit"], 1):
        text = before
        for old, new in edit["replace"]:
            assert text.count(old) == 1, f"edit {number} of {path.name}: {old!r}"
            text = text.replace(old, new)
        edits.append((edit["kind"], text))
    return edits


def read(text: str, path: Path) -> Tree:
    """The tree of an edited file, which includes what the file includes."""
    folder = str(path.parent)
    return read_xml(Source(text.removeprefix("\ufeff"), str(path), folder, (folder,)))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_each_edit_changes_the_tree(path: Path) -> None:
    before = read_source(str(path))
    tree = read_xml(before)
    edits = edits_of(path)
    assert {kind for kind, _ in edits} >= KINDS
    assert {kind for kind, _ in edits} <= KINDS | MORE_KINDS
    for number, (kind, text) in enumerate(edits, 1):
        edited = read(text, path)
        assert (edited == tree) == (kind == "comment"), f"edit {number}, {kind}"
        assert content(text.removeprefix("\ufeff")) != content(before.text), f"edit {number}, {kind}"


def test_there_are_enough_of_them() -> None:
    assert len(FILES) == 12
    assert all(20 <= path.read_bytes().count(b"\n") <= 150 for path in FILES)


def test_bytes_that_editors_like_to_change_are_there() -> None:
    texts = [path.read_bytes() for path in FILES]
    assert sum(text.startswith(b"\xef\xbb\xbf") for text in texts) == 1
    assert sum(not text.endswith(b"\n") for text in texts) == 1
    [windows] = [text for text in texts if b"\r" in text]
    assert windows.count(b"\r\n") == windows.count(b"\n") == windows.count(b"\r")
    assert b"\n\t" in windows
