"""A text that is edited reads as if nothing was kept of those before it: messages, tree, places and what is printed."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.formats import to_data
from btlang.frontends.mission.tokens import lexer
from btlang.frontends.mission.tokens.line_memo import LineMemo, LineReader
from btlang.printer.mission import mission_lines, printer_of
from btlang.text.source import Source
from btlang.tree.ast import parents_first
from tests.benchmarks.missions import mission
from tests.profiles import amount

ROOT = Path(__file__).parents[2]
SPECIAL = (
    "wave at her", "put it on the table", "go there", "bring it to him", "wave at them", "it", "# a comment", "",
    "tour is go to the lab then wave", "tour", "patrol means:\n    go to the lab\n    nod", "patrol",
    "whenever the battery is low, dock", "whenever someone is near, greet them", 'say "hello', "(go to the lab", "nod)",
    "if that fails, wave", "otherwise nod", "then nod", "If so, wave", 'ask Bob "Tea?"', "if he says yes, go to him",
    "the rest of the time nod", "go to the lab, the office and the hall", "pick up the cup", "put it down",
    "look for Alice in the lab, the hall", "set limit to 3", "increase limit by 2", "if {limit} is above 3, wave",
    "if limit is above 3, wave", "for each person: wave at them", "wave at him unless he is near", "do that again",
    "do the same", "go to the kitchen or the lab", "wave at someone", "if nobody is in the lab or the hall, go there",
    "greet {who} is go to {who} then wave at {who}", "greet Bob", "at 9 o'clock, wave", "at 5 pm and at 6, nod",
)  # fmt: skip
TYPED = 'abeinstx .,"(:\n{}3'


def pool() -> list[str]:
    """Statements as people write them: samples of the language, examples, and those that say something of others."""
    files = [*(ROOT / "tests/samples/good").rglob("*.txt"), *(ROOT / "examples").rglob("*.txt")]
    texts = [file.read_text(encoding="utf-8").rstrip("\n") for file in sorted(files)]
    return [text for text in texts if 0 < text.count("\n") < 12] + PLAIN + [*SPECIAL] * 3


PLAIN = [line for line in mission(200).split("\n") if line[:1].strip() and line[-1] != ":"]
POOL = pool()


def edited(text: str, draw: random.Random) -> str:
    """The text with one change, as somebody types, pastes, deletes, moves or joins lines."""
    kind, lines = draw.random(), text.split("\n")
    at, line = draw.randrange(len(text) + 1), draw.randrange(len(lines))
    if kind < 0.3:
        return text[:at] + draw.choice(TYPED) + text[at:]
    if kind < 0.45:
        return text[:at] + text[at + draw.choice((1, 1, 1, 2, 5)) :]
    if kind < 0.65:
        lines.insert(line, draw.choice(POOL))
    elif kind < 0.75:
        del lines[line]
    elif kind < 0.8:
        lines[line] += draw.choice((". ", ",", "; ", " then ", " and ")) + draw.choice(POOL)
    elif kind < 0.84:
        lines[line : line + 2] = [" ".join(lines[line : line + 2])]
    elif kind < 0.9:
        lines[line] = lines[line].lstrip() if draw.random() < 0.5 else "    " + lines[line]
    elif kind < 0.95:
        lines.insert(draw.randrange(len(lines)), lines[line])
    else:
        words = lines[line].split(" ")
        words[draw.randrange(len(words))] = draw.choice(draw.choice(POOL).split() or ["x"])
        lines[line] = " ".join(words)
    return "\n".join(lines)


def session(draw: random.Random, edits: int) -> Iterator[str]:
    """The texts of somebody who writes, and takes changes back now and then."""
    text = "\n".join([*draw.choices(PLAIN, k=draw.choice((8, 12, amount(16, 40)))), *draw.choices(POOL, k=2)])
    before: list[str] = []
    for _ in range(edits):
        yield text
        before.append(text)
        text = draw.choice(before) if draw.random() < 0.1 else edited(text, draw)


def places(program: Any) -> list[object]:
    """Each node of a syntax tree with its characters."""
    parts = [*program.definitions, *program.facts, program.body]
    nodes = [node for part in parts if part is not None for node in parents_first(part)]
    return [(type(node).__name__, node.span.start, node.span.end) for node in nodes]


def all_of(text: str, parser: str, memo: LineMemo | None) -> object:
    """All that is read of a text, as data."""

    def read() -> object:
        source = Source(text, "mission", roots=())
        try:
            made = parse_tree(source, parser=parser)
        except MissionError as error:
            return [to_data(each) for each in error.diagnostics]
        assert made.syntax is not None
        printed = [*mission_lines(made.syntax, printer_of(made.syntax, made.vocabulary))]
        return [to_data(each) for each in made.warnings], made.tree, made.syntax, places(made.syntax), printed

    if memo is None:
        return read()
    with memo.used():
        return read()


@pytest.mark.long
@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize("seed", range(amount(2, 100)))
def test_an_edited_text_is_read_as_a_new_one(seed: int, parser: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lexer, "FEWEST_LINES", 1)
    replayed = 0

    def replay(self: LineReader, *given: Any) -> None:
        nonlocal replayed
        replayed += 1
        original(self, *given)

    original = LineReader._replay
    monkeypatch.setattr(LineReader, "_replay", replay)
    memo, lines = LineMemo(), 0
    for text in session(random.Random(f"{seed} {parser}"), amount(8, 50)):
        assert all_of(text, parser, memo) == all_of(text, parser, None), text
        lines += text.count("\n")
    assert replayed > lines / 50  # else this test would prove nothing
