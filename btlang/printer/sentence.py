"""An AST as canonical English: one function for each class of syntax node, in the table PRINTERS.

What is said has exactly the reading of the AST: both parsers make of it an AST that lowers to an equal tree, and that
one is said in the same words. Words come from the vocabulary, so another language is another keyword file. To keep the
rules few, a sentence uses `then`, `or`, `and` without commas, forms with a condition before their command, and forms
with a value behind it; brackets do the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from btlang.printer import naming
from btlang.printer.exact import exact, phrase
from btlang.printer.pieces import COMMA, LEAF, Piece, Pieces, mark
from btlang.printer.printer import AND, FORM, LOOSE, OR, THEN, WHOLE, Doc, Printer, bracketed
from btlang.tree import ast
from btlang.vocabulary.language_tables import CONNECTIVES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LEVELS = {"sequence": THEN, "fallback": OR, "and": AND, "parallel": AND}
CHAINS = {
    **{operator: (_LEVELS.get(operator, THEN), role) for role, operator in reversed(CONNECTIVES.items())},
    "any": (OR, "or"), "all": (AND, "and"),
}  # fmt: skip


def statements(body: ast.Ast | None) -> Iterator[tuple[ast.Ast, str]]:
    """The commands that a body has as lines of its own, each with the operator of the chain that they make."""
    if isinstance(body, ast.Chain) and body.operator == "sequence":
        yield from ((item, body.operator) for item in body.items)
    elif body is not None:
        yield body, ""


def _leaf(text: str) -> Doc:
    return Doc((Piece(text, LEAF),), WHOLE)


def _name(node: ast.Name, _parts: list[Doc], printer: Printer) -> Doc:
    return _leaf(printer.name(node))


def _chain(node: ast.Chain, parts: list[Doc], printer: Printer) -> Doc:
    if node.operator == "parallel":
        return _parallel(node, parts, printer)
    level, role = CHAINS[node.operator]
    word = printer.word(role)
    inner = [printer.inside(p, p.level <= level or p.reaches or printer.reads_on(p, word)) for p in parts[:-1]]
    inner.append(printer.inside(parts[-1], parts[-1].level <= level))
    if printer.is_clear and node.operator == "any":
        negated = [isinstance(item, ast.Not) for item in node.items]
        inner = [printer.inside(p, own) for p, own in zip(inner, negated, strict=True)]
    if printer.is_clear:
        inner = [printer.inside(p, p.level < FORM or p.reaches or (p.behind and i > 0)) for i, p in enumerate(inner)]
    words = [word] * (len(inner) - 1)
    return Doc(tuple(_joined(inner, words)), level, *_flags(inner))


def _parallel(node: ast.Chain, parts: list[Doc], printer: Printer) -> Doc:
    """Joined by `and` where that alone means at the same time, else with the words that say so behind it."""
    if printer.joined_by_and(node):
        return _chain(node.replace(operator="and"), parts, printer)
    word = printer.word("and")
    inner = [printer.inside(p, p.level < WHOLE) for p in parts]
    behind = (printer.word("in_parallel"),)
    return Doc((*_joined(inner, [word] * (len(inner) - 1)), *behind), AND, False, False, any(p.counts for p in inner))


def _at_least(node: ast.AtLeast, parts: list[Doc], printer: Printer) -> Doc:
    """Its list reaches to the end of the condition, so inside another one it is in brackets."""
    word = printer.word("and")
    inner = [printer.inside(p, p.level < FORM or printer.reads_on(p, word)) for p in parts]
    pieces = [piece for part in inner[:-1] for piece in (part.pieces, mark(COMMA))]
    return Doc((printer.word("at_least_of", count=str(node.number)), *pieces[:-1], word, inner[-1].pieces), LOOSE)


def _joined(parts: Sequence[Doc], words: Sequence[Piece]) -> Iterator[Pieces | Piece]:
    for i, part in enumerate(parts):
        if i:
            yield words[i - 1]
        yield part.pieces


def _flags(parts: Sequence[Doc]) -> tuple[bool, bool, bool]:
    return parts[-1].reaches, parts[-1].takes_otherwise, any(part.counts for part in parts)


def _not(_node: ast.Not, parts: list[Doc], printer: Printer) -> Doc:
    inner = printer.inside(parts[0], parts[0].level < FORM)
    return Doc((printer.word("not"), inner.pieces), FORM)


def _branching(positive: str, negative: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(node: Any, parts: list[Doc], printer: Printer) -> Doc:
        condition = printer.condition(parts[0])
        head = (printer.word(negative if node.negated else positive), condition.pieces, mark(COMMA))
        if node.otherwise is not None:
            return printer.before(head, parts[1], printer.inside(parts[2], False))
        whose = printer.is_clear and parts[1].reaches and parts[1].chooses  # an `otherwise` could be of both
        return printer.before(head, printer.inside(parts[1], whose))

    return said


def _if_works(node: ast.IfWorks, parts: list[Doc], printer: Printer) -> Doc:
    tried = printer.inside(parts[0], parts[0].level == LOOSE or parts[0].reaches)
    head = (tried.pieces, mark(COMMA), printer.word("if_works"), mark(COMMA))
    otherwise = printer.inside(parts[2], parts[2].level == LOOSE) if node.otherwise is not None else None
    said = printer.before(head, printer.inside(parts[1], parts[1].level == LOOSE), otherwise)
    return Doc(said.pieces, LOOSE, True, said.takes_otherwise, said.counts)


def _whenever(node: ast.Whenever, parts: list[Doc], printer: Printer) -> Doc:
    word = printer.word(rule_word(node))
    return printer.before((word, printer.condition(parts[0]).pieces, mark(COMMA)), parts[1])


def rule_word(node: ast.Whenever) -> str:
    """The role of the word with which a rule begins."""
    return "first_time" if node.once else "whenever"


def _provided(_node: ast.Provided, parts: list[Doc], printer: Printer) -> Doc:
    return printer.behind(parts[1], printer.word("provided"), printer.condition(parts[0]).pieces)


def _stop_when(_node: ast.StopWhen, parts: list[Doc], printer: Printer) -> Doc:
    return printer.behind(parts[1], printer.word("stop_when"), printer.condition(parts[0]).pieces)


def _repeat(node: ast.Repeat, parts: list[Doc], printer: Printer) -> Doc:
    body = printer.inside(parts[0], isinstance(node.body, ast.Every | ast.Apart))  # which the count would pace
    return printer.behind(body, printer.rounds(node.rounds), counts=True)


def _retry(node: ast.Retry, parts: list[Doc], printer: Printer) -> Doc:
    """Its count closes it, so nothing else in it may count."""
    body = printer.inside(parts[0], parts[0].reaches or parts[0].counts)
    if node.pause:
        rounds: Pieces = paced_rounds(node.attempts, node.pause, "every", printer)
    else:
        rounds = (printer.rounds(node.attempts),)
    return Doc((printer.word("retry"), body.pieces, *rounds), FORM, takes_otherwise=True)


def paced_rounds(rounds: str, seconds: str, role: str, printer: Printer) -> tuple[Piece, Piece]:
    """`3 times every 5 s`; `once every 5 s` would have no number."""
    count = printer.word("count", count=rounds) if rounds == "1" else printer.rounds(rounds)
    return count, printer.duration(role, seconds)


def _try(node: ast.Try, parts: list[Doc], printer: Printer) -> Doc:
    body = parts[0]
    if node.otherwise is None:
        said = printer.behind(body, printer.word("if_possible"))
        return Doc(said.pieces, FORM, takes_otherwise=True, counts=said.counts, behind=True)
    otherwise = parts[1]
    if not is_flat_fallback(node.otherwise):
        otherwise = printer.inside(otherwise, otherwise.level == OR)
    if isinstance(node.body, ast.Retry) and not printer.all_brackets:
        pieces = (body.pieces, printer.word("otherwise"), otherwise.pieces)
        return Doc(pieces, FORM, True, otherwise.takes_otherwise, otherwise.counts)
    return printer.before((printer.word("try"),), bracketed(body) if body.counts else body, otherwise)


def is_flat_fallback(otherwise: ast.Ast) -> bool:
    """Whether the `otherwise` of a `try` makes one node with it, from which brackets would part it."""
    return isinstance(otherwise, ast.Chain) and otherwise.operator == "fallback" and not otherwise.bracketed


def _timed(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(node: Any, parts: list[Doc], printer: Printer) -> Doc:
        own = role == "for" and isinstance(node.body, ast.WaitUntil)  # `wait until C for 10 s`: C has to hold so long
        return printer.behind(printer.inside(parts[0], own), printer.duration(role, node.seconds))

    return said


def _paced(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(node: Any, parts: list[Doc], printer: Printer) -> Doc:
        counted = ast.Repeat | ast.Retry | ast.Every | ast.Apart  # behind these a count or a pace is part of them
        body = printer.inside(parts[0], isinstance(node.body, counted))
        if not node.rounds:
            return printer.behind(body, printer.duration(role, node.seconds))
        count, pace = paced_rounds(node.rounds, node.seconds, role, printer)
        words = (pace, (count,)) if role == "every" else (count, (pace,))  # `3 times every 5 s` has two readings
        return printer.behind(body, *words, counts=True)

    return said


def _constrained(node: ast.Constrained, parts: list[Doc], printer: Printer) -> Doc:
    """Whatever stands beside it in its statement or bracket would be constrained, too."""
    role = "without_entering" if node.kind == "keep out" else "without_leaving"
    zones = [printer.value(zone, "zone") for zone in node.zones]
    listed = f" {printer.word('and').text} ".join(zones)
    body = printer.inside(parts[0], parts[0].level < WHOLE)
    return Doc((body.pieces, Piece(printer.word(role, zone=listed).text, LEAF)), LOOSE)


def _wait(node: ast.Wait, _parts: list[Doc], printer: Printer) -> Doc:
    return _leaf(printer.duration("wait", node.seconds).text)


def _wait_until(node: ast.WaitUntil, parts: list[Doc], printer: Printer) -> Doc:
    held = (printer.duration("for", node.held),) if node.held else ()
    return Doc((printer.word("wait_until"), printer.condition(parts[0]).pieces, *held), FORM)


def _wait_time(node: ast.WaitTime, _parts: list[Doc], printer: Printer) -> Doc:
    """The next of several times: `wait until 08:00, 12:00 or 18:00`."""
    first, *more = node.time.split(";")
    said = [printer.time_of_day("wait_time", first).text, *(printer.value(time, "time_of_day") for time in more)]
    return _leaf(f" {printer.word('or').text} ".join((", ".join(said[:-1]), said[-1])) if more else said[0])


def _until_time(node: ast.UntilTime, parts: list[Doc], printer: Printer) -> Doc:
    return printer.behind(parts[0], printer.time_of_day("until_time", node.time))


def _test(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(_node: Any, parts: list[Doc], printer: Printer) -> Doc:
        return Doc((printer.word(role), printer.condition(parts[0]).pieces), FORM)

    return said


def _single(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(_node: Any, _parts: list[Doc], printer: Printer) -> Doc:
        return _leaf(printer.word(role).text)

    return said


PRINTERS: dict[type[ast.Ast], Callable[[Any, list[Doc], Printer], Doc]] = {
    ast.Phrase: phrase,
    ast.Name: _name,
    ast.Compared: naming.compared,
    ast.Assign: naming.assign,
    ast.Remember: naming.remember,
    ast.ForEach: naming.for_each,
    ast.Chain: _chain,
    ast.AtLeast: _at_least,
    ast.Not: _not,
    ast.If: _branching("if", "unless"),
    ast.While: _branching("while", "until"),
    ast.Whenever: _whenever,
    ast.Provided: _provided,
    ast.IfWorks: _if_works,
    ast.StopWhen: _stop_when,
    ast.Repeat: _repeat,
    ast.Retry: _retry,
    ast.Try: _try,
    ast.Within: _timed("within"),
    ast.For: _timed("for"),
    ast.UpTo: _timed("up_to"),
    ast.Every: _paced("every"),
    ast.Apart: _paced("apart"),
    ast.Delay: _timed("delay"),
    ast.Constrained: _constrained,
    ast.Wait: _wait,
    ast.WaitUntil: _wait_until,
    ast.WaitTime: _wait_time,
    ast.UntilTime: _until_time,
    ast.Check: _test("check"),
    ast.Nothing: _single("nothing"),
    ast.Fail: _single("fail"),
    ast.Exact: exact,
    ast.Definition: naming.definition,
    ast.Fact: naming.fact,
    ast.Include: naming.include,
}
"""How each class of node is said, given what is said of its parts."""
