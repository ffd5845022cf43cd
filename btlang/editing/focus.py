"""Focus: a text in which everything is blank but a few statements, and what these are read with.

Such a text is read in a few milliseconds, however long the whole is, and all of it stands where it stands in the whole.
What is said of it is provisional: the statements that are blank may say what a pronoun refers to, for example.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.editing.partial import NO_ANTECEDENT
from btlang.editing.words import RobotWords
from btlang.frontends.mission.reader import read_mission
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.passes import run_passes
from btlang.passes.compilation import Compilation
from btlang.support.gc_pause import gc_paused
from btlang.support.record import Record
from btlang.text.source import Source

_BEFORE, _BEHIND = 3, 1  # statements around those that changed, to which pronouns and `otherwise` refer
_FIRST = re.compile(r"^([ \t]*)[^\s#]", re.MULTILINE)


class Focus(Record):
    """A part of a text: `text` is as long as the whole, `start` and `end` are its statements that were asked for.

    `size` is the number of characters that aren't blank.
    """

    text: str
    start: int
    end: int
    size: int


def focus_on(text: str, start: int, end: int, decisive: Iterable[int]) -> Focus:
    """Blank all of a text but the statements that have some of its characters, a few around them, and the `decisive`
    ones, each given by one of its characters.
    """
    begins = _statement_starts(text)
    first, last = bisect_right(begins, start) - 1, bisect_right(begins, end) - 1
    kept = {*range(first - _BEFORE, last + _BEHIND + 1), *(bisect_right(begins, at) - 1 for at in decisive)}
    bounds = [0, *begins[1:], len(text)]
    ranges = [(bounds[number], bounds[number + 1]) for number in sorted(kept) if 0 <= number < len(bounds) - 1]
    parts: list[str] = []
    at = 0
    for begin, stop in ranges:
        parts += [_blank(text[at:begin]), text[begin:stop]]
        at = stop
    parts.append(_blank(text[at:]))
    size = sum(stop - begin for begin, stop in ranges)
    return Focus("".join(parts), bounds[max(first, 0)], bounds[max(last, 0) + 1], size)


def provisional_problems(source: Source, words: RobotWords) -> Sequence[Diagnostic]:
    """Return what is wrong with a part of a text, without corrections, which take long to find, and without pronouns
    that refer to nothing in this part. Raises MissionError for words that can't be used.
    """
    with gc_paused:
        vocabulary = words.vocabulary(source)
        try:
            read = read_mission(source, vocabulary)
            compilation = Compilation(vocabulary, read.mission, needs_command=False, warnings=read.warnings)
            found: Sequence[Diagnostic] = run_passes(compilation).warnings
        except MissionError as error:
            found = error.diagnostics
    return [problem for problem in found if problem.code != NO_ANTECEDENT]


def without_statements(text: str, places: Iterable[int]) -> str:
    """Blank the statements that have one of these characters."""
    begins = _statement_starts(text)
    bounds = [0, *begins[1:], len(text)]
    blank = {max(bisect_right(begins, at) - 1, 0) for at in places}
    parts = (text[bounds[number] : bounds[number + 1]] for number in range(len(bounds) - 1))
    return "".join(_blank(part) if number in blank else part for number, part in enumerate(parts))


def decisive_places(lexer: Lexer) -> list[int]:
    """Return a character of each statement that decides how others are read: definitions, facts, values, files."""
    starts = lexer.text.starts
    return sorted(starts[word] for word in lexer.names.others if word < len(starts))


def _statement_starts(text: str) -> list[int]:
    """Return where the lines begin that are indented as the first one is, or less; at least the start of the text."""
    first = _FIRST.search(text)
    margin = len(first[1]) if first is not None else 0
    return [found.start() for found in re.finditer(rf"^[ \t]{{0,{margin}}}(?=[^\s#])", text, re.MULTILINE)] or [0]


def _blank(text: str) -> str:
    return "\n".join(" " * len(line) for line in text.split("\n"))
