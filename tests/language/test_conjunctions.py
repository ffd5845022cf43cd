"""What `and` between commands means: each row of conjunctions.txt, by both parsers, in English, in XML and back."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

import btlang
from btlang.printer.mission import english
from tests.language.letters import shown

BRACKETS = ("needed", "clear", "all")
HERE = Path(__file__).parent
WORDS = [str(HERE / "conjunctions.toml")]


class Row(NamedTuple):
    """A sentence, the syntax that it has, and the codes of what is said about its `and`."""

    sentence: str
    syntax: str
    codes: list[str]


def rows() -> list[Row]:
    """Two lines a row, with comments and empty lines between them; `\\n` is a line end."""
    text = (HERE / "conjunctions.txt").read_text(encoding="utf-8").splitlines()
    lines = [line for line in text if line and not line.startswith("#")]
    pairs = zip(lines[::2], lines[1::2], strict=True)
    return [Row(said.replace("\\n", "\n"), *_expected(syntax)) for said, syntax in pairs]


def _expected(line: str) -> tuple[str, list[str]]:
    syntax, _, codes = line.strip().partition("  # ")
    return syntax, codes.split()


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.sentence)
def test_and(row: Row) -> None:
    missions = [btlang.parse_tree(row.sentence, parser=each, keywords=WORDS) for each in ("shunting-yard", "lark")]
    for mission in missions:
        assert shown(mission.syntax) == row.syntax
        assert [each.code for each in mission.warnings if each.code in ("BT050", "BT174")] == row.codes
    mission = missions[0]
    assert mission.syntax is not None
    printed = [english(mission.syntax, mission.vocabulary, brackets=each) for each in BRACKETS]
    for text in (*printed, mission.to("xml"), mission.to("english"), mission.to("json")):
        assert btlang.parse_tree(str(text), keywords=WORDS).tree == mission.tree, text


@btlang.action("wave", id="Wave", replace=True)
def wave() -> None:
    """Waves in another way."""


@btlang.action("sing", accompaniment=True)
def sing() -> None:
    """Sings."""


@btlang.action("polish")
def polish() -> None:
    """Polishes."""


def test_what_replaces_a_word_goes_along_as_that_did() -> None:
    for text, operator in [("wave and sing", "Parallel"), ("polish and sing", "Sequence")]:
        assert btlang.parse_tree(text, keywords=[wave, sing, polish]).tree.root.id == operator


def test_a_pack_may_give_every_and_another_meaning(tmp_path: Path) -> None:
    """Printed English then says `at the same time`, since no word that is left means it."""
    pack = tmp_path / "pack.toml"
    pack.write_text('[meanings]\nand = "then"\n"and also" = "then"\n')
    mission = btlang.parse_tree("wave and nod at the same time", keywords=[str(pack)])
    assert mission.tree.root.id == "Parallel"
    assert btlang.parse_tree(str(mission.to("english")), keywords=[str(pack)]).tree == mission.tree
