"""A mission in English to its AST: words, tokens, matching, one of the parsers."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.diagnostics.files import MOST_DEEP, TOO_DEEP, included_path, read_included, real_path
from btlang.frontends.mission.grouping.grouping import Grouped, group
from btlang.frontends.mission.parsers.build import Builder
from btlang.frontends.mission.symbols.includes import Included
from btlang.frontends.mission.symbols.names import Load
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.frontends.mission.whole_rules import whole_rules, with_rules_first
from btlang.support.record import Record
from btlang.text.source import Source, Span
from btlang.tree.answers import with_answers
from btlang.tree.ast import Ast, Definition, Nothing, Program
from btlang.tree.conjunctions import resolve
from btlang.tree.endless import with_ends
from btlang.tree.rounds import with_rounds
from btlang.tree.sums import with_sums
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import Known

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    ErrorsOf: TypeAlias = Callable[[Program, Lexicon], Iterable[Diagnostic]]

PARSERS = {
    "shunting-yard": "btlang.frontends.mission.parsers.shunting_yard",
    "lark": "btlang.frontends.mission.parsers.lark_parser",  # imported only when asked for
}
DEFAULT_PARSER = "shunting-yard"


class Reading(Record):
    """What a text says, and the warnings on the way."""

    mission: Program
    warnings: tuple[Diagnostic, ...]


def read_mission(
    source: Source,
    vocabulary: Lexicon,
    parser: str = DEFAULT_PARSER,
    known: Mapping[str, Known] | None = None,
    errors_of: ErrorsOf | None = None,
) -> Reading:
    """Reads a text and those that it includes; `known` are values that it may use though it does not set them.

    `errors_of` says what is wrong with a mission that can be read; without it no corrections are tried of one that
    cannot, which takes time. Raises MissionError with all that is wrong, and ValueError for an unknown parser.
    """
    if parser not in PARSERS:
        raise ValueError(f"no parser '{parser}'; there are {', '.join(PARSERS)}")
    reader = _Reader(vocabulary, parser, known or {}, errors_of)
    included = reader.read(source, (real_path(source.name),))
    if any(problem.is_error for problem in reader.problems):
        raise MissionError(reader.problems)
    mission, said = _whole(included.mission, vocabulary)
    return Reading(mission, (*reader.problems, *said))


def _whole(mission: Program, vocabulary: Lexicon) -> tuple[Program, list[Diagnostic]]:
    """A mission with what takes all of it to know, and what there is to say. Raises MissionError (BT049, BT144)."""
    looped = with_rounds(mission, vocabulary)
    summed, lost = with_sums(with_ends(looped), vocabulary)
    answered, problems = with_answers(summed)
    if problems or lost:
        raise MissionError([*problems, *lost])
    return resolve(answered, vocabulary)


def lexed(source: Source, vocabulary: Lexicon) -> Lexer:
    """The tokens of a text, with the names of what it includes; nothing is said of what is wrong."""
    reader = _Reader(vocabulary, DEFAULT_PARSER, {}, None)
    return Lexer(source, vocabulary, explain=False, load=reader.loader(source, (real_path(source.name),)))


class _Reader:
    """Reads a text and those that it includes, each once. `problems` are those of all of them."""

    def __init__(
        self, vocabulary: Lexicon, parser: str, known: Mapping[str, Known], errors_of: ErrorsOf | None
    ) -> None:
        self.problems: list[Diagnostic] = []
        self._vocabulary = vocabulary
        self._parser = parser
        self._known = known
        self._errors_of = errors_of
        self._read: dict[str, Included | None] = {}

    def loader(self, source: Source, within: tuple[str, ...]) -> Load:
        """What reads the files that a text includes; `within` are the files that are being read, the text's last."""

        def load(path: str, span: Span) -> Included | None:
            _, real = included_path(path, source)
            if real in within:
                circle = " -> ".join(map(os.path.basename, (*within[within.index(real) :], real)))
                self.problems.append(diagnostic("BT046", span, file=path, circle=circle))
                return None
            if len(within) > MOST_DEEP:
                self.problems.append(diagnostic("BT001", span, file=path, reason=TOO_DEEP))
                return None
            if real not in self._read:
                self._read[real] = self._included(path, source, (*within, real), span)
            return self._read[real]

        return load

    def _included(self, path: str, source: Source, within: tuple[str, ...], span: Span) -> Included | None:
        try:
            return self.read(read_included(path, source), within)
        except MissionError as error:
            for problem in error.diagnostics:
                here = problem.replace(span=span) if problem.code == "BT001" else problem
                self.problems.append(here)
            return None

    def read(self, source: Source, within: tuple[str, ...]) -> Included:
        """The mission; of one that has something wrong only its names, so that their uses are not wrong, too."""
        lexer = Lexer(source, self._vocabulary, load=self.loader(source, within), known=self._known)
        grouped = group(source, lexer.tokens, lexer.conditions, self._vocabulary.word)
        problems = lexer.problems + grouped.problems
        if not lexer.tokens and not lexer.names.ends and not problems:
            problems = [diagnostic("BT005", Span(source, 0, 0), example="move forward 1 m")]
        is_broken = any(problem.is_error for problem in problems)
        if is_broken:
            from btlang.frontends.mission.corrections import corrected  # most missions need none

            errors_of = self._errors if self._errors_of is not None else None
            from btlang.frontends.mission.explanations.times import without_misled_times

            problems = without_misled_times(corrected(lexer, problems, errors_of))
            if lexer.text.unreadable:
                from btlang.frontends.mission.comparison_signs import explain_signs

                problems = explain_signs(lexer, problems, errors_of)
        self.problems += problems
        if is_broken:
            return Included(_names_only(source, lexer), frozenset(lexer.conditions), lexer.names.known)
        return Included(self._mission(source, lexer, grouped), frozenset(lexer.conditions), lexer.names.known)

    def _errors(self, lexer: Lexer, grouped: Grouped) -> Iterable[Diagnostic]:
        """What is wrong with a text that can be read, for the corrections of one that cannot."""
        assert self._errors_of is not None
        try:
            read = self._mission(lexer.text.source, lexer, grouped)
            mission, _ = _whole(read, self._vocabulary)
            return self._errors_of(mission, self._vocabulary)
        except MissionError as error:
            return error.diagnostics

    def _mission(self, source: Source, lexer: Lexer, grouped: Grouped) -> Program:
        parse = import_module(PARSERS[self._parser]).parse
        build = Builder(source)
        body: Ast | None = None
        definitions: dict[str, Definition] = {}
        for unit in grouped.units:
            if unit.header is None:
                rules = whole_rules(unit.tokens, source, frozenset(self._vocabulary.asking["whole"]))
                body = with_rules_first(build.alone(parse(unit.tokens, build)) if unit.tokens else None, rules)
                continue
            inner = build.alone(parse(unit.tokens, build))
            span = Span(source, unit.header.span.start, inner.span.end)
            definitions.pop(unit.header.name, None)  # a later definition replaces an earlier one
            name, types = unit.header.name, lexer.names.definitions.types[unit.header.body]
            definitions[name] = Definition(name, types, inner, unit.header.span, span, unit.header.is_quoted)
        facts = {fact.name: fact for fact in lexer.names.facts}  # a later fact replaces an earlier one
        whole = Span(source, 0, len(source.text))
        names = lexer.names
        return Program(
            body,
            tuple(definitions.values()),
            whole,
            tuple(facts.values()),
            tuple(names.includes),
            names.main_name,
            names.needs,
            names.given,
        )


def _names_only(source: Source, lexer: Lexer) -> Program:
    """The names that a text defines; their bodies do nothing."""
    whole = Span(source, 0, len(source.text))
    types, headers = lexer.names.definitions.types, lexer.names.definitions.headers.values()
    definitions = {
        header.name: Definition(header.name, types[header.body], Nothing(whole), header.span, whole, header.is_quoted)
        for header in headers
        if header.body in types
    }
    return Program(None, tuple(definitions.values()), whole, tuple(lexer.names.facts), tuple(lexer.names.includes))
