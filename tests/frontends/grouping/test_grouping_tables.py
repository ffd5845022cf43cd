"""Grouping alone: a line of raw tokens and, behind the arrow, what it is grouped to, in the files of `tables/`.

Raw tokens are `kind` or `kind:value`; the values are of counts (`count:3`), of a connective that means another
(`and:then`) and of what is defined (`define:name`, `define:condition`). What `group` makes is shown by kind, with the
value that it gave in brackets; `name = ...` is the unit of a definition. A problem is its code, the raw tokens that it
is about, what is said of them, and what is to be put where; behind all is where reading failed. Raw tokens are shown
by their numbers from 1: `2`, `2-4`, `<2` right before one, `2>` right behind one. In `places.txt` each grouped token
has those that it covers. UPDATE_GOLDEN=1 writes the files anew.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.mission.grouping.grouping import group
from btlang.frontends.mission.symbols.definitions import Header
from btlang.frontends.mission.token import Token
from btlang.text.source import Source, Span
from tests.conftest import matches_golden

TABLES = Path(__file__).parent / "tables"
ARROW = " -> "
_LINE_MARKS = ("newline", "indent", "dedent")
_CONDITION = "condition"  # the name of definitions that stand for conditions


def raw_tokens(line: str) -> tuple[Source, list[Token]]:
    """Each token is its own word in the text; those of line ends are empty, at the start of the next line."""
    text, tokens = "", []
    for word in line.split():
        kind, _, value = word.partition(":")
        if kind in _LINE_MARKS:
            text = text.rstrip() + "\n"
            tokens.append(Token(kind, None, len(text), len(text)))
        elif kind == "define":
            span = Span(Source(word), 0, len(word))
            tokens.append(Token(kind, Header(value, span, 0, 0), len(text), len(text) + len(word)))
        else:
            tokens.append(Token(kind, value or None, len(text), len(text) + len(word)))
        text += f"{word} " if kind not in _LINE_MARKS else ""
    return Source(text), tokens


def shown(line: str, places: bool) -> str:
    """What a line of raw tokens is grouped to."""
    source, raw = raw_tokens(line)

    def place(start: int, end: int) -> str:
        wide = [(number, token) for number, token in enumerate(raw, 1) if token.end > token.start]
        if start == end:
            behind = next((f"{number}>" for number, token in wide if token.end == start), "")
            return behind or next((f"<{number}" for number, token in wide if token.start == start), "end")
        first = next((number for number, token in wide if token.start == start), None)
        last = next((number for number, token in wide if token.end == end), None)
        return f"{first}" if first == last else f"{first}-{last}"

    def token_text(token: Token) -> str:
        value = value_text(token)
        if token.kind == "ELSE":
            value = f"({place(token.value, token.value)})" if places else ""
        return token.kind + value + (f"[{place(token.start, token.end)}]" if places else "")

    def problem_text(problem: Diagnostic) -> str:
        span, fix = problem.span, problem.fix
        cure = f" put {fix[1]!r} at {place(fix[0].start, fix[0].end)}" if fix else ""
        said = "".join(f" {name}={value!r}" for name, value in problem.arguments)
        return f"{problem.code} {place(span.start, span.end)}{said}{cure}"

    grouped = group(source, raw, {_CONDITION}, lambda role: role.upper())
    parts = []
    for unit in grouped.units:
        tokens = " ".join(map(token_text, unit.tokens))
        if unit.header is not None:
            parts.append(f"{unit.header.name} = {tokens or 'nothing'};")
        elif tokens:
            parts.append(tokens)
    if not grouped.problems:
        return " ".join(parts) or "nothing"
    failed = "".join(f" {at + 1}" for at in grouped.failed_at)
    return "; ".join(map(problem_text, grouped.problems)) + (f"; failed at{failed}" if failed else "")


def value_text(token: Token) -> str:
    """What grouping gave a token beside its kind."""
    value = token.value
    if isinstance(value, tuple):
        return f"({' '.join(str(part) for part in value if part is not None)})"
    return f"({value})" if isinstance(value, str) else ""


@pytest.mark.parametrize("path", sorted(TABLES.glob("*.txt")), ids=lambda path: path.stem)
def test_raw_tokens_are_grouped_as_the_table_says(path: Path) -> None:
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            raw = line.partition(ARROW)[0].rstrip()
            line = f"{raw}{ARROW}{shown(raw, path.stem == 'places')}"
        lines.append(line)
    matches_golden("\n".join(lines) + "\n", path)
