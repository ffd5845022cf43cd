"""Grouped tokens and parts to AST nodes: what both parsers call, so that only the grouping is theirs to find."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.frontends.mission.token import (
    Assigned,
    Called,
    Constraint,
    Each,
    Listed,
    NodeCall,
    OnDays,
    Paced,
    Remembered,
    Token,
)
from btlang.text.source import Source, Span
from btlang.tree.ast import (
    Apart,
    Assign,
    Ast,
    AtLeast,
    ByTime,
    Chain,
    Check,
    Compared,
    Constrained,
    Delay,
    Every,
    Exact,
    Fail,
    For,
    ForEach,
    Held,
    If,
    IfWorks,
    Name,
    Named,
    Not,
    Nothing,
    Phrase,
    Provided,
    Remember,
    Repeat,
    Retry,
    StopWhen,
    Try,
    UntilTime,
    UpTo,
    Wait,
    WaitForever,
    WaitTime,
    WaitUntil,
    Whenever,
    While,
    Within,
)
from btlang.tree.catalogue import takes_one_child
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.language_tables import CONNECTIVES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.mission.token import Value

CHAINS = {
    "SEMI": "sequence", "BLOCK_AND": "parallel", "BLOCK_OR": "fallback", "BLOCK_CHILD": "children",
    "OR_ELSE": "fallback", "WIDE_AND": "and", "WIDE_MEANWHILE": "parallel",
    **{role.upper(): operator for role, operator in CONNECTIVES.items()},
    "COND_OR_ELSE": "any", "COND_WIDE_AND": "all", "COND_OR": "any", "COND_AND": "all",
}  # fmt: skip
"""What each connective makes of its operands."""


class Builder:
    """Makes the nodes of one source."""

    def __init__(self, source: Source) -> None:
        self.source = source

    def span(self, start: int, end: int) -> Span:
        return Span(self.source, start, end)

    def leaf(self, token: Token) -> Ast:
        """COMMAND or CONDITION."""
        span, value = Span(self.source, token.start, token.end), token.value
        if type(value) is Called:
            return _called(value.entry, value.arguments, span, value.details)
        if token.role == "wait":
            return Wait(_amount(token), span)
        if token.role == "wait_time":
            return WaitTime(_amount(token), span)
        if token.role == "wait_forever":
            return WaitForever(span)
        if token.role:
            return Nothing(span) if token.role == "nothing" else Fail(span)
        return self._stated(value, token.kind == "CONDITION", span)

    def _stated(self, value: Value, is_condition: bool, span: Span) -> Ast:
        if isinstance(value, Assigned):
            return Assign(value.key, value.operation, value.kind, value.text, span)
        if isinstance(value, Remembered):
            return Remember(value.key, value.entry, value.arguments, span)
        if isinstance(value, NodeCall):
            return Exact(value.id, value.ports, value.name, (), is_condition, span, value.outputs)
        assert isinstance(value, Listed)
        operators = ("any", "all") if is_condition else ("fallback", "sequence")
        items = tuple(_alternative(value, arguments, span) for arguments in value.arguments)
        return Chain(operators[value.joiner != "or"], items, True, span)

    def chain(self, operator: str, items: Sequence[Ast], start: int, end: int) -> Ast:
        """Operands of one kind of connective, flat: equal chains without brackets melt into it."""
        if len(items) == 1:
            return items[0]
        flat: list[Ast] = []
        for item in items:
            if type(item) is Chain and item.operator == operator and not item.bracketed:
                flat += item.items
            else:
                flat.append(item)
        return Chain(operator, tuple(flat), False, Span(self.source, start, end))

    def group(self, inner: Ast, start: int, end: int) -> Ast:
        """A bracket or block keeps a chain apart; round anything else it changes nothing."""
        inner = self.alone(inner)
        if type(inner) is Chain and not inner.bracketed:
            return Chain(inner.operator, inner.items, True, Span(self.source, start, end))
        return inner

    def alone(self, statement: Ast) -> Ast:
        """The only statement of a text or block: a rule that fires once has nothing to interrupt, so it waits."""
        if type(statement) is Whenever and statement.once:
            span = statement.span
            return self.form("as_soon_as", statement.condition, statement.body, None, span.start, span.end)
        return statement

    def quantified(self, opener: Token, inner: Ast, end: int) -> Ast:
        """COND_OF items COND_CLOSE; a list of values has been one of them."""
        span = Span(self.source, opener.start, end)
        assert isinstance(inner, Chain)
        items = inner.items
        match opener.role:
            case "neither":
                return Chain("all", tuple(Not(item, item.span) for item in items), True, span)
            case "at_least_of":
                return AtLeast(int(_amount(opener)), items, span)
        chain = Chain("all" if opener.role in ("all_of", "not_both") else "any", items, True, span)
        return Not(chain, span) if opener.role in ("none_of", "not_both") else chain

    def negation(self, token: Token, condition: Ast) -> Ast:
        return Not(condition, Span(self.source, token.start, condition.span.end))

    def postfix(self, body: Ast, token: Token) -> Ast:
        """POSTFIX."""
        span = Span(self.source, body.span.start, token.end)
        if isinstance(token.value, Paced):
            return self._paced(token.role, token.value, body, span)
        return self._counted(token, body, span)

    def loop(self, opener: Token, body: Ast, otherwise: Ast | None, end: int, tried_end: int) -> Ast:
        """LOOP body [ELSE otherwise] END; `tried_end` is where the part before `otherwise` ends."""
        kind, value = opener.role, opener.value
        span = Span(self.source, opener.start, end)
        if isinstance(value, Each):
            return ForEach(value.key, value.kind, value.values, body, span)
        if isinstance(value, Constraint):
            return Constrained(value.kind, value.zones, body, span)
        if isinstance(value, NodeCall):
            children = body.items if isinstance(body, Chain) and body.operator == "children" else (body,)
            if len(children) > 1 and takes_one_child(value.id):
                children = (Chain("sequence", children, True, body.span),)
            return Exact(value.id, value.ports, value.name, children, False, span, value.outputs)
        if kind == "label":
            return _named(_amount(opener), body, span)
        if kind == "try":
            return Try(body, otherwise, span)
        tried_span = span if otherwise is None else Span(self.source, opener.start, tried_end)
        if isinstance(value, Paced):
            tried = self._paced(kind, value, body, tried_span)
        else:
            tried = self._counted(opener, body, tried_span)
        is_inside = _outlasts(body, value) or (isinstance(body, While) and self._is_next(opener.end, body))
        if kind == "every" and is_inside and isinstance(body, For | UntilTime | While):
            inner: Ast = tried.replace(body=body.body, span=Span(self.source, body.body.span.start, span.end))
            return body.replace(body=inner, span=span)  # type: ignore[no-any-return]
        return tried if otherwise is None else Try(tried, otherwise, span)

    def _is_next(self, at: int, form: While) -> bool:
        """Whether the words of a form begin there, before its body: `every 5 s until bumped, wave`."""
        is_fronted = form.condition.span.start < form.body.span.start
        between = self.source.text[at : form.span.start]
        return is_fronted and form.span.start < form.body.span.start and not between.strip()

    def fronted(self, kind: str, head: Ast, body: Ast, start: int, end: int) -> Ast:
        """LOOP head DO body END: `before`, `after`, `while` and `if` with a command as their head."""
        parts = (head, body) if kind in ("after", "if_doing") else (body, head)
        operator = {"while_doing": "parallel", "if_doing": "fallback"}.get(kind, "sequence")
        return self.group(self.chain(operator, parts, start, end), start, end)

    def _paced(self, kind: str, pace: Paced, body: Ast, span: Span) -> Ast:
        if kind == "retry":
            return Retry(pace.rounds, body, pace.seconds, span)
        return (Every if kind == "every" else Apart)(pace.seconds, body, pace.rounds, span)

    def _counted(self, token: Token, body: Ast, span: Span) -> Ast:
        kind, amount = token.role, _amount(token)
        if kind in ("repeat", "count"):
            return Repeat(amount or "-1", body, span)
        if kind == "retry" and type(body) is Every and not body.rounds and _is_behind(body):
            return Retry(amount or "-1", body.body, body.seconds, span)  # `try to A every 10 s, up to 3 times`
        if kind == "retry":
            return Retry(amount or "-1", body, "", span)
        if kind == "if_possible":
            return Try(body, None, span)
        if kind == "every" and type(body) is Retry and not body.pause and body.span.end <= token.start:
            return Retry(body.attempts, body.body, amount, span)  # `try to A up to 3 times, every 10 s`
        if kind == "every":
            return Every(amount, body, "", span)
        if kind in ("at", "every_day"):
            waiting = self._waiting(token)
            once = self.chain("sequence", (waiting, body), span.start, span.end)
            rounds = _rounds(token)
            return once if rounds == 1 else Repeat(str(rounds), once, span)
        timed = {
            "for": For, "up_to": UpTo, "within": Within, "delay": Delay, "until_time": UntilTime, "by_time": ByTime,
        }[kind]  # fmt: skip
        return timed(amount, body, span)

    def _waiting(self, token: Token) -> Ast:
        """Until the next of some times of day, on some days alone where the token says so."""
        said, span = token.value, self.span(token.start, token.end)
        if not isinstance(said, OnDays):
            return WaitTime(_amount(token), span)
        end = self.span(token.end, token.end)
        days = tuple(_called(day.entry, day.arguments, end) for day in said.days)
        asked = Check(days[0] if len(days) == 1 else Chain("any", days, True, end), end)
        return Retry("-1", Chain("sequence", (WaitTime(said.times, span), asked), True, span), "", span)

    def held(self, condition: Ast, token: Token) -> Ast:
        """COND_HELD."""
        return Held(condition, _amount(token), self.span(condition.span.start, token.end))

    def form(self, kind: str, condition: Ast, body: Ast, otherwise: Ast | None, start: int, end: int) -> Ast:
        """A form with a condition, before or after a command; of `if_works` the condition is a command."""
        span = Span(self.source, start, end)
        if kind in ("whenever", "first_time"):
            return Whenever(condition, body, kind == "first_time", span)
        if kind == "as_soon_as":
            return self.chain("sequence", (WaitUntil(condition, condition.span), body), start, end)
        if kind == "if_works":
            return IfWorks(condition, body, otherwise, span)
        if kind == "stop_when":
            return StopWhen(condition, body, span)
        if kind == "provided":
            return Provided(condition, body, span)
        if kind in ("if", "unless"):
            node = If(kind == "unless", condition, body, otherwise, span)
            return _with_both(node, body) if otherwise is not None and type(body) is If else node
        return While(kind == "until", condition, body, otherwise, span)

    def test(self, opener: Token, condition: Ast, end: int) -> Ast:
        """check, wait until."""
        span = Span(self.source, opener.start, end)
        if opener.role == "check":
            return Check(condition, span)
        waiting = WaitUntil(condition, span)
        return UpTo(_amount(opener), waiting, span) if opener.role == "wait_up_to" else waiting


def _is_behind(form: Every) -> bool:
    """Whether the words of a form stand behind its command."""
    return form.span.start == form.body.span.start


def _with_both(outer: If, inner: If) -> If:
    """`if A, X, but only if B. Otherwise Y`: what comes otherwise is done if either condition isn't so."""
    if inner.otherwise is not None or inner.span.end > outer.condition.span.start:
        return outer
    asked = [Not(each.condition, each.condition.span) if each.negated else each.condition for each in (inner, outer)]
    both = Chain("all", tuple(asked), False, Span(outer.span.source, asked[0].span.start, asked[1].span.end))
    return If(False, both, inner.body, outer.otherwise, outer.span)


