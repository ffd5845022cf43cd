"""The forms that commands and conditions can be wrapped in, by the names that editors use for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.editing.syntax import Unplaced
from btlang.support.record import Record
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Form(Record):
    """A form of the language.

    `needs` is "condition", the type of an amount, or "". `make` makes it of a body and of what it needs; one with an
    `operator` is a chain of two or more instead. One of `of_conditions` is round conditions, any other one round
    commands.
    """

    needs: str = ""
    make: Callable[[ast.Ast, Any], ast.Ast] | None = None
    operator: str = ""
    of_conditions: bool = False

    def made(self, body: ast.Ast, what: object) -> ast.Ast:
        """Make a form, but only one without an operator."""
        assert self.make is not None
        return self.make(body, what)


FORMS: Mapping[str, Form] = {
    "repeat": Form("count", lambda body, rounds: ast.Repeat(rounds, body, body.span)),
    "forever": Form("", lambda body, _: ast.Repeat("-1", body, body.span)),
    "retry": Form("count", lambda body, attempts: ast.Retry(attempts, body, "", body.span)),
    "try": Form("", lambda body, _: ast.Try(body, None, body.span)),
    "within": Form("duration", lambda body, seconds: ast.Within(seconds, body, body.span)),
    "for": Form("duration", lambda body, seconds: ast.For(seconds, body, body.span)),
    "up to": Form("duration", lambda body, seconds: ast.UpTo(seconds, body, body.span)),
    "every": Form("duration", lambda body, seconds: ast.Every(seconds, body, "", body.span)),
    "after": Form("duration", lambda body, seconds: ast.Delay(seconds, body, body.span)),
    "until time": Form("time_of_day", lambda body, time: ast.UntilTime(time, body, body.span)),
    "if": Form("condition", lambda body, condition: ast.If(False, condition, body, None, body.span)),
    "unless": Form("condition", lambda body, condition: ast.If(True, condition, body, None, body.span)),
    "while": Form("condition", lambda body, condition: ast.While(False, condition, body, None, body.span)),
    "until": Form("condition", lambda body, condition: ast.While(True, condition, body, None, body.span)),
    "provided": Form("condition", lambda body, condition: ast.Provided(condition, body, body.span)),
    "stop when": Form("condition", lambda body, condition: ast.StopWhen(condition, body, body.span)),
    "whenever": Form("condition", lambda body, condition: ast.Whenever(condition, body, False, body.span)),
    "in sequence": Form(operator="sequence"),
    "in parallel": Form(operator="parallel"),
    "in order": Form(operator="fallback"),
    "not": Form("", lambda body, _: ast.Not(body, body.span), of_conditions=True),
    "all of": Form(operator="all", of_conditions=True),
    "any of": Form(operator="any", of_conditions=True),
}


def amount_of(kind: str, words: str, vocabulary: Lexicon) -> str:
    """Return the port text of an amount. Raises Unplaced."""
    if not kind:
        return ""
    found = vocabulary.value(kind, words)
    if found is None:
        example = vocabulary.types[kind].example
        raise Unplaced(f"'{words}' is no {kind.replace('_', ' ')}, such as {example}")
    return found
