"""What is said behind rounds without an end, where it would never be done.

- `every 10 min, count the cups. If there are 3, A` asks in each round;
- `A every 10 min. Stop at 5 pm` and `A every 10 min. Stop when C` end the rounds;
- `count the cups every 10 min until 5 pm. As soon as there are 3, A` ends them, too, and does A.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.answers import asks
from btlang.tree.sums import COMPARED, COUNTING
from btlang.tree.visit import fold

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_SENTENCE_END = re.compile(r"[.!\n]")
_STOP, _WAITS = "Stop", ("WaitForPerson", "WaitForSomeone")


def with_ends(mission: ast.Program) -> ast.Program:
    """Return the mission with what belongs to rounds without an end where it is done."""

    def body(root: ast.Ast) -> ast.Ast:
        return fold(root, ast.parts, _join) if any(map(_has_rounds_before, ast.parents_first(root))) else root

    def program(part: ast.Program) -> ast.Program:
        return ast.with_bodies(part, body, program)

    return program(mission)


def _join(node: ast.Ast, done: Sequence[ast.Ast]) -> ast.Ast:
    """Return a node with its parts, a sequence with what belongs to endless rounds of it in these."""
    whole = ast.with_parts(node, done)
    if not isinstance(whole, ast.Chain) or not _has_rounds_before(whole):
        return whole
    made: list[ast.Ast] = []
    items = list(whole.items)
    while items:
        item = items.pop(0)
        if made and _is_awaited(made[-1], item):
            pairs = enumerate(pairwise((item, *items)))
            last = next((at for at, (one, other) in pairs if _SENTENCE_END.search(_between(one, other))), len(items))
            made[-1:] = _until_counted(made[-1], item, items[:last])
            del items[:last]
            continue
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
        counts = asks(item.condition, (COMPARED,)) and asks(rounds, COUNTING)
        if _is_stop(stop) and item.otherwise is None and counts:
            return at, [_counted_again(rounds, item.condition, span), *behind]
        if _is_stop(stop) and item.otherwise is None:
            return at, [ast.StopWhen(item.condition, rounds, span), *behind]
        if counts:
            return at, [_with_last(rounds, item, span)]
    return len(before), [item]


def _is_awaited(rounds: ast.Ast, item: ast.Ast) -> bool:
    """Whether a command waits for what the rounds before it count."""
    is_asked = isinstance(item, ast.WaitUntil) and asks(item.condition, (COMPARED,))
    return is_asked and _goes_round(rounds) and asks(rounds, COUNTING)


def _until_counted(rounds: Any, wait: Any, behind: Sequence[ast.Ast]) -> list[ast.Ast]:
    """Return rounds that end when so many are counted, and what is done then."""
    counted = _counted_again(rounds, wait.condition, Span(wait.span.source, rounds.span.start, wait.span.end))
    if _is_endless(rounds) or not behind:
        return [counted, *behind]
    span = Span(wait.span.source, wait.span.start, behind[-1].span.end)
    body = behind[0] if len(behind) == 1 else ast.Chain("sequence", tuple(behind), False, span)
    return [counted, ast.If(False, wait.condition, body, None, span)]


def _counted_again(rounds: Any, condition: ast.Ast, span: Span) -> ast.Ast:
    """Return rounds that count until a condition about that holds: it isn't known before the first count."""
    if isinstance(rounds, ast.For):
        return ast.UpTo(rounds.seconds, _counted_again(rounds.body, condition, span), span)
    if isinstance(rounds, ast.UntilTime):
        return ast.UntilTime(rounds.time, _counted_again(rounds.body, condition, span), span)
    pause = rounds.seconds if isinstance(rounds, ast.Every) else ""
    items = (rounds.body, ast.Check(condition, condition.span))
    return ast.Retry("-1", ast.Chain("sequence", items, True, span), pause, span)


def is_wait(node: ast.Ast) -> bool:
    """Return whether a command only waits for something: until a time of day it does so once."""
    if isinstance(node, ast.Retry) and node.attempts == "-1" and isinstance(node.body, ast.Chain):
        return isinstance(node.body.items[-1], ast.Check)
    return isinstance(node, ast.WaitUntil) or (isinstance(node, ast.Phrase) and node.entry.id in _WAITS)


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


def _has_rounds_before(node: ast.Ast) -> bool:
    """Whether something stands behind rounds."""
    return isinstance(node, ast.Chain) and node.operator == "sequence" and any(map(_goes_round, node.items[:-1]))


def _goes_round(node: ast.Ast) -> bool:
    """Whether a command is done in rounds, which may end at a time."""
    is_timed = isinstance(node, ast.UntilTime | ast.For) and isinstance(node.body, ast.Every)
    return is_timed or _is_endless(node)


def _is_endless(node: ast.Ast) -> bool:
    """Whether a command is done in rounds without an end."""
    return not node.rounds if isinstance(node, ast.Every) else isinstance(node, ast.Repeat) and node.rounds == "-1"


def _is_stop(node: ast.Ast | None) -> bool:
    return isinstance(node, ast.Phrase) and node.entry.id == _STOP


def _between(left: ast.Ast, right: ast.Ast) -> str:
    return left.span.source.text[left.span.end : right.span.start]