def _outlasts(body: Ast, pace: object) -> bool:
    """Whether a command lasts longer than the pace before it: `every 10 min wave for an hour`, `... until 6 pm`."""
    seconds = pace.seconds if isinstance(pace, Paced) else pace
    try:
        return isinstance(body, UntilTime) or (isinstance(body, For) and float(body.seconds) >= float(str(seconds)))
    except ValueError:
        return False  # a value of the mission


def _named(name: str, said: Ast, span: Span) -> Ast:
    """A command with its name; a leaf or a node that is said by its id has it itself."""
    leaf = said.condition if isinstance(said, Check) else said
    if not isinstance(leaf, Phrase | Exact) or leaf.name:
        return Named(name, said, span)
    if isinstance(said, Check):
        return Check(leaf.replace(name=name), span)
    made: Ast = leaf.replace(name=name, span=span)
    return made


def _rounds(token: Token) -> int:
    """How often what is done at some times of day is done: -1 for ever."""
    if isinstance(token.value, OnDays):
        return token.value.rounds
    return len(_amount(token).split(";")) if token.role == "at" else -1


def _amount(token: Token) -> str:
    """The count or duration of a token, "" where it has none."""
    return token.value if isinstance(token.value, str) else ""


def _alternative(listed: Listed, arguments: tuple[tuple[str, str], ...], span: Span) -> Ast:
    """One of a list, which writes down which one it was where that is spoken of."""
    said = _called(listed.entry, arguments, span)
    if listed.writes is None:
        return said
    key, kind, slot = listed.writes
    return Chain("sequence", (said, Assign(key, "set", kind, dict(arguments)[slot], span)), True, span)


def _called(entry: Entry, arguments: tuple[tuple[str, str], ...], span: Span, details: NodeCall | None = None) -> Ast:
    if entry.sort == "name":
        return Name(entry.id, arguments, span)
    if entry.sort == "value":
        return Compared(entry.id, entry.measures, arguments, span)
    if details is not None:
        return Phrase(entry, arguments, span, details.name, details.ports, details.outputs)
    return Phrase(entry, arguments, span)
