"""Forms that can be read in another way: sentences side by side, what is tried, searched or counted."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise

from btlang.passes.lint.other_readings import (
    Attachment,
    Readings,
    add_brackets,
    is_in_brackets,
    replace_part,
    sort_by_place,
)
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.answers import ABOUT_ANSWERS
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

OTHERWISE, PACED, FORMS, SENTENCES = "otherwise", "paced", "forms", "sentences"
SEARCHES, TRIED, LEAVES = "searches", "tried", "leaves"
_SENTENCE_END = re.compile(r"[.;!?]")
_SEES = "perception"
_WORD = re.compile(r"\w+")


def find_in_form(node: ast.If | ast.Try, vocabulary: Lexicon) -> Iterator[Attachment]:
    """Find an `otherwise` that both this form and one at the end of its body could have, and another `if` there."""
    body = node.body
    if node.otherwise is None and isinstance(body, ast.Every | ast.UntilTime) and body.span.start == node.span.start:
        if isinstance(node, ast.If) and not is_in_brackets(body.span) and "\n" not in node.span.text:
            yield Attachment(FORMS, node.span.start, partial(_in_each_round, node))
        return
    if node.otherwise is not None or body.span.start <= node.span.start:
        return
    if isinstance(node, ast.Try) and _is_tried(node, vocabulary) and _is_joined_by_then(body, vocabulary):
        yield Attachment(TRIED, node.span.start, partial(_first_alone, node, 1))
    leaves = _leaves_at(node, vocabulary) if isinstance(node, ast.If) else 0
    if leaves:
        yield Attachment(LEAVES, node.span.start, partial(_first_alone, node, leaves))
    joins = isinstance(body, ast.Chain) and body.operator in ("sequence", "parallel") and not body.bracketed
    if isinstance(node, ast.If) and isinstance(body, ast.Chain) and joins and len(body.items) > 1:
        before, last = body.items[-2:]
        gap = Span(last.span.source, before.span.end, last.span.start)
        is_open = gap.text.strip() in (",", *vocabulary.roles["and"]) or gap.text.strip(" ,") in vocabulary.roles["and"]
        if isinstance(last, ast.If) and last.otherwise is None and last.body.span.start > last.span.start and is_open:
            yield Attachment(FORMS, node.span.start, partial(_side_by_side, node, gap, vocabulary.word("then")))
            return
    path: list[ast.Ast] = [node]
    part: Any = node.body
    while not _has_otherwise(part):
        path.append(part)
        if isinstance(part, ast.Chain) and not part.bracketed and not ast.is_list(part):
            part = sort_by_place(part.items)[-1]
        elif isinstance(part, ast.If | ast.Try | ast.Chain) or is_in_brackets(part.span):
            return
        elif getattr(part, "body", None) is not None and part.body.span.start > part.span.start:
            part = part.body
        else:
            return
    text = part.span.source.text
    if is_in_brackets(part.span) or "\n" in text[node.span.start : part.span.start]:
        return
    yield Attachment(OTHERWISE, node.span.start, partial(_move, node, path, part))


def find_in_pace(node: ast.Every, vocabulary: Lexicon) -> Iterator[Attachment]:
    """Find `A 3 times every 10 s`: the number could be that of each round; and `every 10 s, A until C`."""
    start, body, each = node.span.start, node.body.span, node.body
    ends = isinstance(each, ast.While) and each.negated and each.body.span.start == body.start > start
    if ends and not node.rounds and "\n" not in node.span.text and not is_in_brackets(body):
        yield Attachment(PACED, start, partial(_until_outside, node))
        return
    if not node.rounds or body.start != start:
        return  # as nearly always
    behind = node.span.source.text[body.end : node.span.end]
    words = {vocabulary.orthography.words(pattern)[0] for pattern in vocabulary.roles["every"]}
    at = min((match.start() for match in _WORD.finditer(behind) if match[0].lower() in words), default=0)
    if _WORD.search(behind[:at]):
        yield Attachment(PACED, start, partial(_repeat_inside, node, Span(body.source, body.end, node.span.end), at))


def find_in_time(node: ast.For, vocabulary: Lexicon) -> Iterator[Attachment]:
    """Find `wait for Alice for 10 min`: once, and at most so long."""
    body = node.body
    if not isinstance(body, ast.Phrase) or body.span.start != node.span.start or is_in_brackets(body.span):
        return
    entry = body.entry
    if entry.achieves and _SEES in entry.needs and (entry.first or MOVES not in entry.resources):
        yield Attachment(SEARCHES, node.span.start, partial(_once_at_most, node, vocabulary.word("repeat")))


def find_in_sentences(chain: ast.Chain, vocabulary: Lexicon) -> Iterator[Attachment]:
    """Find `if C, A. If D, B. Otherwise E`, and `if the lamp is on, switch it off. If it is off, switch it on`."""
    if chain.operator != "sequence":
        return
    then = vocabulary.word("then").capitalize()
    for earlier, second in pairwise(chain.items):
        first = earlier
        if isinstance(first, ast.IfWorks):  # `check whether C. If it is, A`
            first = ast.If(False, first.tried, first.body, first.otherwise, first.span)
        if not isinstance(first, ast.If) or not isinstance(second, ast.If) or first.otherwise is not None:
            continue
        if second.negated or not (_is_before(first) and _is_before(second)):
            continue
        if "\n" in _between(first, second) or _WORD.search(_between(first, second)):
            continue
        if second.otherwise is None:
            if _brings_about(first.body, second.condition) or _denies(first, second):
                gap = Span(first.span.source, first.span.end, second.span.start + 1)
                words = f". {then} {second.span.text[0].lower()}"
                yield Attachment(SENTENCES, first.span.start, partial(_as_otherwise, earlier, second, gap, words))
        elif _SENTENCE_END.search(_between(second.body, second.otherwise)):
            gap = Span(first.span.source, second.body.span.end, second.otherwise.span.start)
            words = f", {_WORD.findall(gap.text)[0].lower()} " if _WORD.search(gap.text) else gap.text
            yield Attachment(SENTENCES, first.span.start, partial(_as_otherwise, earlier, second, gap, words))


def _denies(first: ast.If, second: ast.If) -> bool:
    """Whether the second sentence asks if what the first asks is not so: `if C, A. If not C, B`.

    An answer stays what it was.
    """
    asked = second.condition
    if isinstance(first.condition, ast.Phrase) and first.condition.entry.id in ABOUT_ANSWERS:
        return False
    return not first.negated and isinstance(asked, ast.Not) and _same(asked.condition, first.condition)


def _same(one: ast.Ast, other: ast.Ast) -> bool:
    """Whether two conditions ask the same."""
    if not isinstance(one, ast.Phrase) or not isinstance(other, ast.Phrase):
        return False
    return (one.entry, one.arguments) == (other.entry, other.arguments)


def _is_before(node: ast.If) -> bool:
    """Whether its condition stands before its command."""
    return node.condition.span.start < node.body.span.start


def _between(left: ast.Ast, right: ast.Ast) -> str:
    return left.span.source.text[left.span.end : right.span.start]


def _brings_about(body: ast.Ast, condition: ast.Ast) -> bool:
    """Whether a command makes a condition true."""
    if not isinstance(condition, ast.Phrase):
        return False
    values = {text for _, text in condition.arguments}
    done = (each for each in ast.parents_first(body) if isinstance(each, ast.Phrase))
    return any(
        condition.entry.id in each.entry.achieves and values == {text for _, text in each.arguments} for each in done
    )


def _is_tried(node: ast.Try, vocabulary: Lexicon) -> bool:
    """Whether it begins with a word for `try`, not with `if possible`."""
    first = _WORD.match(node.span.text)
    return first is not None and first[0].lower() in vocabulary.firsts["try"]


def _is_joined_by_then(body: ast.Ast, vocabulary: Lexicon) -> bool:
    """Whether commands stand behind one another with a word between the first two that says so, out of brackets."""
    if not isinstance(body, ast.Chain) or body.operator != "sequence" or body.bracketed:
        return False
    return _between(*body.items[:2]).strip(" ,").lower() in vocabulary.roles["then"]


def _leaves_at(node: ast.If, vocabulary: Lexicon) -> int:
    """Return how many commands of `if C, A, then B` are before the `then`, 0 unless B could be done in any case.

    That is so where the robot only leaves with B, for a goal that has nothing to do with C or A.
    """
    if not isinstance(node.body, ast.Chain) or node.body.operator != "sequence" or node.body.bracketed:
        return 0
    told = _told(node.condition)
    for at, (here, behind) in enumerate(pairwise(node.body.items)):
        if not isinstance(here, ast.Phrase) or not isinstance(behind, ast.Phrase) or MOVES in here.entry.resources:
            return 0
        told |= _told(here)
        _, comma, word = _between(here, behind).rpartition(",")
        if comma and word.strip().lower() in vocabulary.roles["then"]:
            goal = _told(behind) if MOVES in behind.entry.resources else set()
            return at + 1 if goal and not goal & told else 0
    return 0


def _told(node: ast.Ast) -> set[str]:
    """Return the values of the phrases in a node."""
    phrases = (each for each in ast.parents_first(node) if isinstance(each, ast.Phrase))
    return {text for phrase in phrases for _, text in phrase.arguments}


def _has_otherwise(node: ast.Ast) -> bool:
    return getattr(node, "otherwise", None) is not None


def _move(node: Any, path: Sequence[ast.Ast], part: Any) -> Readings:
    """Read `if C, if D, A otherwise B` as: if C, (if D, A) otherwise B."""
    tried = isinstance(part, ast.Try) and part.body.span.start == part.span.start
    changed: ast.Ast = part.body if tried else part.replace(otherwise=None)
    for inner, outer in zip([part, *path[:0:-1]], path[::-1], strict=True):
        changed = replace_part(outer, inner, changed)
    return Readings(node, changed.replace(otherwise=part.otherwise), node.span, add_brackets(part.span))


def _side_by_side(node: ast.If, gap: Span, then: str) -> Readings:
    """Read `if C, A, if D, B` as: if C, A; then, whatever came of that, if D, B."""
    body: Any = node.body
    *before, last = body.items
    first = before[0] if len(before) == 1 else body.replace(items=tuple(before))
    fix = (gap, f" {then} ")
    if body.operator == "parallel":
        head = Span(body.span.source, node.condition.span.end, body.span.end)
        fix = head, f", ({body.span.text})"
    taken = node.replace(body=body.replace(bracketed=True))
    other = ast.Chain(body.operator, (node.replace(body=first), last), False, node.span)
    return Readings(taken, other, node.span, fix)


def _first_alone(node: ast.If | ast.Try, count: int) -> Readings:
    """Read `try to A, then B` as: try to A; then B in any case. `count` commands are before the `then`."""
    body: Any = node.body
    first = node.replace(body=body.items[0] if count == 1 else body.replace(items=body.items[:count]))
    other = ast.Chain("sequence", (first, *body.items[count:]), True, node.span)
    return Readings(node, other, node.span, add_brackets(body.span))


def _repeat_inside(node: ast.Every, behind: Span, at: int) -> Readings:
    """Make the reading of `A 3 times every 10 s` as: every 10 s, A 3 times."""
    rounds, pace = behind.text[:at].strip(), behind.text[at:]
    other = node.replace(body=ast.Repeat(node.rounds, node.body, node.span), rounds="")
    return Readings(node, other, node.span, (behind, f" {pace} {rounds}"))


def _in_each_round(node: ast.If) -> Readings:
    """Make the reading of `A every 10 s unless C` in which C is asked in each round."""
    loops, body = list[ast.Every | ast.UntilTime](), node.body
    while isinstance(body, ast.Every | ast.UntilTime):
        loops.append(body)
        body = body.body
    other: ast.Ast = node.replace(body=body)
    for loop in reversed(loops):
        other = loop.replace(body=other)
    return Readings(node, other, node.span, add_brackets(node.body.span))


def _until_outside(node: ast.Every) -> Readings:
    """Make the reading of `every 10 s, A until C` in which C ends all rounds."""
    each = node.body
    assert isinstance(each, ast.While)
    other = each.replace(body=node.replace(body=each.body), span=node.span)
    return Readings(node, other, node.span, add_brackets(each.span))


def _once_at_most(node: ast.For, repeat: str) -> Readings:
    fix = node.body.span, f"{repeat} ({node.body.span.text})"
    return Readings(node, ast.Within(node.seconds, node.body, node.span), node.span, fix)


def _as_otherwise(first: ast.Ast, second: ast.If, gap: Span, words: str) -> Readings:
    """Read `if C, A. If D, B` as: if C, A, otherwise if D, B."""
    span = Span(first.span.source, first.span.start, second.span.end)
    taken = ast.Chain("sequence", (first, second), True, span)
    return Readings(taken, first.replace(otherwise=second, span=span), span, (gap, words))
