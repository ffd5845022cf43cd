"""Constraints that hold over the whole mission: `never enter the hall`, and `avoid the hall` behind all journeys.

Each is a statement of its own at the top of the mission, or several of them are joined there. Any other constraint that
stands alone holds from there on.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set

from btlang.frontends.mission.token import Called, Listed, Token, only_constrains
from btlang.text.source import Source
from btlang.tree.ast import Ast, Chain
from btlang.vocabulary.capabilities import MOVES

_OPENS = frozenset(("OPEN", "COND_OPEN", "COND_OF", "FORM", "AFTER_FORM", "LOOP", "IF_WORKS", "TEST"))
_CLOSES = frozenset(("CLOSE", "COND_CLOSE", "END"))


def whole_rules(tokens: Sequence[Token], source: Source, words: Set[str]) -> frozenset[int]:
    """The characters at which such statements start among grouped tokens; `words` are those such as `never`."""
    statements = list(_statements(tokens))
    found, start = [], 0
    for number, statement in enumerate(statements):
        if not statement:
            continue
        first, last = statement[0], statement[-1]
        if only_constrains(statement):
            said = source.text[start : first.end].lower().split()
            before, behind = statements[:number], statements[number + 1 :]
            if not words.isdisjoint(said) or (any(map(_has_journey, before)) and not any(map(_has_journey, behind))):
                found.append(first.start)
        start = last.end
    return frozenset(found)


def with_rules_first(body: Ast | None, starts: Set[int]) -> Ast | None:
    """The body of a mission with the statements that start there in front."""
    if not starts or not isinstance(body, Chain) or body.operator != "sequence":
        return body
    rules = tuple(item for item in body.items if item.span.start in starts)
    moved: Chain = body.replace(items=(*rules, *(item for item in body.items if item.span.start not in starts)))
    return moved


def _statements(tokens: Sequence[Token]) -> Iterator[list[Token]]:
    """The tokens of each statement that stands in no bracket and no form."""
    depth = 0
    statement: list[Token] = []
    for token in tokens:
        depth += (token.kind in _OPENS) - (token.kind in _CLOSES)
        if token.kind == "SEMI" and not depth:
            yield statement
            statement = []
        else:
            statement.append(token)
    yield statement


def _has_journey(statement: Sequence[Token]) -> bool:
    """Whether a statement may move the robot."""
    return any(
        isinstance(token.value, Called | Listed)
        and (token.value.entry.sort == "name" or MOVES in token.value.entry.resources)
        and not token.value.entry.constrains
        for token in statement
        if token.kind == "COMMAND"
    )
