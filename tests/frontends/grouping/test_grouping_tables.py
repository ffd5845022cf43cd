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
from btlang.frontends.mission.token import Header, Token
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
            tokens.append(Token(kind, len(text), len(text)))
        elif kind == "define":
            span = Span(Source(word), 0, len(word))
            tokens.append(Token(kind, len(text), len(text) + len(word), Header(value, span, 0, 0)))
        else:
            is_role = kind in ("and", "or")
            made = Token(kind, len(text), len(text) + len(word), None if is_role else value or None)
            made.role = value if is_role else ""
            tokens.append(made)
        text += f"{word} " if kind not in _LINE_MARKS else ""
    return Source(text), tokens


def shown(line: str, places: bool) -> str:
    """What a line of raw tokens is grouped to."""
    source, raw = raw_tokens(line)

    def place(start: int, end: int) -> str:
        wide = [(number, token) for number, token in enumerate(raw, 1) if token.end > token.start]
        starts = {token.start: f"{number}" for number, token in wide}
        ends = {token.end: f"{number}" for number, token in wide}
        if start == end:
            return f"{ends[start]}>" if start in ends else f"<{starts[start]}" if start in starts else "end"
        first, last = starts.get(start) or f"{ends[start]}>", ends.get(end, "blank")
        return first if first == last else f"{first}-{last}"

    def token_text(token: Token) -> str:
        return token.kind + value_text(token) + (f"[{place(token.start, token.end)}]" if places else "")

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
    said = [word for word in (token.role, token.value) if word and isinstance(word, str)]
    return f"({' '.join(said)})" if said else ""


@pytest.mark.parametrize("path", sorted(TABLES.glob("*.txt")), ids=lambda path: path.stem)
def test_raw_tokens_are_grouped_as_the_table_says(path: Path) -> None:
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            raw = line.partition(ARROW)[0].rstrip()
            line = f"{raw}{ARROW}{shown(raw, path.stem == 'places')}"
        lines.append(line)
    matches_golden("\n".join(lines) + "\n", path)
