"""The Lark parser: runs the LALR tables that Lark made of `grammar/mission.lark` (`grammar/make_tables.py`)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache

from btlang.frontends.mission.parsers.build import CHAINS, Builder
from btlang.frontends.mission.parsers.parse_error import ParseError
from btlang.frontends.mission.token import Token
from btlang.tree.ast import Ast
from btlang.vocabulary.shipped import shipped

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_END = "$END"  # Lark's name of the end of the text


def parse(tokens: Sequence[Token], build: Builder) -> Ast:
    """The expression that the tokens of a unit make. Raises ParseError where they make none."""
    tables, to_ast = _tables(), _ToAst(build)
    rules, states, end = tables["rules"], tables["states"], tables["end"]
    stack: list[int] = [0]
    values: list[Any] = []
    for token in (*tokens, None):
        kind = token.kind if token is not None else _END
        while (step := states[stack[-1]].get(kind)) is not None and step < 0:
            symbol, callback, length, flag = rules[-1 - step]
            parts = values[-length:]
            del stack[-length:], values[-length:]
            values.append(_reduced(flag, parts, getattr(to_ast, callback, to_ast.chain)))
            stack.append(states[stack[-1]][symbol])
            if token is None and stack[-1] == end:
                whole: Ast = values[-1]
                return whole
        if step is None:
            raise ParseError(f"unexpected {kind}")
        stack.append(step)
        values.append(token)
    raise ParseError("unexpected end")


class _Inline(list["Any"]):
    """The parts of one of Lark's helper rules: they are parts of the rule that uses it."""


def _reduced(flag: str, parts: list[Any], callback: Any) -> Any:
    if isinstance(parts[0], _Inline):  # a helper that grows: copying it each time would take quadratic time
        children = parts[0]
        children.extend(parts[1:])
    else:
        children = _Inline()
        for part in parts:
            children.extend(part) if isinstance(part, _Inline) else children.append(part)
    if flag == "inline":
        return children
    return children[0] if flag == "single" and len(children) == 1 else callback(children)


@cache
def _tables() -> dict[str, Any]:
    with open(shipped("grammar", "mission.tables.json"), encoding="utf-8") as file:
        tables: dict[str, Any] = json.load(file)
    return tables


class _ToAst:
    """Called at each reduction, so that no parse tree is made and depth does not matter.

    A rule that has no method of its name is a chain.
    """

    def __init__(self, build: Builder) -> None:
        self.build = build

    def chain(self, children: list[Any]) -> Ast:
        items, connective = children[::2], children[1].kind
        start, end = items[0].span.start, items[-1].span.end
        return self.build.chain(CHAINS[connective], items, start, end)

    def after(self, children: list[Any]) -> Ast:
        items = children[::2]
        return self.build.chain("sequence", items[::-1], items[0].span.start, items[-1].span.end)

    def leaf(self, children: list[Any]) -> Ast:
        return self.build.leaf(children[0])

    def group(self, children: list[Any]) -> Ast:
        opener, inner, closer = children
        return self.build.group(inner, opener.start, closer.end)

    def postfix(self, children: list[Any]) -> Ast:
        return self.build.postfix(children[0], children[1])

    def held(self, children: list[Any]) -> Ast:
        return self.build.held(children[0], children[1])

    def negation(self, children: list[Any]) -> Ast:
        return self.build.negation(children[0], children[1])

    def quantified(self, children: list[Any]) -> Ast:
        opener, inner, closer = children
        return self.build.quantified(opener, inner, closer.end)

    def form(self, children: list[Any]) -> Ast:
        opener, condition, _do, body, *rest = children
        otherwise = rest[1] if len(rest) == 3 else None
        return self.build.form(opener.role, condition, body, otherwise, opener.start, rest[-1].end)

    form_else = form

    def after_form(self, children: list[Any]) -> Ast:
        body, opener, condition, *rest = children
        otherwise = rest[1] if len(rest) == 3 else None
        return self.build.form(opener.role, condition, body, otherwise, body.span.start, rest[-1].end)

    after_form_else = after_form

    def if_works(self, children: list[Any]) -> Ast:
        tried, opener, body, *rest = children
        otherwise = rest[1] if len(rest) == 3 else None
        return self.build.form(opener.role, tried, body, otherwise, tried.span.start, rest[-1].end)

    if_works_else = if_works

    def loop(self, children: list[Any]) -> Ast:
        opener, body, *rest = children
        end = rest[-1].end
        if len(rest) == 1:
            return self.build.loop(opener, body, None, end, end)
        return self.build.loop(opener, body, rest[1], end, rest[0].start)

    loop_else = loop

    def fronted(self, children: list[Any]) -> Ast:
        opener, head, _do, body, end = children
        return self.build.fronted(opener.role, head, body, opener.start, end.end)

    def loop_stop(self, children: list[Any]) -> Ast:
        opener, body, stop, condition, end = children
        return self.build.form(stop.role, condition, body, None, opener.start, end.end)

    def test(self, children: list[Any]) -> Ast:
        opener, condition, end = children
        return self.build.test(opener, condition, end.end)
