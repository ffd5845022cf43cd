"""English of missions as lines. What would be a long line becomes a head that ends in `:` and an indented body.

So does what only lines can say: a standing rule inside a form.

A block reads back to the same tree as the line that it replaces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from btlang.printer.exact import exact_block, quote, split_label, with_condition_first
from btlang.printer.fragments import COLON, COMMA, is_longer, mark
from btlang.printer.printer import THEN, Doc, Printer
from btlang.printer.sentence import (
    PRINTERS,
    definition_head,
    each_head,
    guards,
    is_flat_fallback,
    paced_rounds,
    rule_word,
    statements,
)
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.catalogue import SEQUENCE
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.node_forms import node_forms

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.printer.fragments import Fragments


INDENT = "  "
LEAST = 40
"""Columns; where less is left, a statement stays in one line."""

Section = tuple["Fragments", "ast.Ast | Iterable[tuple[ast.Ast, str]]"]
"""The words before the colon and the lines below it, as `statements` gives them; or words and what is behind them."""


def lines_of(
    node: ast.Ast, printer: Printer, width: float = math.inf, joined: str = "", least: int = LEAST
) -> list[str]:
    """Print the lines of a statement, at most `width` long if blocks can do that. See Printer.statement.

    With brackets "clear" those that people could misread are blocks, too.
    """
    found: list[str] = []
    stack: list[tuple[int, ast.Ast | str, str, str]] = [(0, node, joined, "")]  # with the name before it
    while stack:
        depth, item, among, name = stack.pop()
        if isinstance(item, str):
            found += _wrap(INDENT * depth + item, INDENT * (depth + 2), width, printer)
            continue
        kept = printer.kept_lines(item)
        if kept:
            found += (f"{INDENT * depth}{line}" if line else "" for line in kept)
            continue
        label, bare = split_label(item)
        if label and not name:
            found += (f"{INDENT * depth}# {text}" for text in printer.comments(item, whole=False))
            stack.append((depth, bare, among, quote(label, printer.vocabulary)))
            continue
        said, room = printer.say(item), width - len(INDENT) * depth - len(name)
        line = "" if is_longer(said.fragments, room) else printer.line(item, said, among)
        too_long = not line or len(line) > room
        unclear = printer.is_clear and said.is_mixed
        needs_block = said.in_lines or ((too_long or unclear) and room >= least)
        sections = _sections(item, said, among, unclear, too_long) if needs_block else _none
        below: list[tuple[int, ast.Ast | str, str, str]] = []
        for head, body in sections(item, printer):
            if isinstance(body, ast.Ast):
                below.append((depth, printer.text((head, printer.say(body).fragments)), "", ""))
                continue
            before = f"{name}, " if name and not below else ""
            below.append((depth, before + printer.text((head, mark(COLON))), "", ""))
            below += [(depth + 1, part, joint, "") for part, joint in body]
        found += (f"{INDENT * depth}# {text}" for text in printer.comments(item, whole=not below))
        before = f"{name}: " if name else ""
        line = (too_long and with_condition_first(item, printer)) or line or printer.line(item, said, among)
        stack.extend(reversed(below or [(depth, before + line, "", "")]))
    return found


def _wrap(line: str, margin: str, width: float, printer: Printer) -> Iterator[str]:
    """Split a line that is too long at its commas, behind which it goes on below."""
    if len(line) <= width:
        yield line
        return
    words = split(Source(line), printer.vocabulary.orthography)
    inside = tuple(f", {rest}" for form in node_forms(printer.vocabulary) for rest in form.pattern.split(", ")[1:])
    ends = [end for word, end in zip(words.words, words.ends, strict=True) if word == COMMA]
    ends = [end for end in ends if not line.startswith(inside, end - 1)]  # `in order, checked at each tick` stays whole
    begin, before, head = 0, 0, ""
    for end in (*ends, len(line)):
        if len(head) + end - begin > width and before > begin:
            yield head + line[begin:before]
            begin, head = before + 1, margin
        before = end
    yield head + line[begin:]


def _sections(
    node: ast.Ast, said: Doc, among: str, unclear: bool, too_long: bool
) -> Callable[[Any, Printer], Iterator[Section]]:
    """Return how a statement is a block, which is one of a chain or of `children`."""
    if isinstance(node, ast.Chain):
        if node.operator == "sequence" and (among == "children" or ((unclear or too_long) and not said.can_skip)):
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
    """Say a sequence by its id, below a node said by its id, or if it never skips."""
    yield from exact_block(ast.Exact(SEQUENCE, (), "", node.items, False, node.span), printer)


def _branching(positive: str, negative: str) -> Callable[[Any, Printer], Iterator[Section]]:
    def sections(node: Any, printer: Printer) -> Iterator[Section]:
        condition = printer.condition(printer.say(node.condition))
        yield (printer.word(negative if node.negated else positive), condition.fragments), statements(node.body)
        if node.otherwise is not None:
            yield (printer.word("otherwise"),), statements(node.otherwise)

    return sections


def _whenever(node: ast.Whenever, printer: Printer) -> Iterator[Section]:
    condition = printer.condition(printer.say(node.condition))
    yield (printer.word(rule_word(node)), condition.fragments), statements(node.body)


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
    """Split a sequence that isn't made of lines: `A then C after B:` if B needs a block, which nothing can follow."""
    said = [printer.say(item) for item in node.items]
    needing = [i for i, part in enumerate(said) if part.in_lines]
    if len(needing) != 1:
        return
    before, after = said[: needing[0]], reversed(said[needing[0] + 1 :])
    words = [(part, "then") for part in before] + [(part, "after") for part in after]
    inner = [
        (printer.inside(part, part.level <= THEN or part.reaches).fragments, printer.word(role)) for part, role in words
    ]
    block = node.items[needing[0]]
    for i, (head, body) in enumerate(_SECTIONS.get(type(block), _none)(block, printer)):
        yield (head if i else (*inner, head)), body


