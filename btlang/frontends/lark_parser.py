"""The Lark parser: the grammar of `grammar/mission.lark`, LALR and strict, over the same tokens."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from threading import Lock

from lark import Lark, Transformer, UnexpectedInput
from lark import Token as LarkToken
from lark.lexer import Lexer

from btlang.frontends.build import CHAINS, Builder
from btlang.frontends.parse_error import ParseError
from btlang.frontends.token import Token
from btlang.text.source import Source
from btlang.tree.ast import Ast
from btlang.vocabulary.shipped import shipped

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_one_at_a_time = Lock()  # the transformer is bound to the parser and knows the source of one parse


def parse(tokens: Sequence[Token], build: Builder) -> Ast:
    """The expression that the tokens of a unit make. Raises ParseError where they make none."""
    lark, to_ast = _parser()
    with _one_at_a_time:
        to_ast.build = build
        try:
            return lark.parse(tokens)
        except UnexpectedInput as error:
            raise ParseError(str(error)) from None


@cache
def _parser() -> tuple[Lark, _ToAst]:
    to_ast = _ToAst()
    with open(shipped("grammar", "mission.lark"), encoding="utf-8") as file:
        grammar = file.read()
    # strict: a conflict in the grammar is an error and not resolved silently
    lark = Lark(grammar, start="mission", parser="lalr", lexer=_Tokens, strict=True, transformer=to_ast)
    return lark, to_ast


class _Tokens(Lexer):
    """Hands the grouped tokens on as they are; each Lark token carries one as its value."""

    def __init__(self, _configuration: object) -> None:
        pass

    def lex(self, tokens: Any, _parser_state: Any = None) -> Iterator[LarkToken]:
        for token in tokens:
            yield LarkToken(token.kind, token)


class _ToAst(Transformer[LarkToken, Ast]):
    """Called by the parser at each reduction, so that no parse tree is made and depth does not matter."""

    def __init__(self) -> None:
        super().__init__()
        self.build = Builder(Source(""))

    def _chain(self, children: list[Any]) -> Ast:
        items, connective = children[::2], children[1].value.kind
        start, end = items[0].span.start, items[-1].span.end
        return self.build.chain(CHAINS[connective], items, start, end)

    statements = fallback = wide_parallel = sequence = either = parallel = _chain
    condition = wide_all = any = all = _chain

    def after(self, children: list[Any]) -> Ast:
        items = children[::2]
        return self.build.chain("sequence", items[::-1], items[0].span.start, items[-1].span.end)

    def leaf(self, children: list[Any]) -> Ast:
        return self.build.leaf(children[0].value)

    def group(self, children: list[Any]) -> Ast:
        opener, inner, closer = children
        return self.build.group(inner, opener.value.start, closer.value.end)

    def postfix(self, children: list[Any]) -> Ast:
        return self.build.postfix(children[0], children[1].value)

    def negation(self, children: list[Any]) -> Ast:
        return self.build.negation(children[0].value, children[1])

    def form(self, children: list[Any]) -> Ast:
        opener, condition, _do, body, *rest = children
        otherwise = rest[1] if len(rest) == 3 else None
        return self.build.form(opener.value.value, condition, body, otherwise, opener.value.start, rest[-1].value.end)

    form_else = form

    def after_form(self, children: list[Any]) -> Ast:
        body, opener, condition, *rest = children
        otherwise = rest[1] if len(rest) == 3 else None
        return self.build.form(opener.value.value, condition, body, otherwise, body.span.start, rest[-1].value.end)

    wide_form = after_form_else = after_form

    def loop(self, children: list[Any]) -> Ast:
        opener, body, *rest = children
        end = rest[-1].value.end
        if len(rest) == 1:
            return self.build.loop(opener.value, body, None, end, end)
        return self.build.loop(opener.value, body, rest[1], end, rest[0].value.value)

    loop_else = loop

    def loop_stop(self, children: list[Any]) -> Ast:
        opener, body, stop, condition, end = children
        return self.build.form(stop.value.value, condition, body, None, opener.value.start, end.value.end)

    def test(self, children: list[Any]) -> Ast:
        opener, condition, end = children
        return self.build.test(opener.value, condition, end.value.end)
