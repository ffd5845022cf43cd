"""What BehaviorTree.CPP takes no notice of: such files are read, with warnings, and written again with all of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.cli import main
from btlang.diagnostics.diagnostic import render
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.file import XmlFile
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.btcpp.scan import scanned
from tests.conftest import matches_golden
from tests.corpus.same import content, written

LENIENT = sorted((Path(__file__).parent / "lenient").glob("*.xml"))
MODELS = [path for path in LENIENT if path.stem.startswith("only_models")]
QUIET = {*MODELS, *(path for path in LENIENT if path.stem == "unknown_attributes_in_models")}
TREES = [path for path in LENIENT if path not in MODELS]


def name(path: Path) -> str:
    return path.stem


@pytest.mark.parametrize("path", LENIENT, ids=name)
def test_warnings(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)
    file = XmlFile(scanned(read_source(path.name)))
    assert file.problems == []
    assert {warning.code for warning in file.warnings} == (set() if path in QUIET else {"BT230"})
    matches_golden("".join(f"{render(warning)}\n\n" for warning in file.warnings), path.with_suffix(".out"))


@pytest.mark.parametrize("path", TREES, ids=name)
def test_nothing_is_lost(path: Path) -> None:
    source = read_source(str(path))
    tree = read_xml(source)
    assert len(tree.warnings) == len(XmlFile(scanned(source)).warnings)
    text = written(tree)
    assert content(text) == content(source.text)
    assert read_xml(source.with_text(text)) == tree


@pytest.mark.parametrize("path", MODELS, ids=name)
def test_models_alone_cannot_run(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(path)]) == 2
    assert "<root> contains no BehaviorTree" in capsys.readouterr().err


def test_two_parts_with_models_are_refused() -> None:
    """As BehaviorTree.CPP does."""
    path = Path(__file__).parent / "bad" / "two_parts_with_models.xml"
    assert [problem.code for problem in XmlFile(scanned(read_source(str(path)))).problems] == ["BT122"]


def test_places_behind_missing_blanks_are_right() -> None:
    path = Path(__file__).parent / "lenient" / "no_blank_between_attributes.xml"
    tree = read_xml(read_source(str(path)))
    spans = [node.span.text for node in tree.walk() if node.span is not None]
    assert all(text[:1] + text[-1:] == "<>" and text.count("<") == 1 for text in spans)
