"""XML in all its dialects: `good/` is read, written and read again without loss; `bad/` gets its messages.

Beside each good file stands its tree, beside each bad one what `btc run` says of it.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from btlang.cli import main
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.origin import XmlOrigin
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.btcpp.repair import is_odd
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.tree.node import Tree
from tests.conftest import matches_golden, without_pointer
from tests.corpus.same import content, read, written

CORPUS = Path(__file__).parent
GOOD = sorted((CORPUS / "good").glob("*.xml"))
BAD = sorted((CORPUS / "bad").glob("*.xml"))
CHECKED_AS_PROJECTS = ("no_tree", "several_main_trees", "include_with_mistakes")
"""Which can't run, but may be parts of a project, or have more mistakes there."""


def name(path: Path) -> str:
    return path.stem


def dialect_of(tree: Tree) -> int:
    assert isinstance(tree.origin, XmlOrigin)
    return tree.origin.dialect


@pytest.mark.parametrize("path", GOOD, ids=name)
def test_tree(path: Path) -> None:
    tree = read_xml(read_source(str(path)))
    assert dialect_of(tree) == (3 if "v3" in path.stem else 4)
    matches_golden(plain(tree) + "\n", path.with_suffix(".tree"))


@pytest.mark.parametrize("path", GOOD, ids=name)
def test_the_same_dialect_gives_the_file_back(path: Path) -> None:
    source = read_source(str(path))
    tree = read_xml(source)
    text = written(tree, dialect_of(tree))
    assert content(text) == content(source.text)
    again = read_xml(Source(text, str(path)))
    assert again == tree
    assert written(again, dialect_of(tree)) == text


@pytest.mark.parametrize("path", GOOD, ids=name)
def test_strict_parsers_agree(path: Path) -> None:
    """An independent view of what is the same, for files that ElementTree reads."""
    source = read_source(str(path))
    try:
        before = ElementTree.canonicalize(source.text, strip_text=True, with_comments=True)
    except ElementTree.ParseError:
        pytest.skip("only tinyxml2 reads it")
    if is_odd(source.text.replace(">", "")):
        pytest.skip("tinyxml2 reads its values in another way")
    tree = read_xml(source)
    after = ElementTree.canonicalize(written(tree, dialect_of(tree)), strip_text=True, with_comments=True)
    assert after == before


@pytest.mark.parametrize("dialect", [3, 4])
@pytest.mark.parametrize("path", GOOD, ids=name)
def test_the_canonical_form_gives_the_tree_back(path: Path, dialect: int) -> None:
    tree = read_xml(read_source(str(path)))
    bare = tree.replace(origin=None)
    text = written(bare, dialect)
    ElementTree.fromstring(text)
    again = read(text)
    assert again == tree
    assert dialect_of(again) == dialect
    assert written(again.replace(origin=None, models=tree.models), dialect) == text
    assert written(again, dialect) == text


@pytest.mark.parametrize("path", BAD, ids=name)
def test_message(path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    assert main(["run", path.name]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    matches_golden(without_pointer(printed.err), path.with_suffix(".out"))


@pytest.mark.parametrize("path", BAD, ids=name)
def test_other_commands_say_the_same(
    path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(path.parent)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    said = []
    for command in ("run", "tree", "explain", *(["check"] if path.stem not in CHECKED_AS_PROJECTS else [])):
        assert main([command, path.name]) == 2
        said.append(capsys.readouterr())
    assert said == [said[0]] * len(said)


def test_the_corpus_is_large() -> None:
    assert len(GOOD) + len(BAD) >= 58
