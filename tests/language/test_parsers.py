"""Both parsers read the same: equal ASTs, spans included, the same texts accepted; and the oracle groups alike."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.parsers import lark_parser, shunting_yard
from btlang.frontends.mission.parsers.build import Builder
from btlang.frontends.mission.parsers.parse_error import ParseError
from btlang.frontends.mission.token import Token
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.tree import ast
from tests.language import grouping_oracle
from tests.language.letters import read
from tests.language.sentences import broken_missions, english, missions
from tests.profiles import searches

BOTH = ("shunting-yard", "lark")
GRAMMAR = Path(__file__).parents[2] / "grammar"


def reading(text: str, parser: str, is_mixed: bool = False) -> ast.Program | tuple[str, ...]:
    """The mission, or the codes of what is wrong."""
    try:
        return read(text, parser, is_mixed)
    except MissionError as error:
        return tuple(problem.code for problem in error.diagnostics)


@searches(80, 30000)
@given(st.one_of(missions, broken_missions()), st.booleans())
@example("a repeat until p NL", False)
@example("not ( p ) NL", False)
@example("a and not ( p or q ) NL", False)
def test_parsers_agree(words: str, is_mixed: bool) -> None:
    shunted, larked = (reading(english(words), parser, is_mixed) for parser in BOTH)
    assert shunted == larked
    if isinstance(shunted, ast.Program):
        assert _spans(shunted) == _spans(larked)  # type: ignore[arg-type]
        assert all(span[0] < span[1] for span in _spans(shunted))


@searches(60, 5000)
@given(missions, st.sampled_from([".", ";", "!", " ."]))
@example("a NL otherwise b NL", ".")
@example("if p : NL IN a NL DE NL otherwise : NL IN b NL DE NL", ".")
def test_a_stop_at_the_end_of_a_line_says_nothing(words: str, stop: str) -> None:
    text = english(words)
    stopped = "\n".join(line if not line.strip() or line.endswith(":") else line + stop for line in text.split("\n"))
    for parser in BOTH:
        read, plain = reading(stopped, parser), reading(text, parser)
        if isinstance(plain, ast.Program):
            assert isinstance(read, ast.Program)
            assert _shape(read) == _shape(plain)


def _shape(value: object) -> object:
    """A syntax tree without the places of its parts."""
    if isinstance(value, tuple):
        return tuple(map(_shape, value))
    if not isinstance(value, Record):
        return value
    return type(value), [(name, _shape(getattr(value, name))) for name in value.fields if not name.endswith("span")]


def _spans(mission: ast.Program) -> list[tuple[int, int]]:
    found, stack = [], ast.parts(mission)
    while stack:
        node = stack.pop()
        found.append((node.span.start, node.span.end))
        stack += ast.parts(node)
    return found


_ROLES = {"COMMAND": "nothing", "CONDITION": "nothing", "POSTFIX": "count", "LOOP": "try"}
_condition = st.recursive(
    st.just("CONDITION"),
    lambda c: st.one_of(
        c.map("NOT {}".format), c.map("COND_OPEN {} COND_CLOSE".format), st.tuples(c, c).map(" COND_AND ".join)
    ),
    max_leaves=3,
)
_command = st.recursive(
    st.just("COMMAND"),
    lambda c: st.one_of(
        st.tuples(c, st.sampled_from(["OR_ELSE", "WIDE_AND", "THEN", "AFTER", "OR", "AND"]), c).map(" ".join),
        c.map("OPEN {} CLOSE".format),
        st.tuples(c, c).map("OPEN {0[0]} SEMI {0[1]} CLOSE".format),
        c.map("{} POSTFIX".format),
        st.tuples(_condition, c).map("FORM {0[0]} DO {0[1]} END".format),
        st.tuples(_condition, c, c).map("FORM {0[0]} DO {0[1]} ELSE {0[2]} END".format),
        st.tuples(c, _condition).map("{0[0]} AFTER_FORM {0[1]} END".format),
        st.tuples(c, c).map("OPEN {0[0]} IF_WORKS {0[1]} END CLOSE".format),
        st.tuples(c, c, c).map("OPEN {0[0]} IF_WORKS {0[1]} ELSE {0[2]} END CLOSE".format),
        st.tuples(c, c).map("LOOP {0[0]} ELSE {0[1]} END".format),
        st.tuples(c, _condition).map("LOOP {0[0]} STOP {0[1]} END".format),
        _condition.map("TEST {} END".format),
    ),
    max_leaves=6,
)


@searches(80, 10000)
@given(_command)
def test_each_parser_takes_all_that_the_matching_stage_may_write(kinds: str) -> None:
    """Also token streams that no sentence was drawn for."""
    tokens = [
        Token(kind, i, i + 1, "2" if kind == "POSTFIX" else None, _ROLES.get(kind, "if"))
        for i, kind in enumerate(kinds.split())
    ]
    build = Builder(Source("x" * len(tokens)))
    assert shunting_yard.parse(tokens, build) == lark_parser.parse(tokens, build)


@pytest.mark.parametrize(
    "kinds", ["COMMAND COMMAND", "THEN", "COMMAND THEN", "OPEN COMMAND", "COMMAND CLOSE", "LOOP END", ""]
)
def test_each_parser_rejects_tokens_that_are_no_mission(kinds: str) -> None:
    tokens = [
        Token(kind, i, i + 1, "2" if kind == "POSTFIX" else None, _ROLES.get(kind, "if"))
        for i, kind in enumerate(kinds.split())
    ]
    for parser in (shunting_yard, lark_parser):
        with pytest.raises(ParseError):
            parser.parse(tokens, Builder(Source("")))


_MIXED = {"c": (False, frozenset(["voice"])), "d": (True, frozenset()), "e": (False, frozenset(["base"]))}
"""What the oracle knows of the letters that are mixed."""


def oracle(words: str, is_mixed: bool) -> object:
    """The oracle's tree in the form of `ours`, None where it rejects the words."""
    try:
        return _from_oracle(grouping_oracle.parse(grouping_oracle.lex(words), _MIXED if is_mixed else {}))
    except (SyntaxError, IndexError):
        return None


