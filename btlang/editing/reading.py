"""A text that was read once, for all that an editor asks about it."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.api import Mission
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.editing.words import RobotWords
from btlang.frontends.mission.reader import lexed
from btlang.frontends.mission.tokens.line_memo import LineMemo
from btlang.frontends.table import frontend_of
from btlang.passes.lint.tree_lints import UNDECLARED
from btlang.support.gc_pause import gc_paused
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.mission.tokens.lexer import Lexer
    from btlang.passes.compilation import Origins


_MOST_FILES = 3  # whose lines are kept
_lines: dict[str, LineMemo] = {}
"""The lines of the texts that were read last, by their files."""


def _memo(name: str) -> LineMemo:
    """Return the lines of the latest texts of a file."""
    memo = _lines.pop(name, None) or LineMemo()
    while len(_lines) >= _MOST_FILES:
        del _lines[next(iter(_lines))]
    return _lines.setdefault(name, memo)


class TextReading:
    """A text that was read: its mission, None for one that doesn't compile, and what is wrong with it.

    It doesn't notice changes of the files that the text names. Lines that are as they were in the last text of the same
    file aren't read again.
    """

    def __init__(self, source: Source, words: RobotWords) -> None:
        self.source, self.words, self.sort = source, words, frontend_of(source)
        self.origins: Origins = {}
        self.mission: Mission | None = None
        self.problems: Sequence[Diagnostic] = ()
        self._key = _cache_key(source, words)
        self._lexer: Lexer | None = None
        with gc_paused, _memo(source.name).used():
            try:
                self.mission = words.mission(source, self.origins)
            except MissionError as error:
                self.problems = error.diagnostics
            else:
                kept = (each for each in self.mission.warnings if each.code != UNDECLARED)  # said as an error then
                self.problems = (*kept, *self.mission.problems())

    @property
    def lexer(self) -> Lexer:
        """The words of a text in English, with the tokens that they make. Raises MissionError for words that can't be
        used.
        """
        if self._lexer is None:
            with gc_paused, _memo(self.source.name).used():
                self._lexer = lexed(self.source, self.words.vocabulary(self.source))
        return self._lexer

    def is_of(self, source: Source, words: RobotWords) -> bool:
        """Return whether this is the reading of a text, unless files that it names have changed."""
        return self._key == _cache_key(source, words)


def _cache_key(source: Source, words: RobotWords) -> tuple[object, ...]:
    """Return what decides how a text is read, but for the files that it names."""
    world = words.world.text if isinstance(words.world, Source) else words.world
    return source.text, source.name, tuple(words.keywords), world, words.language
