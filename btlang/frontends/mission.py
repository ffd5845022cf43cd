"""A mission in English to its AST: words, tokens, matching, one of the parsers."""

from __future__ import annotations

from importlib import import_module

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.build import Builder
from btlang.frontends.lexer import Lexer
from btlang.frontends.matching import Matcher
from btlang.frontends.respelling import with_respellings
from btlang.record import Record
from btlang.text.source import Source, Span
from btlang.tree.ast import Ast, Definition, Mission
from btlang.vocabulary.vocabulary import Vocabulary

PARSERS = {
    "shunting-yard": "btlang.frontends.shunting_yard",
    "lark": "btlang.frontends.lark_parser",  # imported only when asked for: it costs more than a whole check
}
DEFAULT_PARSER = "shunting-yard"


class Reading(Record):
    """What a text says, and the warnings on the way."""

    mission: Mission
    warnings: tuple[Diagnostic, ...]


def read_mission(source: Source, vocabulary: Vocabulary, parser: str = DEFAULT_PARSER, suggest: bool = True) -> Reading:
    """Raises MissionError with all that is wrong with the text; ValueError for an unknown parser.

    With `suggest` False no corrections are tried, which takes time.
    """
    if parser not in PARSERS:
        raise ValueError(f"no parser '{parser}'; there are {', '.join(PARSERS)}")
    lexer = Lexer(source, vocabulary)
    matcher = Matcher(source, lexer.tokens, lexer.conditions, vocabulary.word)
    problems = lexer.problems + matcher.problems
    if not lexer.tokens and not lexer.facts and not problems:
        problems = [diagnostic("BT005", Span(source, 0, 0), example="move forward 1 m")]
    if any(problem.is_error for problem in problems):
        raise MissionError(with_respellings(lexer, problems) if suggest else problems)
    parse = import_module(PARSERS[parser]).parse
    build = Builder(source)
    body: Ast | None = None
    definitions: dict[str, Definition] = {}
    for unit in matcher.units:
        if unit.header is None:
            body = parse(unit.tokens, build) if unit.tokens else None
            continue
        inner = parse(unit.tokens, build)
        span = Span(source, unit.header.span.start, inner.span.end)
        definitions.pop(unit.header.name, None)  # a later definition replaces an earlier one
        name, types = unit.header.name, lexer.definitions.types[unit.header.body]
        definitions[name] = Definition(name, types, inner, unit.header.span, span)
    facts = {fact.name: fact for fact in lexer.facts}  # a later fact replaces an earlier one
    mission = Mission(body, tuple(definitions.values()), Span(source, 0, len(source.text)), tuple(facts.values()))
    return Reading(mission, tuple(problems))
