"""Keyword files and Python words written for version 0.1 run unchanged: the page of then, with its files and output."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from btlang.backends.engine import import_call
from btlang.vocabulary.load import load_vocabulary
from tests.conftest import without_overruns
from tests.test_readme import Block, blocks_of, btc, command_and_output, first_line

PAGE = Path(__file__).parent / "version_0_1" / "keywords.md"
BLOCKS = blocks_of(PAGE)


@pytest.mark.parametrize("block", [block for block in BLOCKS if block.language == "console"], ids=first_line)
def test_shown_output_is_real(block: Block, tmp_path: Path) -> None:
    for file in BLOCKS:
        if file.file:
            (tmp_path / file.file).write_text(file.text)
    line, shown = command_and_output(block)
    printed = btc(line, tmp_path).stdout
    if "--speed max" in line:
        assert printed == shown
    else:  # in real time, which a busy machine prolongs
        assert re.sub(r"\d+\.\d+", "?", without_overruns(printed)) == re.sub(r"\d+\.\d+", "?", shown)


@pytest.mark.parametrize(
    ("call", "function"),
    [
        ("btlang.actions.commands:do_what_somebody_says", "do_what_somebody_says"),
        ("btlang.actions.show:bow", "bow"),
        ("btlang.actions.show:dance", "dance"),
        ("btlang.actions.sides:go_to_side", "go_to_side"),
    ],
)
def test_functions_that_have_moved_are_found(call: str, function: str, tmp_path: Path) -> None:
    pack = tmp_path / "old.toml"
    pack.write_text(
        f'[[action]]\nphrase = "perform it"\nid = "Performed"\ncall = "{call}"\nhelp = "."\nexample = "perform it"\n'
    )
    entry = load_vocabulary([str(pack)]).entries["Performed"][0]
    assert import_call(entry).__name__ == function
