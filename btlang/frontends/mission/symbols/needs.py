"""Finds what a mission says at its top that it needs: `world "museum.toml"`, `robot "..."`, `words "referee.toml"`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.text.words import Words, statements
from btlang.vocabulary.lexicon import Lexicon

WORLD, WORDS, ROBOT = "needs_world", "needs_words", "needs_robot"
"""The roles of the words that begin such a line."""


class Need(Record):
    """A file that a mission needs: a world, a robot or a keyword file, by its role. `path` is as it was written."""

    role: str
    path: str
    span: Span


class Needs:
    """What a text needs; `ends` are the words behind these lines, by their first. `problems` are misplaced ones."""

    def __init__(self) -> None:
        self.found: list[Need] = []
        self.ends: dict[int, int] = {}
        self.problems: list[Diagnostic] = []


def find_needs(text: Words, vocabulary: Lexicon) -> Needs:
    """Every statement that names a file that the mission needs. They come before all others."""
    needs = Needs()
    phrases = [(role, phrase.split()) for role in (WORLD, WORDS, ROBOT) for phrase in vocabulary.roles[role]]
    if {words[0] for _, words in phrases}.isdisjoint(text.distinct):
        return needs
    is_top = True
    for indent, first, last in statements(text, text.distinct):
        if first == last or indent > text.lines[0].indent:
            continue
        path = text.words[last - 1]
        role = next((role for role, words in phrases if words == text.words[first : last - 1]), "")
        if not role or path[0] != '"' or len(path) == 1:
            is_top = False
            continue
        need = Need(role, path[1:], text.span(first, last))
        needs.ends[first] = last
        if not is_top:
            needs.problems.append(unusable(need, "such a line comes before all others in a mission"))
        elif role != WORDS and any(other.role == role for other in needs.found):
            what = "world" if role == WORLD else "robot"
            needs.problems.append(unusable(need, f"the mission has a {what} already"))
        else:
            needs.found.append(need)
    return needs


def unusable(need: Need, reason: str) -> Diagnostic:
    """BT049 at the line."""
    return diagnostic("BT049", need.span, words=need.span.text, reason=reason)
