"""What is said where a name is missing: of things that nobody knows (BT013), of
`every place except the hall` (BT152), and of points (BT153)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.explanations.spelling_rule import is_respelling
from btlang.text.formatting import joined
from btlang.text.source import Span
from btlang.text.spelling import nearest
from btlang.text.words import Words
from btlang.vocabulary.correct_words import correct_words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import SlotValue
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import ALL
from btlang.vocabulary.value_type import PERSON, PLACE, ValueType
from btlang.vocabulary.word_tree import find

_MOST_NAMES = 12  # that a message lists
KIND_NAMES = {"kinds": "kind", "days": "day"}
"""What messages call types whose names are no words for people."""


def explained(text: Words, value: SlotValue, vocabulary: Lexicon, context: ReadingContext) -> Diagnostic:
    """The first reason: a point, no names, an unknown one behind `except`, all left out, or one is needed."""
    if value.text:
        span = text.span(value.first, value.last)
        return diagnostic("BT153", span, words=span.text, fact=f"spot {vocabulary.roles['fact'][0]} {value.text}")
    kind, names = value.type, context.values.listed(value.type)
    span = text.span(value.first, value.last)
    if not names:
        reason = f"this world has no {kind} with a name"
        return _misfit(text, value, reason, "Name one in the world file, or choose another world with --world.")
    chosen = context.choice(text, value.first) or context.values.noun(text, value.first)
    at = chosen[1] if chosen is not None else value.last
    after = context.values.exception(text, at)
    if after and context.read(kind, text, after) is None:
        unknown = text.span(after, max(value.last, after + 1)).text
        near = nearest(unknown.lower(), names) or names[:_MOST_NAMES]
        return diagnostic(
            "BT152", span, words=span.text, reason=f"there's no {kind} called '{unknown}'",
            advice=f"Known: {', '.join(near)}",
        )  # fmt: skip
    picked = context.choice(text, after, kind) if after else None
    if picked is not None and context.values.modifiers.is_picked(picked[0].how, text, after):
        reason = f"which {kind} is left out isn't known before the robot is there"
        return _misfit(text, value, reason, f"Say what it is like, or name it: {names[0]}")
    if after:
        return _misfit(text, value, f"it leaves out every {kind} that there is", "Leave out fewer.")
    if chosen is not None and chosen[0].parts:
        return _misfit(text, value, f"this world has no such {kind}", f"Write for example: {names[0]}")
    words = " ".join(text.words[value.first : at])
    reason = f"one {kind} is needed" if chosen is not None and chosen[0].how == ALL else f"'{words}' isn't a {kind}"
    return _misfit(text, value, reason, f"Write for example: {names[0]}")


def _misfit(text: Words, value: SlotValue, reason: str, advice: str) -> Diagnostic:
    span = text.span(value.first, value.last)
    return diagnostic("BT152", span, words=span.text, reason=reason, advice=advice)


def unknown_place(text: Words, at: int, end: int, vocabulary: Lexicon) -> Diagnostic | None:
    """BT013 for `from ward 3 to the lab` where another word could stand than a place, such as a day: it's a place."""
    ways = vocabulary.values.role_words.introducing.values()
    introducing = {words[-1] for each in ways for words in each} | set(vocabulary.asking["located"])
    begin = at + (text.words[at] in introducing)
    is_known = find(vocabulary.values.names_tree(PLACE), text.words, begin) is not None
    if is_known or (begin == at and text.words[at - 1] not in introducing):
        return None
    last = next((i for i in range(begin + 1, end) if text.words[i] in introducing), max(end, begin + 1))
    return unnamed(text.span(begin, last), [vocabulary.types[PLACE]], "", vocabulary)


def unnamed(span: Span, kinds: Sequence[ValueType], understood: str, vocabulary: Lexicon) -> Diagnostic:
    """BT013: nothing of these kinds has such a name."""
    known = _mixed([vocabulary.values.said_names(kind.name) for kind in kinds])
    said = joined(list(dict.fromkeys(KIND_NAMES.get(kind.name, kind.name) for kind in kinds)), "or")
    words = span.text.lower()
    people = vocabulary.values.said_names(PERSON)
    if words in vocabulary.values.role_words.speaker and people and any(kind.name == PERSON for kind in kinds):
        hint = f"I can't tell who you are. Write your name, for example: {people[0]}"
        return diagnostic("BT013", span, type=PERSON, words=span.text, help=understood + hint)
    near = nearest(words, known)
    if correct_words(vocabulary.word_list).issuperset(words.split()):  # `bedroom` is no slip of `door`
        near = [name for name in near if is_respelling(words, name.lower(), vocabulary)]
    fix = (span, near[0]) if near else None
    return diagnostic("BT013", span, fix=fix, type=said, words=span.text, help=understood + near_names(near, known))


def _mixed(names: Sequence[Sequence[str]]) -> list[str]:
    """The names of some kinds; where they are too many to be listed, some of each kind come first."""
    share = _MOST_NAMES // max(len(names), 1)
    firsts = [name for each in names for name in each[:share]] if sum(map(len, names)) > _MOST_NAMES else []
    return list(dict.fromkeys([*firsts, *chain.from_iterable(names)]))


def near_names(near: list[str], known: list[str]) -> str:
    """The advice that lists the names that were probably meant, or those that there are."""
    if near:
        return "Similar: " + ", ".join(near[:_MOST_NAMES])
    if len(known) > _MOST_NAMES:
        return f"Known: {', '.join(known[:_MOST_NAMES])} and {len(known) - _MOST_NAMES} more"
    return "Known: " + ", ".join(known) if known else "This world has none."
