"""Statements as lines: what would be a long line becomes a head that ends in `:` with its body indented below it.

So does what only lines can say: a standing rule inside a form.

A block reads back to the same tree as the line that it replaces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from btlang.english.exact import exact_block
from btlang.english.naming import definition_head, each_head
from btlang.english.pieces import COLON, Pieces, is_longer, mark
from btlang.english.sentence import is_flat_fallback, statements
from btlang.english.speaker import THEN, Said, Speaker
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
    node: ast.Ast, speaker: Speaker, width: float = math.inf, joined: str = "", least: int = LEAST
) -> list[str]:
    """The lines of a statement, at most `width` long where blocks can do that. See Speaker.statement.

    With brackets "clear" those that people could misread are blocks, too.
    """
    found: list[str] = []
    stack: list[tuple[int, ast.Ast | str, str]] = [(0, node, joined)]
    while stack:
        depth, item, among = stack.pop()
        if isinstance(item, str):
            found.append(INDENT * depth + item)
            continue
        said, room = speaker.say(item), width - len(INDENT) * depth
        line = "" if is_longer(said.pieces, room) else speaker.line(item, said, among)
        too_long = not line or len(line) > room
        unclear = speaker.is_clear and said.is_mixed
        needs_block = said.in_lines or ((too_long or unclear) and room >= least)
        sections = _sections(item, said, among, unclear) if needs_block else _none
        below: list[tuple[int, ast.Ast | str, str]] = []
        for head, body in sections(item, speaker):
            if isinstance(body, ast.Ast):
                below.append((depth, speaker.text((head, speaker.say(body).pieces)), ""))
                continue
            below.append((depth, speaker.text((head, mark(COLON))), ""))
            below += [(depth + 1, part, joint) for part, joint in body]
        found += (f"{INDENT * depth}# {text}" for text in speaker.comments(item, whole=not below))
        stack.extend(reversed(below or [(depth, line or speaker.line(item, said, among), "")]))
    return found


def _sections(node: ast.Ast, said: Said, among: str, unclear: bool) -> Callable[[Any, Speaker], Iterator[Section]]:
    """How a statement is a block, which is one of a chain or of `children`."""
    if isinstance(node, ast.Chain):
        if node.operator == "sequence" and (among == "children" or (unclear and not said.can_skip)):
            return _sequence_node
        if node.operator == "fallback" and unclear and _is_try(node):
            return _try_otherwise
    return _SECTIONS.get(type(node), _none)


def _is_try(node: ast.Chain) -> bool:
    """Whether two parts are better `try:` and `otherwise:`: one is a sequence, which is then lines."""
    operators = [item.operator for item in node.items if isinstance(item, ast.Chain)]
    return len(node.items) == 2 and "sequence" in operators and "fallback" not in operators


def _try_otherwise(node: ast.Chain, speaker: Speaker) -> Iterator[Section]:
    yield (speaker.word("try"),), statements(node.items[0])
    yield (speaker.word("otherwise"),), statements(node.items[1])


def _sequence_node(node: ast.Chain, speaker: Speaker) -> Iterator[Section]:
    """It may be said by its id where what holds it adds nothing to it: below a node that is, or if it never skips."""
    yield from exact_block(ast.Exact(SEQUENCE, (), "", node.items, False, node.span), speaker)


def _branching(positive: str, negative: str) -> Callable[[Any, Speaker], Iterator[Section]]:
    def sections(node: Any, speaker: Speaker) -> Iterator[Section]:
        condition = speaker.condition(speaker.say(node.condition))
        yield (speaker.word(negative if node.negated else positive), condition.pieces), statements(node.body)
        if node.otherwise is not None:
            yield (speaker.word("otherwise"),), statements(node.otherwise)

    return sections


def _whenever(node: ast.Whenever, speaker: Speaker) -> Iterator[Section]:
    condition = speaker.condition(speaker.say(node.condition))
    yield (speaker.word("whenever"), condition.pieces), statements(node.body)


def _try(node: ast.Try, speaker: Speaker) -> Iterator[Section]:
    if node.otherwise is not None and is_flat_fallback(node.otherwise) and speaker.say(node.otherwise).in_lines:
        items = (node.body, *ast.parts(node.otherwise))
        yield (speaker.word("in_order"),), ((item, "fallback") for item in items)  # the same node
        return
    yield (speaker.word("try"),), statements(node.body)
    if node.otherwise is not None:
        flat = is_flat_fallback(node.otherwise)
        yield (speaker.word("otherwise"),), node.otherwise if flat else statements(node.otherwise)


def _chain(node: ast.Chain, speaker: Speaker) -> Iterator[Section]:
    role = {"parallel": "in_parallel", "fallback": "in_order"}.get(node.operator)
    if role is not None:
        yield (speaker.word(role),), ((item, node.operator) for item in node.items)
    elif node.operator == "sequence":
        yield from _sequence(node, speaker)


def _sequence(node: ast.Chain, speaker: Speaker) -> Iterator[Section]:
    """A sequence that is not made of lines: `A then C after B:` where B needs a block, which nothing can follow."""
    said = [speaker.say(item) for item in node.items]
    needing = [i for i, part in enumerate(said) if part.in_lines]
    if len(needing) != 1:
        return
    before, after = said[: needing[0]], reversed(said[needing[0] + 1 :])
    words = [(part, "then") for part in before] + [(part, "after") for part in after]
    inner = [
        (speaker.inside(part, part.level <= THEN or part.reaches).pieces, speaker.word(role)) for part, role in words
    ]
    block = node.items[needing[0]]
    for i, (head, body) in enumerate(_SECTIONS.get(type(block), _none)(block, speaker)):
        yield (head if i else (*inner, head)), body


def _rounds(role: str, field: str) -> Callable[[Any, Speaker], Iterator[Section]]:
    def sections(node: Any, speaker: Speaker) -> Iterator[Section]:
        yield (speaker.word(role), speaker.rounds(getattr(node, field))), statements(node.body)

    return sections


def _timed(*roles: str) -> Callable[[Any, Speaker], Iterator[Section]]:
    def sections(node: Any, speaker: Speaker) -> Iterator[Section]:
        words = tuple(speaker.word(role) for role in roles[:-1])
        yield (*words, speaker.duration(roles[-1], node.seconds)), statements(node.body)

    return sections


def _for_each(node: ast.ForEach, speaker: Speaker) -> Iterator[Section]:
    yield tuple(each_head(node, speaker)), statements(node.body)


def _definition(node: ast.Definition, speaker: Speaker) -> Iterator[Section]:
    """A condition stays in its line: the lines of a block are commands."""
    body = node.body
    if isinstance(body, ast.Chain) and body.operator in ("all", "any"):
        return
    if isinstance(body, ast.Exact) and body.is_condition:
        return
    if not isinstance(body, ast.Phrase | ast.Name | ast.Compared | ast.Not):
        yield definition_head(node, speaker), statements(body)


def _none(_node: ast.Ast, _speaker: Speaker) -> Iterator[Section]:
    yield from ()


_SECTIONS: dict[type[ast.Ast], Callable[[Any, Speaker], Iterator[Section]]] = {
    ast.Chain: _chain,
    ast.If: _branching("if", "unless"),
    ast.While: _branching("while", "until"),
    ast.Whenever: _whenever,
    ast.Try: _try,
    ast.Repeat: _rounds("repeat", "rounds"),
    ast.Retry: _rounds("retry", "attempts"),
    ast.For: _timed("repeat", "for"),
    ast.Every: _timed("every"),
    ast.Delay: _timed("delay"),
    ast.ForEach: _for_each,
    ast.Definition: _definition,
    ast.Exact: exact_block,
}
"""The forms that have blocks; any other statement stays in one line."""
