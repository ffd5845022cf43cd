"""Whatever the input is: a coded error with a place, or a tree; never anything else, and never for long."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

import btlang
from btlang.api import parse_tree
from btlang.cli import main
from btlang.engine.status import RUNNING, SUCCESS
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from tests.profiles import amount, searches
from tests.trial import Trial

BOTH = pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
VOCABULARY = world_vocabulary()


def codes(text: str, parser: str = "shunting-yard") -> list[str]:
    """The codes of what is wrong; every message can be written out and points into the text."""
    try:
        compile_mission(read_mission(Source(text), VOCABULARY, parser).mission, VOCABULARY)
    except btlang.MissionError as error:
        found = error
    else:
        return []
    assert str(found)
    assert all(0 <= d.span.start <= d.span.end <= len(text) for d in found.diagnostics)
    return [problem.code for problem in found.diagnostics]


@searches(50, 4000)
@given(st.binary(max_size=300))
def test_any_bytes(data: bytes) -> None:
    text = data.decode("utf-8", "replace")
    assert codes(text) == codes(text, "lark")


WORDS = sorted({word for entries in VOCABULARY.entries.values() for e in entries for word in e.example.split()})
PIECES = [*WORDS, "then", "and", "or", "after", "if", "unless", "until", "while", "repeat", "try", "otherwise", "not"]
PIECES += [",", ".", ";", ":", "(", ")", '"', "\n", "\n  ", "\n    ", "is", "means", "patrol", "a", "the", "please"]
LARGE = amount(60_000, 1_000_000)  # characters
MANY = amount(500, 10_000)  # messages, each of which looks for its sentence
PIECES += ["3 times", "for 5 s", "within 2 min", "every 5 s", "5", "m", "%", "-", "twice", "wait", "# x"]


@searches(100, 15000)
@given(st.lists(st.sampled_from(PIECES), max_size=25).map(" ".join))
def test_any_words(text: str) -> None:
    assert codes(text) == codes(text, "lark")


@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "BT005"),
        (" \n\t\n# nothing", "BT005"),
        ("x" * LARGE, "BT010"),
        ("foo bar " * (LARGE // 8), "BT010"),
        ("wave, " * (LARGE // 6), "BT032"),
        ("(" * (LARGE // 5), "BT023"),
        (")" * LARGE, "BT024"),
        ("," * LARGE, "BT032"),
        ('say "' + "x" * LARGE, "BT004"),
        ("5 " * (LARGE // 2), "BT019"),
        ("5, " * MANY, "BT019"),
        ("x then " * MANY, "BT010"),
        ("".join(f"x{number} then " for number in range(1000)), "BT010"),
        ("\x00\x01\x02" * 1000, "BT003"),
        ("n0 is wave\n" + "".join(f"n{i} is n{i - 1} then n{i - 1}\n" for i in range(1, 100)) + "n99", "BT042"),
    ],
    ids=[
        *("empty", "blank", "junk", "words", "commas", "open"),
        *("close", "only-commas", "quote", "numbers", "lists", "same", "other", "zeros", "growth"),
    ],
)
def test_hostile_texts(text: str, code: str) -> None:
    assert code in codes(text)


@pytest.mark.long
@BOTH
def test_a_mission_of_many_lines(parser: str) -> None:
    odd, even = "if wall in front, turn left otherwise wave", 'go to the lab then wave and say "hi", then wait 2 s'
    pairs = amount(300, 5000)
    tree = parse_tree("\n".join([odd, even] * pairs), parser=parser).tree
    assert len(tree.root.children) == pairs * 4  # the lines' sequences are one with the mission's


@pytest.mark.long
@BOTH
def test_thousands_of_definitions_that_use_each_other(parser: str) -> None:
    count = amount(2_000, 10_000)
    text = "n0 is wave\n" + "".join(f"n{i} is n{i - 1} then nod\n" for i in range(1, count)) + f"n{count - 1}"
    assert len(parse_tree(text, parser=parser).tree.subtrees) == count


@BOTH
@pytest.mark.parametrize(
    "text",
    [
        "(" * 1000 + "print x" + ")" * 1000,
        "(print x and " * 1000 + "print y" + ")" * 1000,
        "".join("  " * i + "unless bumped:\n" for i in range(1000)) + "  " * 1000 + "print x",
        "unless bumped, " * 1000 + "print x",
        "check " + "not " * 1000 + "battery is full",
        "try " * 1000 + "print x",
        "print x" + " twice" * 12 + " if possible" * 1000,
        "unless bumped, " * 1000 + "go to the lab. If Alice isn't there, print x",
    ],
    ids=["brackets", "nested", "blocks", "forms", "nots", "tries", "postfixes", "journeys"],
)
def test_nesting_1000_deep(text: str, parser: str) -> None:
    tree = parse_tree(text, parser=parser)
    assert str(tree)
    outcome = tree.run(speed="max", time_limit=0.2)
    assert outcome.status == SUCCESS or outcome.stopped


def test_a_deep_tree_ticks_and_halts() -> None:
    tree = Trial("(print x and " * 1000 + "wait 5 s" + ")" * 1000)
    assert tree.tick() == RUNNING
    tree.halt()


@pytest.mark.parametrize("data", [b"\xff\xfe\x00w", b"wave\x80", bytes(range(256))])
def test_files_that_are_no_text(data: bytes, tmp_path, capsys: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def]
    file = tmp_path / "mission.txt"
    file.write_bytes(data)
    assert main(["check", str(file)]) == 2
    assert "BT002" in capsys.readouterr().err
    assert main(["check", str(tmp_path)]) == 2
    assert "BT001" in capsys.readouterr().err
