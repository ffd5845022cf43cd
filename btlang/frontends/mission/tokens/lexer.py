"""Words to raw tokens: phrases, connectives, names, brackets, lines and blocks. Collects what is unknown."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.explanations.times import find_midnights
from btlang.frontends.mission.symbols.names import Load, Names
from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.condition_names import condition_names, settle
from btlang.frontends.mission.tokens.counted_answers import with_counted_answers
from btlang.frontends.mission.tokens.counted_things import with_counted_things
from btlang.frontends.mission.tokens.ended_rules import with_ends
from btlang.frontends.mission.tokens.framed_rules import with_framed_rules
from btlang.frontends.mission.tokens.left_out import find_unplaced
from btlang.frontends.mission.tokens.lines_in_use import in_use
from btlang.frontends.mission.tokens.other_things import (
    with_goals_there,
    with_other_things,
    with_things_there,
    with_waits_there,
)
from btlang.frontends.mission.tokens.repeated_statements import (
    with_conditions_then,
    with_days_then,
    with_questions_each_time,
    with_questions_once,
    with_repeats_apart,
    with_rest_of_rounds,
    with_rounds_beside,
    with_times_first,
    with_tries_apart,
    with_waits_each_time,
)
from btlang.frontends.mission.tokens.replaced_commands import with_replacements
from btlang.frontends.mission.tokens.rewording import reworded
from btlang.frontends.mission.tokens.rules_behind import (
    find_counted_rules,
    find_ended_rounds,
    find_two_ifs,
    with_checks_acted_on,
    with_checks_apart,
    with_exceptions,
    with_rules_behind,
    with_watches,
)
from btlang.frontends.mission.tokens.rules_inside import with_rules_inside
from btlang.frontends.mission.tokens.settling import (
    find_brief_stays,
    find_unclear_things,
    turn_branches,
    with_either_end,
    with_goals_reached,
    with_rounds,
    with_stays,
    with_watched_waits,
)
from btlang.frontends.mission.tokens.unclear_people import find_unclear_people
from btlang.frontends.mission.tokens.visitors import with_meetings, with_sightings
from btlang.frontends.mission.tokens.word_reader import WordReader
from btlang.text.source import Source, Span
from btlang.text.words import Words, split
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import Known, ReadingContext

FEWEST_LINES = 100
"""The lines of a text from which on it is worth it to keep them for the next one."""
TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.mission.tokens.line_memo import LineReader


class Lexer:
    """Reads one source. `tokens` are raw tokens, `problems` what was unknown; both are complete after construction.

    With `explain` False nothing is said about unknown words, which takes time. `load` reads the missions that this one
    includes; without it their names are unknown. `known` are values that it may use though it does not set them.
    """

    def __init__(
        self,
        source: Source,
        vocabulary: Lexicon,
        explain: bool = True,
        load: Load | None = None,
        known: Mapping[str, Known] | None = None,
    ) -> None:
        self._given, self._shared = vocabulary, known
        self.text: Words = split(source, vocabulary.orthography)
        self.problems: list[Diagnostic] = [
            diagnostic("BT004", span, fix=(Span(source, span.end, span.end), '"')) for span in self.text.open_quotes
        ]
        self.problems += [diagnostic("BT003", span, characters=span.text[:20]) for span in self.text.unreadable]
        self.problems += reworded(self.text, vocabulary)
        self.names = Names(self.text, vocabulary, load, known)
        self.problems += self.names.problems
        self.vocabulary = self.names.vocabulary
        self.context = ReadingContext(self.vocabulary.values)
        self.context.keys = self.names.chosen
        self.tokens: list[Token] = []
        self._read_lines(explain)
        self.problems += with_repeats_apart(self.tokens, source)
        with_counted_answers(self.tokens, self.vocabulary)
        self.problems += with_replacements(self.tokens, self.vocabulary, source)
        with_times_first(self.tokens)
        with_days_then(self.tokens)
        with_rounds_beside(self.tokens)
        self.problems += with_questions_once(self.tokens, source)
        with_questions_each_time(self.tokens)
        with_waits_each_time(self.tokens, vocabulary.roles["again"], source)
        with_tries_apart(self.tokens)
        with_watches(self.tokens)
        turn_branches(self.tokens)
        with_rounds(self.tokens)
        with_goals_reached(self.tokens)
        with_either_end(self.tokens)
        with_watched_waits(self.tokens)
        with_stays(self.tokens, source, vocabulary.asking["standing_verbs"])
        self.problems += find_brief_stays(self.tokens, vocabulary, source) if explain else ()
        self.problems += find_unclear_things(self.tokens, vocabulary, self.text) if explain else ()
        self.problems += find_unclear_people(self.tokens, vocabulary, self.text) if explain else ()
        self.problems += find_unplaced(self.tokens, vocabulary, source) if explain else ()
        with_meetings(self.tokens, vocabulary)
        with_sightings(self.tokens, vocabulary, source)
        self.problems += with_counted_things(self.tokens, self.vocabulary, source)
        with_things_there(self.tokens)
        with_goals_there(self.tokens, vocabulary, source)
        with_waits_there(self.tokens, vocabulary, source)
        self.problems += with_other_things(self.tokens, vocabulary, self.text)
        with_rest_of_rounds(self.tokens, self.vocabulary, source)
        self.problems += with_framed_rules(self.tokens, self.vocabulary, source)
        with_rules_behind(self.tokens)
        self.problems += find_midnights(self.tokens, source)
        self.problems += find_counted_rules(self.tokens, source)
        with_checks_apart(self.tokens)
        with_checks_acted_on(self.tokens, self.vocabulary, source)
        self.problems += find_two_ifs(self.tokens, self.vocabulary, source)
        self.problems += find_ended_rounds(self.tokens, self.vocabulary, source)
        self.problems += with_exceptions(self.tokens, self.vocabulary, source)
        with_conditions_then(self.tokens)
        with_rules_inside(self.tokens)
        self.problems += with_ends(self.tokens, self.vocabulary, partial(Span, source))
        self.conditions = condition_names(self.tokens, self.names.included_conditions())
        """The defined names that stand for conditions."""
        settle(self.tokens, self.conditions)

    def again(self, source: Source) -> Lexer:
        """Another text in the place of this one; it may include what this one does, and nothing is said about it."""
        included = self.names.included
        return Lexer(source, self._given, explain=False, load=lambda path, _: included.get(path), known=self._shared)

    def _read_lines(self, explain: bool) -> None:
        """Read all lines, those that an editor's last text had by what was kept of them."""
        memo = in_use.memo
        if memo is None or len(self.text.lines) < FEWEST_LINES:
            reader = WordReader(self.text, self.names, self.context, self.tokens, self.problems, explain)
            self._lines(reader)
            reader.finish()
            return
        from btlang.frontends.mission.tokens.line_memo import LineReader, watch  # only editors read so
        from btlang.frontends.mission.tokens.looked_at import LookedAt

        watch(self.text, self.names, memo)
        self.tokens, self.problems = tokens, problems = LookedAt(), LookedAt(self.problems)
        watched = WordReader(self.text, self.names, self.context, tokens, problems, explain)
        lines = LineReader(watched, self.text, self.names, memo)
        self._lines(lines)
        lines.finish()
        self.tokens, self.problems = tokens.plain(), problems.plain()

    def _lines(self, reader: WordReader | LineReader) -> None:
        """Line ends, indents and dedents around the tokens of each line, as in Python."""
        lines = self.text.lines
        indents = [lines[0].indent] if lines else [0]
        opens_block = is_too_far = False
        ends = self._begins_statement(0, indents[0])
        for number, line in enumerate(lines):
            was_too_far, is_too_far = is_too_far, line.indent > indents[-1] and not opens_block
            if line.indent > indents[-1]:
                if opens_block:
                    indents.append(line.indent)
                    self._mark("indent", line.first)
                elif not was_too_far:  # a block that nothing opens is one mistake
                    self.problems.append(diagnostic("BT006", self.text.span(line.first, line.first)))
            else:
                if opens_block:
                    self.problems.append(diagnostic("BT027", self._last_span()))
                while line.indent < indents[-1] and len(indents) > 1:
                    indents.pop()
                    self._mark("dedent", line.first)
                if line.indent != indents[-1]:
                    self.problems.append(diagnostic("BT007", self.text.span(line.first, line.first)))
            if number and not opens_block:
                self._mark("newline", line.first)
            begins, ends = ends, self._begins_statement(number + 1, indents[0])
            reader.read_line(line.first, line.last, begins, ends)
            opens_block = bool(self.tokens) and self.tokens[-1].kind == "colon"  # politeness may stand behind it
        if opens_block:
            self.problems.append(diagnostic("BT027", self._last_span()))
        for _ in indents[1:]:
            self._mark("dedent", len(self.text.words) - 1)

    def _begins_statement(self, number: int, margin: int) -> bool:
        """Whether a statement begins with a line, which may be behind the last one."""
        line = self.text.lines[number] if number < len(self.text.lines) else None
        return line is None or (line.indent <= margin and line.first not in self.text.going_on)

    def _mark(self, kind: str, at: int) -> None:
        start = self.text.starts[at] if at < len(self.text.starts) else len(self.text.source.text)
        self.tokens.append(Token(kind, start, start))

    def _last_span(self) -> Span:
        last = self.tokens[-1]
        return Span(self.text.source, last.start, last.end)
