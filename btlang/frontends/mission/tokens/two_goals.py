"""BT050 where two phrases in a row could each say where to: `put the book on the table in the box`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, two_readings
from btlang.text.words import Words
from btlang.vocabulary.entry import GOAL, THEME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import choice_of


def two_goals(match: Match, at: int, text: Words, vocabulary: Lexicon) -> Diagnostic | None:
    """The problem of a command whose thing is described by where it is, with words that could say where to put it."""
    entry, values = match.meaning.entry, vocabulary.values
    if entry is None or not entry.verbs or not values.role_words.introducing.get(GOAL):
        return None
    slots = {role.name: role.slot for _, roles in entry.verbs for role in roles}
    theme, goal = (next((v for v in match.values if v.name == slots.get(name)), None) for name in (THEME, GOAL))
    if theme is None or goal is None or goal.first <= theme.last or choice_of(theme.group or theme.text) is None:
        return None
    introducing = {words for _, roles in entry.verbs for role in roles if role.name == GOAL for words in role.words}
    both = [words for words in values.role_words.introducing[GOAL] if words in introducing]

    def begins(place: int) -> bool:
        return any(tuple(text.words[place : place + len(words)]) == words for words in both)

    where = next((place for place in range(theme.first + 1, theme.last) if begins(place)), None)
    modifiers = values.modifiers
    if where is None or not begins(theme.last) or not modifiers.relates(text, theme.last):
        return None
    if modifiers.ends_clause(text, where):
        return None  # `the book that is on the table`
    span, clause = text.span(at, match.last), modifiers.relative
    taken, other = (
        f"{text.source.text[span.start : text.starts[place]]}{clause} {text.source.text[text.starts[place] : span.end]}"
        for place in (where, theme.last)
    )
    return two_readings(span, taken, other)
