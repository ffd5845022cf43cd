"""Random syntax trees over the letters vocabulary, for hypothesis: also those that no sentence was drawn for."""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import strategies as st

from btlang.text.source import Source, Span
from btlang.tree import ast
from btlang.vocabulary.entry import Entry
from tests.language.letters import COMMANDS, CONDITIONS, letters

SPAN = Span(Source("x"), 0, 1)
NAMES = ("big dance", "one more round")

Trees = st.SearchStrategy[ast.Ast]


def phrase(letter: str) -> ast.Ast:
    entry = letters().entry(letter.upper())
    assert entry is not None
    return ast.Phrase(entry, (), SPAN)


def either(*letters: str) -> ast.Ast:
    return ast.Chain("fallback", tuple(map(phrase, letters)), False, SPAN)


def _entry(node_id: str) -> Entry:
    entry = letters().entry(node_id)
    assert entry is not None
    return entry


REMEMBERED = ast.Remember("level", _entry("Battery"), (), SPAN)


def and_remember(letter: str) -> ast.Ast:
    twice = ast.Repeat("2", REMEMBERED, SPAN)
    return ast.Chain("parallel", (phrase(letter), REMEMBERED, twice), False, SPAN)


def _chain(operator: str, items: list[ast.Ast], bracketed: bool) -> ast.Ast:
    """An equal chain inside it has brackets, as the parsers make it."""
    kept = [
        item.replace(bracketed=True) if isinstance(item, ast.Chain) and item.operator == operator else item
        for item in items
    ]
    return ast.Chain(operator, tuple(kept), bracketed, SPAN)


def _chains(operators: list[str], inner: Trees) -> Trees:
    return st.builds(_chain, st.sampled_from(operators), st.lists(inner, min_size=2, max_size=3), st.booleans())


def _at_least(inner: Trees) -> Trees:
    """So many of two or three."""
    items = st.lists(inner, min_size=2, max_size=3).map(tuple)
    return st.builds(ast.AtLeast, st.integers(1, 2), items, st.just(SPAN))


_texts = st.sampled_from(
    ["{count}", "it is {count}", "it's {count} {{m}}", "hello", "{{count}}", "{gap_to_wall} {count}"]
)
_amounts = st.sampled_from(["3", "0.5", "{count}"])
_span = st.just(SPAN)
_limits = st.dictionaries(st.sampled_from(["below", "above", "equal"]), _amounts, min_size=1, max_size=1)
compared: Trees = st.one_of(
    st.builds(ast.Compared, st.just("count"), st.just("number"), _limits.map(lambda d: tuple(d.items())), _span),
    st.just(ast.Phrase(_entry("Battery"), (("below", "{level}"),), SPAN)),
)
valued: Trees = st.one_of(
    st.builds(
        ast.Assign,
        st.just("count"),
        st.sampled_from(["set", "increase", "decrease"]),
        st.just("number"),
        _amounts,
        _span,
    ),
    st.builds(ast.Assign, st.just("mood"), st.just("set"), st.just("text"), _texts, _span),
    st.just(REMEMBERED),
    _texts.map(lambda text: ast.Phrase(_entry("Murmur"), (("text", text),), SPAN)),
    st.builds(ast.Wait, st.just("{pause}"), _span),
)
"""Commands that work with values; `defined` gives each of these a value."""

_NUMBER = "number"
defined = (
    ast.Assign("count", "set", _NUMBER, "0", SPAN),
    ast.Assign("gap_to_wall", "set", "length", "0.5", SPAN),
    ast.Assign("mood", "set", "text", "fine", SPAN),
    ast.Assign("pause", "set", "duration", "2", SPAN),
    ast.Assign("lunch", "set", "time_of_day", "12:00", SPAN),
    ast.Assign("rounds", "set", _NUMBER, "2", SPAN),
    REMEMBERED,
)

conditions: Trees = st.recursive(
    st.one_of(st.sampled_from(CONDITIONS).map(phrase), st.sampled_from(CONDITIONS).map(phrase), compared),
    lambda inner: st.one_of(_chains(["all", "any"], inner), st.builds(ast.Not, inner, st.just(SPAN)), _at_least(inner)),
    max_leaves=4,
)
_seconds = st.sampled_from(["5", "0.2", "90", "{pause}"])
_times = st.sampled_from(["00:00", "18:30", "{lunch}"])
_pause = st.sampled_from(["", "5", "{pause}"])
_lasting = st.one_of(conditions, st.builds(ast.Held, conditions, _seconds, _span))
_rounds = st.sampled_from(["-1", "1", "2", "3", "{rounds}"])
_leaves: Trees = st.one_of(
    st.sampled_from(COMMANDS).map(phrase),
    st.sampled_from(COMMANDS).map(phrase),
    valued,
    st.builds(ast.Fail, _span),
    st.builds(ast.Nothing, _span),
    st.one_of(st.builds(ast.Wait, _seconds, _span), st.builds(ast.WaitTime, _times, _span)),
    st.builds(ast.Check, conditions, _span),
    st.builds(ast.WaitUntil, _lasting, _span),
)


def _for_each(values: tuple[str, str, tuple[str, ...]], body: ast.Ast) -> ast.Ast:
    """Something in the body says the value."""
    says = ast.Phrase(_entry("Murmur"), (("text", "{item} of {count}"),), SPAN)
    return ast.ForEach(*values, _chain("sequence", [says, body], False), SPAN)


