"""No text from outside does anything to a terminal but appear on it."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError, render
from btlang.text.formatting import CYAN, PLAIN, RED, YELLOW, TextTable, one_line, printable
from btlang.text.output import draw_lines
from btlang.text.source import Source
from btlang.tree.dump import Outline, describe_node
from btlang.tree.node import Node

CLEAR = "\x1b[2J\x1b]52;c;aGk=\x07"
PACKAGE = Path(btlang.__file__).parent
NO_SCREEN = {"interfaces.py"}
"""Programs of their own, which print nothing that comes from outside."""


def test_only_one_function_prints() -> None:
    found = set()
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if not re.search(r"\bprint\b", text):
            continue  # to parse all of the package takes seconds
        calls = [node.func for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
        if any(isinstance(call, ast.Name) and call.id == "print" for call in calls):
            found.add(path.name)
    assert found - NO_SCREEN == {"output.py"}


@pytest.mark.parametrize(
    "verb", [["run", "--speed", "max", "--lines"], ["tree"], ["tree", "--plain"], ["explain"], ["check"]]
)
@pytest.mark.parametrize("text", [f'say "{CLEAR}"', f'print "a{CLEAR}"', f'say "{CLEAR}" then fail', f'wave "{CLEAR}"'])
def test_missions(verb: list[str], text: str, capsys: pytest.CaptureFixture[str]) -> None:
    main([*verb, "-c", text])
    said = "".join(capsys.readouterr())
    assert "\x1b" not in said
    assert "\x07" not in said
    assert "\\x1b" in said or verb[0] == "check" or text.startswith("wave")


def test_a_line_cannot_be_forged(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "talk.py").write_text(
        "from btlang.engine.leaves.leaf import Failed\n"
        "def talk(robot):\n    robot.say('hi\\n   9.99  done   stop')\n"
        "    return Failed('no\\nThe mission succeeded')\n"
    )
    (tmp_path / "talk.toml").write_text('[[action]]\nphrase = "talk"\nid = "Talk"\ncall = "talk:talk"\n')
    main(["run", "-c", "talk", "--speed", "max", "--keywords", str(tmp_path / "talk.toml")])
    said = capsys.readouterr()
    assert not [line for line in said.out.splitlines() if line.lstrip().startswith("9.99")]
    assert "hi\\n   9.99" in said.out
    assert "The mission succeeded" not in said.err.splitlines()


@given(st.text())
def test_what_is_printable_stays_and_all_else_is_escaped(text: str) -> None:
    for shown in (one_line(text), printable(text)):
        bare = shown
        for colour in (RED, YELLOW, CYAN, PLAIN):
            bare = bare.replace(colour, "")
        assert not any(c < " " or "\x7f" <= c <= "\x9f" for c in bare if c not in "\n\t")
    if text.isprintable():
        assert one_line(text) == printable(text) == text
    assert len(one_line(text).splitlines()) <= 1


def test_own_colours_stay() -> None:
    assert printable(f"{RED}stop{PLAIN}\x1b[8m") == f"{RED}stop{PLAIN}\\x1b[8m"


@given(st.text(max_size=40), st.integers(30, 80))
def test_what_rich_draws_has_no_escape_sequences_of_texts(text: str, width: int) -> None:
    tree = Outline((("", Node("Sequence", (Node("Say"),))), (text or "x", Node("Say"))), lambda node: node.id + text)
    for drawing in (tree, TextTable(((text, "told"),))):
        for line in draw_lines(drawing, width, colour=False):
            assert re.sub("\x1b\\[[0-9;]*m", "", line).isprintable() or not text.isprintable()
            assert not set(re.sub("\x1b\\[[0-9;]*m", "", line)) & {"\x1b", "\x07", "\x9b", "\r"}


@pytest.mark.parametrize("depth", [5, 25, 300])
def test_nothing_of_a_tree_is_lost_where_it_is_deep(depth: int) -> None:
    tree = Node("Wave")
    for number in range(depth):
        tree = Node("Repeat", (tree,), (("num_cycles", str(number)),))
    outline = Outline((("", tree),), describe_node)
    drawn = "\n".join(draw_lines(outline, 60, colour=False))
    assert [f"num_cycles={number}" in drawn for number in range(depth)] == [True] * depth
    assert outline.height == str(outline).count("\n") + 1 == depth + 1


def test_a_table_as_text() -> None:
    table = TextTable((("a", "bc", "first"), ("long", "d", "second")), widths=(0, 4), gap=1, indent=2)
    assert str(table) == "  a    bc   first\n  long d    second"


def test_the_name_of_a_file() -> None:
    with pytest.raises(MissionError) as error:
        btlang.parse_tree(Source("frobnicate", f"{CLEAR}\n.txt"))
    assert "\x1b" not in render(error.value.diagnostics[0])
    assert "\\n.txt:1:1" in render(error.value.diagnostics[0])


def test_bad_options(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["run", CLEAR, "x", CLEAR])
    assert "\x1b" not in capsys.readouterr().err