def _provided(node: ast.Provided, printer: Printer) -> Iterator[Section]:
    head, body = guards(node, printer)
    yield head, statements(body)


def _repeat(node: ast.Repeat, printer: Printer) -> Iterator[Section]:
    yield (printer.word("repeat"), printer.rounds(node.rounds)), statements(node.body)


def _timed(*roles: str) -> Callable[[Any, Printer], Iterator[Section]]:
    def sections(node: Any, printer: Printer) -> Iterator[Section]:
        words = tuple(printer.word(role) for role in roles[:-1])
        yield (*words, printer.duration(roles[-1], node.seconds)), statements(node.body)

    return sections


def _until_time(node: ast.UntilTime, printer: Printer) -> Iterator[Section]:
    yield (printer.word("repeat"), printer.time_of_day("until_time", node.time)), statements(node.body)


def _by_time(node: ast.ByTime, printer: Printer) -> Iterator[Section]:
    yield (printer.time_of_day("by_time", node.time),), statements(node.body)


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
    """Print a definition. A condition stays in its line: the lines of a block are commands."""
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
    ast.Provided: _provided,
    ast.Repeat: _repeat,
    ast.Retry: _retry,
    ast.For: _timed("repeat", "for"),
    ast.UntilTime: _until_time,
    ast.ByTime: _by_time,
    ast.Every: _every,
    ast.Apart: _apart,
    ast.Delay: _timed("delay"),
    ast.Within: _timed("within"),
    ast.ForEach: _for_each,
    ast.Definition: _definition,
    ast.Exact: exact_block,
}
"""The forms that have blocks; any other statement stays in one line."""


def english(
    node: ast.Ast, vocabulary: Lexicon, *, brackets: str = "needed", names: Iterable[str | ast.Definition] = ()
) -> str:
    """Write canonical English of any AST; a Mission is its facts, its definitions and then its commands.

    Each is on a line, or in a block where a line cannot say it.
    `brackets` is "needed", "clear" or "all" (see Printer); `names` are those that are defined where a part of a
    mission stands.
    """
    if not isinstance(node, ast.Program):
        return "\n".join(lines_of(node, Printer(PRINTERS, vocabulary, names, brackets)))
    printer = printer_of(node, vocabulary, brackets)
    return "\n".join(mission_lines(node, printer))


def mission_lines(mission: ast.Program, printer: Printer, width: float = math.inf) -> Iterator[str]:
    """Print the lines of a mission; see `lines_of`."""
    for role, path in mission.needs:
        yield f"{printer.word(role).text} {quote(path, printer.vocabulary)}"
    if mission.name:
        yield f"{printer.word('main_name').text} {quote(mission.name, printer.vocabulary)}"
    yield from given_lines(mission.given, printer.word("given").text, width)
    named = (*mission.includes, *mission.facts, *mission.definitions)
    for part, joined in [*((part, "") for part in named), *statements(mission.body)]:
        yield from lines_of(part, printer, width, joined)


def given_lines(keys: Iterable[str], word: str, width: float) -> Iterator[str]:
    """Print `this mission is given {goal}, {path}`, in lines of at most so many columns if a name fits."""
    line = ""
    for key in keys:
        if line and len(line) + len(key) + 4 > width:
            yield line
            line = ""
        line = f"{line}, {{{key}}}" if line else f"{word} {{{key}}}"
    if line:
        yield line


def printer_of(mission: ast.Program, vocabulary: Lexicon, brackets: str = "needed") -> Printer:
    """Make a printer for the parts of a mission, which knows its names and places."""
    facts = ast.all_facts(mission)
    if facts:
        vocabulary = vocabulary.with_places(tuple(fact.name for fact in facts))
    return Printer(PRINTERS, vocabulary, ast.all_definitions(mission), brackets, frozenset(mission.given))
