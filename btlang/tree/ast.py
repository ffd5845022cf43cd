"""The syntax tree of a mission, as both parsers give it: what was said, with the exact characters of each part.

Commands: Phrase, Name, Chain, If, While, Provided, Repeat, Retry, Try, Within, For, Every, Delay, Wait, WaitUntil,
Check, Nothing, Fail; Whenever in a sequence. Conditions: Phrase, Name, Chain ("all", "any"), Not. `parts` names the
fields that hold subtrees.
Amounts are port texts in base units (seconds); a number of rounds of -1 is without end.
"""

from __future__ import annotations

from btlang.record import Record
from btlang.text.source import Span
from btlang.vocabulary.entry import Entry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import ClassVar


class Ast(Record):
    """Base of all syntax nodes."""

    if TYPE_CHECKING:  # each class has it as its last field

        @property
        def span(self) -> Span: ...

    parts: ClassVar[tuple[str, ...]] = ()


class Phrase(Ast):
    """A phrase of a keyword file; `arguments` are (slot, port text) in the order spoken."""

    entry: Entry
    arguments: tuple[tuple[str, str], ...]
    span: Span


class Name(Ast):
    """A defined name."""

    name: str
    span: Span


class Chain(Ast):
    """Operands joined by one connective: a "sequence", "fallback" or "parallel" of commands, "all" or "any" conditions.

    Never directly inside an equal chain unless one of them is `bracketed`.
    """

    operator: str
    items: tuple[Ast, ...]
    bracketed: bool
    span: Span
    parts = ("items",)


class Not(Ast):
    condition: Ast
    span: Span
    parts = ("condition",)


class _Branching(Ast):
    """`negated` is "unless" or "until"."""

    negated: bool
    condition: Ast
    body: Ast
    otherwise: Ast | None
    span: Span
    parts = ("condition", "body", "otherwise")


class If(_Branching):
    """if, unless."""


class While(_Branching):
    """while, until."""


class Whenever(Ast):
    """A standing rule over the other commands of its block."""

    condition: Ast
    body: Ast
    span: Span
    parts = ("condition", "body")


class Provided(Ast):
    condition: Ast
    body: Ast
    span: Span
    parts = ("condition", "body")


class Repeat(Ast):
    rounds: int
    body: Ast
    span: Span
    parts = ("body",)


class Retry(Ast):
    attempts: int
    body: Ast
    span: Span
    parts = ("body",)


class Try(Ast):
    """Without `otherwise` a failure of the body is ignored."""

    body: Ast
    otherwise: Ast | None
    span: Span
    parts = ("body", "otherwise")


class _Timed(Ast):
    seconds: str
    body: Ast
    span: Span
    parts = ("body",)


class Within(_Timed):
    """The body, which fails when it takes longer."""


class For(_Timed):
    """The body over and over until the time is over."""


class Every(_Timed):
    """The body once in each period."""


class Delay(_Timed):
    """The body after the time."""


class Wait(Ast):
    seconds: str
    span: Span


class WaitUntil(Ast):
    condition: Ast
    span: Span
    parts = ("condition",)


class Check(Ast):
    condition: Ast
    span: Span
    parts = ("condition",)


class Nothing(Ast):
    span: Span


class Fail(Ast):
    span: Span


class Definition(Ast):
    """`name_span` covers the words of the name where it is defined."""

    name: str
    body: Ast
    name_span: Span
    span: Span
    parts = ("body",)


class Fact(Ast):
    """A place of this mission, in metres and degrees; `facing` is None where any direction will do."""

    name: str
    x: float
    y: float
    facing: float | None
    span: Span


class Mission(Ast):
    """A whole text: the sequence of its commands (None where there are none), its definitions and facts in order."""

    body: Ast | None
    definitions: tuple[Definition, ...]
    span: Span
    facts: tuple[Fact, ...] = ()
    parts = ("body", "definitions")


def parts(node: Ast) -> list[Ast]:
    """The subtrees of a node in the order of its fields."""
    found: list[Ast] = []
    for field in node.parts:
        part = getattr(node, field)
        if type(part) is tuple:
            found += part
        elif part is not None:
            found.append(part)
    return found
