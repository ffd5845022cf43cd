"""Constraints that a condition ends: `avoid the hall until Bob arrives`, `stay in the kitchen until Bob arrives`.

A zone is closed until then, whatever comes behind: the first time that the condition holds, it is opened. Who stays
somewhere waits there until then.
"""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Called, Listed, Token, begins_condition, constraint_of
from btlang.frontends.mission.tokens.silent_words import LINES
from btlang.text.source import Span
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon

_EXAMPLE = "it is after 6 pm"
_OPEN = "OpenZone"
_ENDS = frozenset(("newline", "semi", "stop", "dedent", "close"))
_JOINTS = frozenset(("comma", "and", "then"))
_IN_CONDITIONS = frozenset(("condition", "not", "open", "either", "neither", "both"))
_AMOUNTS = frozenset(("for", "until_time", "up_to"))


def with_ends(tokens: list[Token], vocabulary: Lexicon, span: Callable[[int, int], Span]) -> list[Diagnostic]:
    """Makes two statements of each constraint to keep out that a condition ends: the second opens its zones again.

    Returns what is wrong with constraints that a time ends (BT161); `span` gives the place of some characters.
    """
    opening = vocabulary.entry(_OPEN)
    problems: list[Diagnostic] = []
    at = 0
    while at + 1 < len(tokens):
        until = tokens[at + 1]
        constraint = constraint_of(tokens[at]) if until.kind == "until" or until.kind in _AMOUNTS else None
        if constraint is not None and until.kind in _AMOUNTS:
            forbidden, whole = span(tokens[at].start, tokens[at].end).text, span(tokens[at].start, until.end)
            problems.append(
                diagnostic(
                    "BT161", whole, words=whole.text, example=f"{forbidden} {vocabulary.word('until')} {_EXAMPLE}"
                )
            )
        begins = at == 0 or tokens[at - 1].kind in LINES
        if constraint is not None and begins and until.kind == "until" and begins_condition(tokens, at + 2):
            if constraint.kind == "keep in":
                tokens[at + 1 : at + 2] = [
                    Token("and", until.start, until.end), Token("wait_until", until.start, until.end)
                ]  # fmt: skip
            elif opening is not None:
                _open_again(tokens, at, opening)
        at += 1
    return problems


def _open_again(tokens: list[Token], at: int, opening: Entry) -> None:
    until, said = tokens[at + 1], tokens[at].value
    assert isinstance(said, Called | Listed)
    lists = [said.arguments] if isinstance(said, Called) else said.arguments
    values = tuple(((opening.slots[0].name, text),) for arguments in lists for _, text in arguments)
    command = Called(opening, values[0]) if len(values) == 1 else Listed(opening, values, "and")
    last = at + 2
    while last < len(tokens) and tokens[last].kind not in _ENDS:
        behind = last
        while behind < len(tokens) and tokens[behind].kind in _JOINTS:
            behind += 1
        if behind > last and tokens[behind : behind + 1] and tokens[behind].kind not in _IN_CONDITIONS:
            tokens[last:behind] = [Token("semi", tokens[last].start, tokens[last].end)]
            break  # `avoid the hall until bumped, then wave`
        last = max(behind, last + 1)
    end = tokens[last - 1].end
    tokens[last:last] = [Token("comma", end, end), Token("command", end, end, command)]
    tokens[at + 1 : at + 2] = [Token("semi", until.start, until.start), Token("first_time", until.start, until.end)]
