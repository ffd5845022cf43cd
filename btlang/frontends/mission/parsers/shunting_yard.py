"""The shunting-yard parser (Dijkstra 1961): one loop over operator precedences.

A bracket or form opens a level with stacks of its own; DO, ELSE and STOP end a part of a form, END and CLOSE the whole.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.frontends.mission.parsers.build import CHAINS, Builder
from btlang.frontends.mission.parsers.parse_error import ParseError
from btlang.frontends.mission.token import Token
from btlang.tree.ast import Ast, Chain

PRECEDENCE = {
    "SEMI": 1, "BLOCK_AND": 1, "BLOCK_OR": 1, "BLOCK_CHILD": 1,
    "IF_WORKS": 2, "OR_ELSE": 3, "WIDE_MEANWHILE": 4, "WIDE_AND": 5, "THEN": 6, "AFTER": 7, "OR": 8,
    "MEANWHILE": 9, "AND": 10,
    "COND_OR_ELSE": 3, "COND_WIDE_AND": 5, "COND_OR": 8, "COND_AND": 10, "NOT": 11,
}  # fmt: skip
_OPENERS = frozenset(("OPEN", "COND_OPEN", "COND_OF", "FORM", "LOOP", "TEST", "AFTER_FORM", "IF_WORKS"))
_SECTIONS = frozenset(("DO", "ELSE", "STOP"))


class _Run:
    """A chain that still grows, so that a long one is not copied with each operand."""

    __slots__ = ("end", "items", "operator", "start")

    def __init__(self, operator: str, items: list[Ast], start: int, end: int) -> None:
        self.operator = operator
        self.items = items
        self.start = start
        self.end = end


class _Level:
    """What lies between an opener and its end: operands and operators, the finished parts and what ended them."""

    __slots__ = ("build", "opener", "operands", "operators", "parts", "sections")

    def __init__(self, build: Builder, opener: Token | None) -> None:
        self.build = build
        self.opener = opener
        self.operands: list[Ast | _Run] = []
        self.operators: list[Token] = []
        self.parts: list[Ast] = []
        self.sections: list[Token] = []

    def reduce(self, precedence: int) -> None:
        """Applies the operators that bind at least as tightly."""
        operators = self.operators
        while operators and PRECEDENCE[operators[-1].kind] >= precedence:
            operator = operators.pop()
            if operator.kind == "NOT":
                self.operands.append(self.build.negation(operator, self.take()))
            else:
                right, left = self.pop(), self.pop()
                self.operands.append(_joined(operator.kind, left, right, self.build))

    def pop(self) -> Ast | _Run:
        if not self.operands:
            raise ParseError("an operand is missing")
        return self.operands.pop()

    def take(self) -> Ast:
        """The latest operand as a finished node."""
        operand = self.pop()
        return _settled(operand, self.build)

    def finish_part(self) -> None:
        """Ends a part: all that is left makes one expression."""
        self.reduce(0)
        self.parts.append(self.take())
        if self.operands:
            raise ParseError("two operands stand side by side")


def parse(tokens: Sequence[Token], build: Builder) -> Ast:
    """The expression that the tokens of a unit make. Raises ParseError where they make none."""
    level = _Level(build, None)
    levels = [level]
    for token in tokens:
        kind = token.kind
        if kind == "COMMAND" or kind == "CONDITION":
            level.operands.append(build.leaf(token))
        elif kind in CHAINS:
            level.reduce(PRECEDENCE[kind])
            level.operators.append(token)
        elif kind == "NOT":
            level.operators.append(token)
        elif kind == "POSTFIX":
            level.operands.append(build.postfix(level.take(), token))
        elif kind == "COND_HELD":
            level.reduce(0)
            level.operands.append(build.held(level.take(), token))
        elif kind in _OPENERS:
            inner = _Level(build, token)
            if kind == "IF_WORKS":
                level.reduce(PRECEDENCE[kind])
            if kind == "AFTER_FORM" or kind == "IF_WORKS":
                inner.parts.append(level.take())
            level = inner
            levels.append(level)
        elif kind in _SECTIONS:
            level.finish_part()
            level.sections.append(token)
        else:
            level.finish_part()
            if len(levels) == 1:
                raise ParseError(f"{kind} closes nothing")
            node = _closed(levels.pop(), token, build)
            level = levels[-1]
            level.operands.append(node)
    level.finish_part()
    if len(levels) > 1:
        raise ParseError(f"{level.opener} is not closed")
    return level.parts[0]


def _joined(kind: str, left: Ast | _Run, right: Ast | _Run, build: Builder) -> _Run:
    operator = CHAINS[kind]
    start, end = _start(left), _end(right)
    first, second = (right, left) if kind == "AFTER" else (left, right)
    if not (isinstance(first, _Run) and first.operator == operator):
        first = _Run(operator, _items(first, operator, build), start, end)
    first.items += _items(second, operator, build)
    first.start, first.end = start, end
    return first


def _items(operand: Ast | _Run, operator: str, build: Builder) -> list[Ast]:
    """The operands that it adds to a chain: its own where it is an equal chain without brackets."""
    if isinstance(operand, _Run):
        return operand.items if operand.operator == operator else [_settled(operand, build)]
    if type(operand) is Chain and operand.operator == operator and not operand.bracketed:
        return list(operand.items)
    return [operand]


def _settled(operand: Ast | _Run, build: Builder) -> Ast:
    if isinstance(operand, _Run):
        return Chain(operand.operator, tuple(operand.items), False, build.span(operand.start, operand.end))
    return operand


def _start(operand: Ast | _Run) -> int:
    return operand.start if isinstance(operand, _Run) else operand.span.start


def _end(operand: Ast | _Run) -> int:
    return operand.end if isinstance(operand, _Run) else operand.span.end


def _closed(level: _Level, closer: Token, build: Builder) -> Ast:
    opener, parts = level.opener, level.parts
    assert opener is not None
    marks = [section.kind for section in level.sections]
    shape = (opener.kind, closer.kind, *marks)
    end = closer.end
    match shape:
        case ("OPEN", "CLOSE") | ("COND_OPEN", "COND_CLOSE"):
            return build.group(parts[0], opener.start, end)
        case ("COND_OF", "COND_CLOSE"):
            return build.quantified(opener, parts[0], end)
        case ("FORM", "END", "DO"):
            return build.form(opener.role, parts[0], parts[1], None, opener.start, end)
        case ("FORM", "END", "DO", "ELSE"):
            return build.form(opener.role, parts[0], parts[1], parts[2], opener.start, end)
        case ("AFTER_FORM", "END"):
            return build.form(opener.role, parts[1], parts[0], None, parts[0].span.start, end)
        case ("IF_WORKS", "END"):
            return build.form(opener.role, parts[0], parts[1], None, parts[0].span.start, end)
        case ("IF_WORKS", "END", "ELSE"):
            return build.form(opener.role, parts[0], parts[1], parts[2], parts[0].span.start, end)
        case ("AFTER_FORM", "END", "ELSE"):
            return build.form(opener.role, parts[1], parts[0], parts[2], parts[0].span.start, end)
        case ("LOOP", "END"):
            return build.loop(opener, parts[0], None, end, end)
        case ("LOOP", "END", "ELSE"):
            return build.loop(opener, parts[0], parts[1], end, level.sections[0].start)
        case ("LOOP", "END", "DO"):
            return build.fronted(opener.role, parts[0], parts[1], opener.start, end)
        case ("LOOP", "END", "STOP"):
            return build.form(level.sections[0].role, parts[1], parts[0], None, opener.start, end)
        case ("TEST", "END"):
            return build.test(opener, parts[0], end)
    raise ParseError(f"{opener} ends with {shape[1:]}")
