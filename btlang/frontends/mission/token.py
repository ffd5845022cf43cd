"""Tokens between the stages of reading English.

Raw tokens (from `lexer`) have the kinds of connective roles and punctuation; "stop" is a full stop or line end before
a word that goes on with the statement before it, so that it ends nothing. The grouping stage turns them into
grouped tokens, which need no look-ahead any more:

    COMMAND CONDITION                      operands
    SEMI OR_ELSE WIDE_MEANWHILE WIDE_AND THEN AFTER OR MEANWHILE AND    between commands, loosest first
    BLOCK_AND BLOCK_OR                     in place of SEMI between the lines of `in parallel:`, `the first that works:`
    BLOCK_CHILD                            the same between the children of a node that is said by its id
    COND_OR_ELSE COND_WIDE_AND COND_OR COND_AND NOT    between and before conditions
    OPEN CLOSE COND_OPEN COND_CLOSE        brackets; a block is a bracket too
    COND_OF items COND_CLOSE               `neither`, `any of` ...; its role says which; COND_OR between the items
    POSTFIX                                after one command: `twice`, `within 10 s`, ...
    IF_WORKS body [ELSE body] END          after a whole chain: `A. If that works, B`
    FORM cond DO body [ELSE body] END      if, unless, while, until before a command
    AFTER_FORM cond [ELSE body] END        the same after one command, and `provided that`
    LOOP head DO body END                  before, after, while, if with a command as their head: `after waving, nod`
    LOOP body [STOP cond] END              repeat, every, after 5 s, for each, and try: LOOP body [ELSE body] END;
                                           also a node that is said by its id with its children, and a name before one
    TEST cond END                          check, wait until
"""

from __future__ import annotations

from collections.abc import Container, Sequence

from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree.rounds import DAYTIME
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.entry import Entry

QUANTIFIERS = frozenset(("neither", "not_both", "any_of", "all_of", "none_of", "at_least_of"))
"""Raw kinds that begin a list of conditions, or stand before a condition whose subject is a list."""
CORRELATIVES = frozenset(("either", "both"))
"""Raw kinds that say nothing before `A or B`, `A and B`."""

IN_CONDITIONS = frozenset(("condition", "not", "and", "or", "open", "close", *CORRELATIVES, *QUANTIFIERS))
"""Raw kinds of which a condition of a form consists."""
HOLDING = ("for", "held")
"""What may say how long a condition has to hold."""
WAITING = {"until": "wait_until", "for": "wait", "until_time": "wait_time"}
"""Raw kinds that say how long, each with that of a command that waits so long."""

KEEP_OUT = "keep out"
"""The constraint that closes zones."""
RULES = ("whenever", "first_time")
"""Raw kinds that begin standing rules."""
STATEMENT_ENDS = frozenset(("newline", "semi", "stop"))
"""Raw kinds at the end of a statement, also where the next word goes on with it."""
LINES = frozenset(("newline", "semi", "indent", "dedent", "define"))
"""Behind these kinds of tokens a statement begins, out of brackets."""
JOINTS = frozenset(("and", "comma", "then"))
"""Raw kinds between the commands of a statement."""
CONSTRAINT_JOINTS = frozenset(("AND", "WIDE_AND", "MEANWHILE", "WIDE_MEANWHILE", "COMMA"))
"""Grouped kinds that may join a constraint to what it holds over."""
FORMS = frozenset((*RULES, "if", "unless", "while", "until", "otherwise", "if_doing", "if_works"))
"""Raw kinds with which a statement may leave out its commands, or run them beside others."""

