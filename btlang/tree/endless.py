"""What is said behind rounds without an end, where it would never be done.

- `every 10 min, count the cups. If there are 3, A` asks in each round;
- `A every 10 min. Stop at 5 pm` and `A every 10 min. Stop when C` end the rounds.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.answers import asks
from btlang.tree.sums import COMPARED, COUNTING
from btlang.tree.visit import fold

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_STOP = "Stop"


def with_ends(mission: ast.Program) -> ast.Program:
    """Return the mission with what belongs to rounds without an end where it is done."""

    def body(root: ast.Ast) -> ast.Ast:
        return fold(root, ast.parts, _join) if any(map(_never_ends_before, ast.parents_first(root))) else root

    def program(part: ast.Program) -> ast.Program:
        return ast.with_bodies(part, body, program)

    return program(mission)


def _join(node: ast.Ast, done: Sequence[ast.Ast]) -> ast.Ast:
    """Return a node with its parts, a sequence with what belongs to endless rounds of it in these."""
    whole = ast.with_parts(node, done)
    if not isinstance(whole, ast.Chain) or not _never_ends_before(whole):
        return whole
    made: list[ast.Ast] = []
    for item in whole.items:
        at, joined = _join_pair(made, item)
        made[at:] = joined
    return made[0] if len(made) == 1 else whole.replace(items=tuple(made))


def _join_pair(before: Sequence[ast.Ast], item: ast.Ast) -> tuple[int, list[ast.Ast]]:
    """Return what rounds and a command behind them make, or the command alone, and from which place on that stands."""
    at = len(before) - (2 if before and isinstance(before[-1], ast.WaitTime) else 1)
    rounds = before[at] if at >= 0 else None
    if rounds is None or not _is_endless(rounds) or "\n" in _between(rounds, item):
        return len(before), [item]
    span = Span(item.span.source, rounds.span.start, item.span.end)
    timed, stop, behind = (before[-1], *_split(item)) if at < len(before) - 1 else _split_timed(item)
    if isinstance(timed, ast.WaitTime) and isinstance(rounds, ast.Every) and _is_stop(stop):
        return at, [ast.UntilTime(timed.time, rounds, span), *behind]
    if isinstance(item, ast.If) and not item.negated and timed is None:
        stop, behind = _split(item.body)
        if _is_stop(stop) and item.otherwise is None:
            return at, [ast.StopWhen(item.condition, rounds, span), *behind]
        if asks(item.condition, (COMPARED,)) and asks(rounds, COUNTING):
            return at, [_with_last(rounds, item, span)]
    return len(before), [item]


def _split_timed(node: ast.Ast) -> tuple[ast.Ast | None, ast.Ast | None, list[ast.Ast]]:
    """Split `stop at 5 pm and A` into the wait for the time, its command and the others; of others there is none."""
    timed, behind = _split(node)
    if not isinstance(timed, ast.WaitTime) or not behind:
        return None, None, []
    return timed, *_split(behind[0])


def _split(node: ast.Ast) -> tuple[ast.Ast, list[ast.Ast]]:
    """Split a command into its first one and those behind that."""
    if not isinstance(node, ast.Chain) or node.operator not in ("sequence", "and"):
        return node, []
    first, behind = _split(node.items[0])
    items = (*behind, *node.items[1:])
    return first, [items[0] if len(items) == 1 else node.replace(items=items)]


def _with_last(rounds: Any, item: ast.Ast, span: Span) -> ast.Ast:
    """Return rounds with one more command at their end, within the hours at which they are done."""
    part = ast.parts(rounds)[-1] if isinstance(rounds, ast.If) else ast.parts(rounds)[0]
    if isinstance(part, ast.If) and part.otherwise is None:
        inner = _with_last(part, item, Span(span.source, part.span.start, span.end))
    else:
        items = part.items if isinstance(part, ast.Chain) and part.operator == "sequence" else (part,)
        inner = ast.Chain("sequence", (*items, item), True, Span(span.source, part.span.start, span.end))
    parts = [inner if each is part else each for each in ast.parts(rounds)]
    made: ast.Ast = ast.with_parts(rounds, parts).replace(span=span)
    return made


def _never_ends_before(node: ast.Ast) -> bool:
    """Whether something stands behind rounds without an end."""
    return isinstance(node, ast.Chain) and node.operator == "sequence" and any(map(_is_endless, node.items[:-1]))


def _is_endless(node: ast.Ast) -> bool:
    """Whether a command is done in rounds without an end."""
    return not node.rounds if isinstance(node, ast.Every) else isinstance(node, ast.Repeat) and node.rounds == "-1"


def _is_stop(node: ast.Ast | None) -> bool:
    return isinstance(node, ast.Phrase) and node.entry.id == _STOP


def _between(left: ast.Ast, right: ast.Ast) -> str:
    return left.span.source.text[left.span.end : right.span.start]