def _from_oracle(tree: object) -> object:
    if not isinstance(tree, tuple):
        return None if tree == "None" else tree
    kind, *rest = tree
    if kind in ("S", "F", "P"):
        return (kind, *map(_from_oracle, rest[0]))
    if kind == "REP" and rest[0] in ("UNTIL", "WHILE"):
        return (rest[0], _from_oracle(rest[1]), _from_oracle(rest[2]), None)
    if kind == "REP":
        return ("FOR", _from_oracle(rest[1])) if rest[0] == "DUR" else ("REP", rest[0] != "inf", _from_oracle(rest[1]))
    if kind == "IFP":
        return ("TRY", _from_oracle(rest[0]), None)
    return (kind, *map(_from_oracle, rest))


_WORDS = dict(zip("UVWXY", "abcde", strict=True))


def ours(node: ast.Ast | None) -> object:
    """An AST in the oracle's form, which knows no brackets and no amounts."""
    match node:
        case None:
            return None
        case ast.Phrase():
            return _WORDS.get(node.entry.id, node.entry.id.lower())
        case ast.Chain():
            letter = {"sequence": "S", "all": "S", "fallback": "F", "any": "F", "parallel": "P"}[node.operator]
            return (letter, *map(ours, node.items))
        case ast.If():
            kind = "UNLESS" if node.negated else "IF"
            return (kind, ours(node.condition), ours(node.body), ours(node.otherwise))
        case ast.While():
            kind = "UNTIL" if node.negated else "WHILE"
            return (kind, ours(node.condition), ours(node.body), ours(node.otherwise))
        case ast.Try():
            return ("TRY", ours(node.body), ours(node.otherwise))
        case ast.Repeat():
            return ("REP", node.rounds != "-1", ours(node.body))
    kinds = {"Not": "Not", "Check": "Check", "WaitUntil": "Wait", "Provided": "PROV"}
    kind = kinds.get(type(node).__name__, type(node).__name__.upper())
    return (kind, *map(ours, ast.parts(node)))


@searches(80, 30000)
@given(st.one_of(missions, broken_missions()), st.booleans())
@example("a and ( c and e ) NL", True)
@example("a then b and d , and e NL", True)
@example("every5 , a and d NL", True)
@example("( repeat a ) and d NL", True)
@example("a and b or c and e NL", True)
def test_groups_as_the_oracle_does(words: str, is_mixed: bool) -> None:
    """The language takes a little more than the oracle (`then` at the start, empty lines); never anything else."""
    expected = oracle(words, is_mixed)
    if expected is None:
        return
    mission = reading(english(words), "shunting-yard", is_mixed)
    assert isinstance(mission, ast.Program), mission
    assert ours(mission.body) == expected


def test_a_grammar_with_a_conflict_is_refused() -> None:
    from lark.exceptions import GrammarError

    make = runpy.run_path(str(GRAMMAR / "make_tables.py"))
    with pytest.raises(GrammarError, match="conflict"):
        make["tables"]("mission: mission A mission | A\n%declare A\n")