BEFORE_CONDITIONS = frozenset(("if", "unless", "while", "until", "whenever", "first_time", "as_soon_as", "not"))
"""Raw kinds before a condition; behind them a polite word could be a misspelt one: `wave if now bumped`."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias, TypeGuard

    Said: TypeAlias = "Called | Listed | Assigned | Remembered | NodeCall"
    Value: TypeAlias = "Said | Each | Paced | OnDays | Constraint | Header | str | None"


class Called(Record):
    """A phrase or a name with its arguments, and what `called`, `with` and `giving` say behind a phrase."""

    entry: Entry
    arguments: tuple[tuple[str, str], ...]
    details: NodeCall | None = None


class Listed(Record):
    """A phrase with a list in one slot: arguments for each value. `joiner` is "and", "or", "nor" or "".

    The alternative that succeeds `writes` a slot's value into a key, for which a pronoun stands: (key, type, slot).
    """

    entry: Entry
    arguments: tuple[tuple[tuple[str, str], ...], ...]
    joiner: str
    writes: tuple[str, str, str] | None = None


class Assigned(Record):
    """`operation` is "set", "increase" or "decrease"; `text` is the port text of a value of the type `kind`."""

    key: str
    operation: str
    kind: str
    text: str


class Remembered(Record):
    """What a quantity measures, with the arguments of its slots, under a key."""

    key: str
    entry: Entry
    arguments: tuple[tuple[str, str], ...]


class Paced(Record):
    """A number of rounds with the seconds of each, or between them."""

    rounds: str
    seconds: str


class Constraint(Record):
    """Zones to keep out of, or to stay in: `kind` is "keep out" or "keep in"."""

    kind: str
    zones: tuple[str, ...]


class OnDays(Record):
    """Times of day on some days only: on those one of the conditions `days` holds. `rounds` are -1 for every week."""

    times: str
    days: tuple[Called, ...]
    rounds: int


class Each(Record):
    """The values, all of the type `kind`, that a key goes through."""

    key: str
    kind: str
    values: tuple[str, ...]


class NodeCall(Record):
    """A node by its id, its ports and its name, as they are; `outputs` are the ports that it gives values to."""

    id: str
    ports: tuple[tuple[str, str], ...]
    name: str
    outputs: tuple[str, ...] = ()


class Header(Record):
    """The head of a definition: its name, the words of it, and the words `body` to `last` (exclusive) of its body.

    The name is a pattern: `greet {someone}`. `parameters` are its slots, each with the words as they were written.
    One that `is_quoted` is no phrase, and only known as a subtree.
    """

    name: str
    span: Span
    body: int
    last: int
    parameters: tuple[tuple[str, tuple[str, ...]], ...] = ()
    is_quoted: bool = False


class Token:
    """One token; `start` and `end` are characters of the source.

    The `value` of a command or condition is what it says, of a definition its header, of a loop what it goes through
    or its amount; of a count or duration it is the amount. `role` is what the kind leaves open: the raw kind that a
    form, loop, test or postfix was made of, or an operand that is no phrase, and what a connective means that has
    another meaning between commands. An ELSE begins where what it is tried after ends. `words` are those of its phrase;
    without them they are the ones at its characters, which several words may share where one was put for others.

    Mutable, for grouping learns later what a comma means and which count closes a `repeat`.
    """

    __slots__ = ("end", "kind", "role", "start", "value", "words")

    def __init__(self, kind: str, start: int, end: int, value: Value = None, role: str = "") -> None:
        self.kind = kind
        self.start = start
        self.end = end
        self.value: Value = value
        self.role = role
        self.words: range | None = None

    def copy(self) -> Token:
        """The same token at a second place."""
        copied = Token(self.kind, self.start, self.end, self.value, self.role)
        copied.words = self.words
        return copied

    def __repr__(self) -> str:
        return f"{self.kind}({self.role or self.value or ''})"


def go_on(tokens: list[Token]) -> None:
    """The stops at the end become one token "stop", if they end something: the next word goes on with it."""
    kept = run_start(tokens, len(tokens), ("newline", "semi"))
    if 0 < kept < len(tokens) and tokens[kept - 1].kind not in ("indent", "open", "define"):
        end = tokens[kept - 1].end
        tokens[kept:] = [Token("stop", end, end)]


def statement_start(tokens: Sequence[Token], end: int) -> int:
    """Where the statement begins in which the tokens before one stand."""
    return next((at + 1 for at in reversed(range(end)) if tokens[at].kind in LINES), 0)


def statement_end(tokens: Sequence[Token], at: int) -> int:
    """Where the statement ends in which a token stands."""
    return next((end for end in range(at, len(tokens)) if tokens[end].kind in LINES), len(tokens))


def statement_of(tokens: Sequence[Token], at: int) -> tuple[int, int]:
    """Where the statement begins in which a token stands, and where its last words end."""
    return statement_start(tokens, at), run_start(tokens, statement_end(tokens, at), STATEMENT_ENDS)


def run_start(tokens: Sequence[Token], end: int, kinds: Container[str]) -> int:
    """Where the tokens of some kinds begin that stand right before one; `end` if none does."""
    while end > 0 and tokens[end - 1].kind in kinds:
        end -= 1
    return end


def run_end(tokens: Sequence[Token], at: int, kinds: Container[str]) -> int:
    """Where the tokens of some kinds end that begin at a place; the place itself if none does."""
    while at < len(tokens) and tokens[at].kind in kinds:
        at += 1
    return at


def arguments_of(said: Called | Listed) -> tuple[tuple[tuple[str, str], ...], ...]:
    """The arguments of a phrase, or those for each value of a list."""
    return (said.arguments,) if isinstance(said, Called) else said.arguments


def with_arguments(said: Called | Listed, rows: Sequence[tuple[tuple[str, str], ...]]) -> Called | Listed:
    """The same phrase with other arguments, for each value of a list."""
    changed: Called | Listed = said.replace(arguments=tuple(rows) if isinstance(said, Listed) else rows[0])
    return changed


def with_text(arguments: tuple[tuple[str, str], ...], old: str, new: str) -> tuple[tuple[str, str], ...]:
    """The same arguments with another text wherever one text is given."""
    return tuple((name, new if text == old else text) for name, text in arguments)


def texts_of(said: Called | Listed) -> tuple[str, ...]:
    """The values of a phrase, or of all that a list stands for."""
    return tuple(text for arguments in arguments_of(said) for _, text in arguments)


def drives(value: Value) -> TypeGuard[Called | Listed]:
    """Whether what a token says drives the robot."""
    return isinstance(value, Called | Listed) and MOVES in value.entry.resources


def in_brackets(tokens: Sequence[Token]) -> list[Token]:
    """The same tokens with brackets around them."""
    first, last = tokens[0].start, tokens[-1].end
    return [Token("open", first, first), *tokens, Token("close", last, last)]


def constraint_of(token: Token) -> Constraint | None:
    """What a command, raw or grouped, asks of the others in its statement; None for any other token."""
    value = token.value
    if token.kind not in ("command", "COMMAND") or not isinstance(value, Called | Listed) or not value.entry.constrains:
        return None
    return Constraint(value.entry.constrains, texts_of(value))


def only_constrains(tokens: Sequence[Token]) -> bool:
    """Whether grouped tokens are constraints, and what joins them, alone."""
    return bool(tokens) and all(token.kind in CONSTRAINT_JOINTS or constraint_of(token) is not None for token in tokens)


def keeps_out(token: Token) -> bool:
    """Whether a command closes zones."""
    constraint = constraint_of(token)
    return constraint is not None and constraint.kind == KEEP_OUT


def begins_condition(tokens: Sequence[Token], at: int) -> bool:
    """Whether the operand at a place, brackets left out, is a condition, `not` or a list of conditions."""
    while at < len(tokens) and (tokens[at].kind == "open" or tokens[at].kind in CORRELATIVES):
        at += 1
    return at < len(tokens) and (tokens[at].kind in ("condition", "not") or tokens[at].kind in QUANTIFIERS)


def asks_once(tokens: Sequence[Token], at: int) -> bool:
    """Whether a `once` stands where a condition must follow: behind no command that is done once."""
    return at == 0 or tokens[at - 1].kind not in ("command", "name")


def closed_until(tokens: Sequence[Token]) -> str:
    """Return until when a statement closes a zone: 11:00 for `from 10 am to 11 am, avoid the lab`; "" for others.

    So also for `don't enter the lab before 11 am`.
    """
    at = next((at for at, token in enumerate(tokens[:-1]) if token.kind == "while"), -1)
    condition = tokens[at + 1].value if at >= 0 else None
    if not isinstance(condition, Called) or condition.entry.id != DAYTIME or not any(map(keeps_out, tokens)):
        return ""
    bounds = dict(condition.arguments)
    return bounds.get("at_most", bounds.get("below", ""))