def _forms(inner: Trees) -> Trees:
    perhaps = st.one_of(st.none(), inner)
    timed: list[Callable[..., ast.Ast]] = [ast.Within, ast.For, ast.UpTo, ast.Delay]
    return st.one_of(
        _chains(["sequence", "fallback", "parallel"], inner),
        st.builds(ast.If, st.booleans(), conditions, inner, perhaps, _span),
        st.builds(ast.While, st.booleans(), conditions, inner, perhaps, _span),
        st.builds(ast.Provided, conditions, inner, _span),
        st.builds(ast.Repeat, _rounds, inner, _span),
        st.builds(ast.IfWorks, inner, inner, perhaps, _span),
        st.builds(ast.StopWhen, conditions, inner, _span),
        st.builds(ast.Retry, _rounds, inner, _pause, _span),
        st.builds(ast.Every, _seconds, inner, st.one_of(st.just(""), _rounds), _span),
        st.builds(ast.Apart, _seconds, inner, st.sampled_from(["-1", "1", "3"]), _span),
        st.builds(ast.Try, inner, perhaps, _span),
        *(st.builds(form, _seconds, inner, _span) for form in timed),
        *(st.builds(form, _times, inner, _span) for form in (ast.UntilTime, ast.ByTime)),
        st.builds(
            _for_each, st.sampled_from([("item", _NUMBER, ("1", "{count}")), ("item", "text", ("a b", "c"))]), inner
        ),
    )


commands: Trees = st.recursive(_leaves, _forms, max_leaves=8)


def _rule_block(rules: list[ast.Ast], work: list[ast.Ast]) -> ast.Ast:
    return ast.Repeat("2", _chain("sequence", [*rules, *work], True), SPAN)


def _about(inner: Trees) -> Trees:
    """Forms round one that holds standing rules, as lines and blocks can say them."""
    form = inner.map(lambda node: ast.Repeat("3", node, SPAN) if isinstance(node, ast.Chain) else node)
    perhaps = st.one_of(st.none(), commands, inner)
    few = st.lists(commands, max_size=2)
    some = st.lists(commands, min_size=1, max_size=2)
    joined = st.one_of(
        st.builds(lambda left, node, right: [*left, node, *right], few, form, some),
        st.builds(lambda left, node: [*left, node], some, form),
    )
    return st.one_of(
        st.builds(_chain, st.sampled_from(["sequence", "fallback", "parallel"]), joined, st.booleans()),
        st.builds(ast.If, st.booleans(), conditions, inner, perhaps, _span),
        st.builds(ast.While, st.booleans(), conditions, commands, inner, _span),
        st.builds(ast.Repeat, _rounds, inner, _span),
        st.builds(ast.Retry, _rounds, inner, _pause, _span),
        st.builds(ast.Try, st.one_of(inner, commands), inner, _span),
        st.builds(ast.Try, inner, st.none(), _span),
        st.builds(ast.Every, _seconds, inner, st.one_of(st.just(""), _rounds), _span),
        st.builds(ast.Apart, _seconds, inner, st.sampled_from(["-1", "2"]), _span),
        *(st.builds(form, _times, inner, _span) for form in (ast.UntilTime, ast.ByTime)),
    )


_rules = st.builds(ast.Whenever, _lasting, commands, st.booleans(), _span)
ruled: Trees = st.recursive(
    st.builds(_rule_block, st.lists(_rules, min_size=1, max_size=2), st.lists(commands, min_size=1, max_size=2)),
    _about,
    max_leaves=3,
)
"""Commands in which standing rules hold."""


@st.composite
def missions(draw: st.DrawFn) -> ast.Program:
    """Commands, and up to two definitions that they use."""
    bodies = draw(st.lists(st.one_of(commands, conditions, ruled), max_size=len(NAMES)))
    body = draw(st.one_of(commands, commands, ruled))
    definitions = [ast.Definition(name, (), inner, SPAN, SPAN) for name, inner in zip(NAMES, bodies, strict=False)]
    used = [_use(name, inner) for name, inner in zip(NAMES, bodies, strict=False)]
    if draw(st.booleans()):
        greeting = ast.Phrase(_entry("Murmur"), (("text", "dear {who} {count}"),), SPAN)
        body_of = _chain("sequence", [greeting, ast.Wait("{time}", SPAN)], False)
        parameters = (("who", "text"), ("time", "duration"))
        definitions.append(ast.Definition("greet {who} for {time}", parameters, body_of, SPAN, SPAN))
        arguments = (("who", draw(_texts)), ("time", draw(_seconds)))
        used.append(ast.Repeat("2", ast.Name("greet {who} for {time}", arguments, SPAN), SPAN))
    if used and not isinstance(body, ast.Chain):
        body = _chain(draw(st.sampled_from(["sequence", "fallback", "parallel"])), [*used, body], False)
    elif used:
        body = _chain("sequence", [*used, ast.Repeat("2", body, SPAN)], False)
    items = list(body.items) if isinstance(body, ast.Chain) and body.operator == "sequence" else [body]
    body = _chain("sequence", [*defined, *items], False)
    rules = draw(st.lists(_rules, max_size=2))
    if rules:
        items = list(body.items) if isinstance(body, ast.Chain) and body.operator == "sequence" else [body]
        body = _chain("sequence", [*rules, *items], False)
    return ast.Program(body, tuple(definitions), SPAN)


def _use(name: str, body: ast.Ast) -> ast.Ast:
    used = ast.Name(name, (), SPAN)
    chain = isinstance(body, ast.Chain) and body.operator in ("all", "any")
    phrase = isinstance(body, ast.Phrase) and body.entry.sort == "condition"
    is_condition = chain or phrase or isinstance(body, ast.Not | ast.AtLeast | ast.Compared)
    return ast.Check(used, SPAN) if is_condition else ast.Repeat("2", used, SPAN)
