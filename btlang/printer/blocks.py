"""Statements as lines: what would be a long line becomes a head that ends in `:` with its body indented below it.

So does what only lines can say: a standing rule inside a form.

A block reads back to the same tree as the line that it replaces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from btlang.printer.exact import exact_block
from btlang.printer.naming import definition_head, each_head
from btlang.printer.pieces import COLON, COMMA, Pieces, is_longer, mark
from btlang.printer.printer import THEN, Doc, Printer
from btlang.printer.sentence import is_flat_fallback, paced_rounds, rule_word, statements
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.catalogue import SEQUENCE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

INDENT = "  "
LEAST = 40
"""Columns; where less is left, a statement stays in one line."""

Section = tuple["Pieces", "ast.Ast | Iterable[tuple[ast.Ast, str]]"]
"""The words before the colon and the lines below it, as `statements` gives them; or words and what is behind them."""


def lines_of(
    node: ast.Ast, printer: Printer, width: float = math.inf, joined: str = "", least: int = LEAST
) -> list[str]:
    """The lines of a statement, at most `width` long where blocks can do that. See Printer.statement.

    With brackets "clear" those that people could misread are blocks, too.
    """
    found: list[str] = []
    stack: list[tuple[int, ast.Ast | str, str]] = [(0, node, joined)]
    while stack:
        depth, item, among = stack.pop()
        if isinstance(item, str):
            found += _wrapped(INDENT * depth + item, INDENT * (depth + 2), width, printer)
            continue
        kept = printer.kept_lines(item)
        if kept:
            found += (f"{INDENT * depth}{line}" if line else "" for line in kept)
            continue
        said, room = printer.say(item), width - len(INDENT) * depth
        line = "" if is_longer(said.pieces, room) else printer.line(item, said, among)
        too_long = not line or len(line) > room
        unclear = printer.is_clear and said.is_mixed
        needs_block = said.in_lines or ((too_long or unclear) and room >= least)
        sections = _sections(item, said, among, unclear) if needs_block else _none
        below: list[tuple[int, ast.Ast | str, str]] = []
        for head, body in sections(item, printer):
            if isinstance(body, ast.Ast):
                below.append((depth, printer.text((head, printer.say(body).pieces)), ""))
                continue
            below.append((depth, printer.text((head, mark(COLON))), ""))
            below += [(depth + 1, part, joint) for part, joint in body]
        found += (f"{INDENT * depth}# {text}" for text in printer.comments(item, whole=not below))
        stack.extend(reversed(below or [(depth, line or printer.line(item, said, among), "")]))
    return found


def _wrapped(line: str, margin: str, width: float, printer: Printer) -> Iterator[str]:
    """A line that is too long as several, where it has commas: behind one it goes on below."""
    if len(line) <= width:
        yield line
        return
    words = split(Source(line), printer.vocabulary.orthography)
    ends = [end for word, end in zip(words.words, words.ends, strict=True) if word == COMMA]
    begin, before, head = 0, 0, ""
    for end in (*ends, len(line)):
        if len(head) + end - begin > width and before > begin:
            yield head + line[begin:before]
            begin, head = before + 1, margin
        before = end
    yield head + line[begin:]


def _sections(node: ast.Ast, said: Doc, among: str, unclear: bool) -> Callable[[Any, Printer], Iterator[Section]]:
    """How a statement is a block, which is one of a chain or of `children`."""
    if isinstance(node, ast.Chain):
        if node.operator == "sequence" and (among == "children" or (unclear and not said.can_skip)):
            return _sequence_node
        if node.operator == "fallback" and unclear and _is_try(node):
            return _try_otherwise
    return _SECTIONS.get(type(node), _none)


def _is_try(node: ast.Chain) -> bool:
    """Whether two parts are better `try:` and `otherwise:`: one is a sequence, which is then lines.

    Not where one is a fallback itself: read back, its lines are `try:` and `otherwise:`, and the words would change.
    """
    operators = [item.operator for item in node.items if isinstance(item, ast.Chain)]
    is_inner = "fallback" in operators or any(isinstance(item, ast.Try) for item in node.items)
    return len(node.items) == 2 and "sequence" in operators and not is_inner


def _try_otherwise(node: ast.Chain, printer: Printer) -> Iterator[Section]:
    yield (printer.word("try"),), statements(node.items[0])
    yield (printer.word("otherwise"),), statements(node.items[1])


def _sequence_node(node: ast.Chain, printer: Printer) -> Iterator[Section]:
    """It may be said by its id where what holds it adds nothing to it: below a node that is, or if it never skips."""
    yield from exact_block(ast.Exact(SEQUENCE, (), "", node.items, False, node.span), printer)


def _branching(positive: str, negative: str) -> Callable[[Any, Printer], Iterator[Section]]:
    def sections(node: Any, printer: Printer) -> Iterator[Section]:
        condition = printer.condition(printer.say(node.condition))
        yield (printer.word(negative if node.negated else positive), condition.pieces), statements(node.body)
        if node.otherwise is not None:
            yield (printer.word("otherwise"),), statements(node.otherwise)

    return sections


def _whenever(node: ast.Whenever, printer: Printer) -> Iterator[Section]:
    condition = printer.condition(printer.say(node.condition))
    yield (printer.word(rule_word(node)), condition.pieces), statements(node.body)


def _try(node: ast.Try, printer: Printer) -> Iterator[Section]:
    if node.otherwise is not None and is_flat_fallback(node.otherwise) and printer.say(node.otherwise).in_lines:
        items = (node.body, *ast.parts(node.otherwise))
        yield (printer.word("in_order"),), ((item, "fallback") for item in items)  # the same node
        return
    yield (printer.word("try"),), statements(node.body)
    if node.otherwise is not None:
        flat = is_flat_fallback(node.otherwise)
        yield (printer.word("otherwise"),), node.otherwise if flat else statements(node.otherwise)


def _chain(node: ast.Chain, printer: Printer) -> Iterator[Section]:
    role = {"parallel": "in_parallel", "fallback": "in_order"}.get(node.operator)
    if role is not None:
        yield (printer.word(role),), ((item, node.operator) for item in node.items)
    elif node.operator == "sequence":
        yield from _sequence(node, printer)


def _sequence(node: ast.Chain, printer: Printer) -> Iterator[Section]:
    """A sequence that is not made of lines: `A then C after B:` where B needs a block, which nothing can follow."""
    said = [printer.say(item) for item in node.items]
    needing = [i for i, part in enumerate(said) if part.in_lines]
    if len(needing) != 1:
        return
    before, after = said[: needing[0]], reversed(said[needing[0] + 1 :])
    words = [(part, "then") for part in before] + [(part, "after") for part in after]
    inner = [
        (printer.inside(part, part.level <= THEN or part.reaches).pieces, printer.word(role)) for part, role in words
    ]
    block = node.items[needing[0]]
    for i, (head, body) in enumerate(_SECTIONS.get(type(block), _none)(block, printer)):
        yield (head if i else (*inner, head)), body


def _repeat(node: ast.Repeat, printer: Printer) -> Iterator[Section]:
    yield (printer.word("repeat"), printer.rounds(node.rounds)), statements(node.body)


def _timed(*roles: str) -> Callable[[Any, Printer], Iterator[Section]]:
    def sections(node: Any, printer: Printer) -> Iterator[Section]:
        words = tuple(printer.word(role) for role in roles[:-1])
        yield (*words, printer.duration(roles[-1], node.seconds)), statements(node.body)

    return sections


def _until_time(node: ast.UntilTime, printer: Printer) -> Iterator[Section]:
    yield (printer.word("repeat"), printer.time_of_day("until_time", node.time)), statements(node.body)


def _every(node: ast.Every, printer: Printer) -> Iterator[Section]:
    if node.rounds:
        yield from _paced("repeat", node.rounds, "every", node.seconds, node.body, printer)
    else:
        yield (printer.duration("every", node.seconds),), statements(node.body)


def _apart(node: ast.Apart, printer: Printer) -> Iterator[Section]:
    yield from _paced("repeat", node.rounds, "apart", node.seconds, node.body, printer)


def _retry(node: ast.Retry, printer: Printer) -> Iterator[Section]:
    if node.pause:
        yield from _paced("retry", node.attempts, "every", node.pause, node.body, printer)
    else:
        yield (printer.word("retry"), printer.rounds(node.attempts)), statements(node.body)


def _paced(head: str, rounds: str, role: str, seconds: str, body: ast.Ast, printer: Printer) -> Iterator[Section]:
    yield (printer.word(head), *paced_rounds(rounds, seconds, role, printer)), statements(body)


def _for_each(node: ast.ForEach, printer: Printer) -> Iterator[Section]:
    yield tuple(each_head(node, printer)), statements(node.body)


def _definition(node: ast.Definition, printer: Printer) -> Iterator[Section]:
    """A condition stays in its line: the lines of a block are commands."""
    body = node.body
    if isinstance(body, ast.Chain) and body.operator in ("all", "any"):
        return
    if isinstance(body, ast.Exact) and body.is_condition:
        return
    if not isinstance(body, ast.Phrase | ast.Name | ast.Compared | ast.Not | ast.AtLeast):
        yield definition_head(node, printer), statements(body)


def _none(_node: ast.Ast, _printer: Printer) -> Iterator[Section]:
    yield from ()


_SECTIONS: dict[type[ast.Ast], Callable[[Any, Printer], Iterator[Section]]] = {
    ast.Chain: _chain,
    ast.If: _branching("if", "unless"),
    ast.While: _branching("while", "until"),
    ast.Whenever: _whenever,
    ast.Try: _try,
    ast.Repeat: _repeat,
    ast.Retry: _retry,
    ast.For: _timed("repeat", "for"),
    ast.UntilTime: _until_time,
    ast.Every: _every,
    ast.Apart: _apart,
    ast.Delay: _timed("delay"),
    ast.ForEach: _for_each,
    ast.Definition: _definition,
    ast.Exact: exact_block,
}
"""The forms that have blocks; any other statement stays in one line."""
