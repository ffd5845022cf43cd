"""Constraints that a condition ends: `avoid the hall until Bob arrives`, `stay in the kitchen until Bob arrives`.

A zone is closed until then, whatever comes behind: the first time that the condition holds, it is opened. Who stays
somewhere waits there until then, or so long.
"""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    JOINTS,
    LINES,
    WAITING,
    Called,
    Listed,
    Token,
    begins_condition,
    constraint_of,
)
from btlang.text.source import Span
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon

_EXAMPLE = "it is after 6 pm"
_OPEN = "OpenZone"
_ENDS = frozenset(("newline", "semi", "stop", "dedent", "close"))
_IN_CONDITIONS = frozenset(("condition", "not", "open", "either", "neither", "both"))
"""What who stays somewhere does there meanwhile."""
_ENDING = frozenset((*WAITING, "up_to"))


def with_ends(tokens: list[Token], vocabulary: Lexicon, span: Callable[[int, int], Span]) -> list[Diagnostic]:
    """Makes two statements of each constraint to keep out that a condition ends: the second opens its zones again.

    Returns what is wrong with constraints that a time ends (BT161); `span` gives the place of some characters.
    """
    opening = vocabulary.entry(_OPEN)
    problems: list[Diagnostic] = []
    at = 0
    while at + 1 < len(tokens):
        until = tokens[at + 1]
        begins = at == 0 or tokens[at - 1].kind in LINES
        constraint = constraint_of(tokens[at]) if begins and until.kind in _ENDING else None
        if constraint is not None and constraint.kind == "keep in" and until.kind in WAITING:
            _wait(tokens, at)
        elif constraint is not None and until.kind != "until":
            forbidden, whole = span(tokens[at].start, tokens[at].end).text, span(tokens[at].start, until.end)
            example = f"{forbidden} {vocabulary.word('until')} {_EXAMPLE}"
            problems.append(diagnostic("BT161", whole, words=whole.text, example=example))
        elif constraint is not None and opening is not None and begins_condition(tokens, at + 2):
            _open_again(tokens, at, opening)
        at += 1
    return problems


def _wait(tokens: list[Token], at: int) -> None:
    """Puts `stay in the hall until C` into brackets: what comes behind isn't confined."""
    until, start = tokens[at + 1], tokens[at].start
    last, _ = _condition_end(tokens, at + 2) if until.kind == "until" else (at + 2, at + 2)
    end = tokens[last - 1].end
    tokens[last:last] = [Token("close", end, end)]
    waiting = Token(WAITING[until.kind], until.start, until.end, until.value)
    tokens[at : at + 2] = [Token("open", start, start), tokens[at], Token("and", until.start, until.start), waiting]


def _condition_end(tokens: list[Token], at: int) -> tuple[int, int]:
    """Where a condition ends, and where the command begins that may stand behind it, after words that join them."""
    while at < len(tokens) and tokens[at].kind not in _ENDS:
        behind = at
        while behind < len(tokens) and tokens[behind].kind in JOINTS:
            behind += 1
        if behind > at and tokens[behind : behind + 1] and tokens[behind].kind not in _IN_CONDITIONS:
            return at, behind
        at = max(behind, at + 1)
    return at, at


def _open_again(tokens: list[Token], at: int, opening: Entry) -> None:
    until, said = tokens[at + 1], tokens[at].value
    assert isinstance(said, Called | Listed)
    lists = [said.arguments] if isinstance(said, Called) else said.arguments
    values = tuple(((opening.slots[0].name, text),) for arguments in lists for _, text in arguments)
    command = Called(opening, values[0]) if len(values) == 1 else Listed(opening, values, "and")
    last, behind = _condition_end(tokens, at + 2)
    if behind > last:  # `avoid the hall until bumped, then wave`
        tokens[last:behind] = [Token("semi", tokens[last].start, tokens[last].end)]
    end = tokens[last - 1].end
    tokens[last:last] = [Token("comma", end, end), Token("command", end, end, command)]
    tokens[at + 1 : at + 2] = [Token("semi", until.start, until.start), Token("first_time", until.start, until.end)]
