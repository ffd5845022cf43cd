"""Conditions that aren't written whole, or that are denied twice: `the battery is below 20% or above 90%`."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    IN_CONDITIONS,
    LINES,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    drives,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.ended_rules import THERE, say_there
from btlang.frontends.mission.tokens.going_on import BRANCHES
from btlang.frontends.mission.tokens.sentence_reader import leads_to
from btlang.frontends.mission.tokens.settling import achieves, asked_about, misses
from btlang.text.source import Source
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import COUNT, choice_of
from btlang.vocabulary.trie import TrieNode, longest
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias, TypeGuard

    Origin: TypeAlias = tuple[Token, int, Match, TrieNode]
    """A condition that was read as a whole: the latest part of it, its first word, and where it was found."""


_ASKING = frozenset(("if", "unless", "check"))
_SEEN_AT = {"SeesPerson": "PersonIsAt", "SeesObject": "ObjectIsAt"}
_KNOWN = "ObjectKnown"


def asked_there(
    match: Match, tokens: Sequence[Token], text: Words, context: ReadingContext, vocabulary: Lexicon
) -> Match:
    """`go to the lab. If somebody is there, A`: somebody in the lab, whether the robot has them in view or not.

    `If there is a cup, A` is about a cup in the lab, too.
    Not so where a command behind the journey has settled it: `go to the lab and tell Bob "hi". If he isn't there, A`.
    """
    entry, place = match.meaning.entry, context.latest.get(PLACE, "{")
    if entry is None or place[:1] == "{" or not (entry.id in THERE or entry.id == _KNOWN):
        return match  # as nearly always
    there, last = vocabulary.entry(THERE.get(entry.id, "")), text.words[match.last - 1]
    first = bisect_left(text.starts, tokens[-1].end) if tokens else 0
    if text.words[first + 1] in vocabulary.forms_of_be:  # `if there is a stranger`
        last = text.words[first] if PLACE in vocabulary.values.pronouns.get(text.words[first], ()) else last
    inside = [context.inside(OBJECT, value.text, place) for value in match.values] if entry.id == _KNOWN else []
    if not any(inside) and (there is None or PLACE not in vocabulary.values.pronouns.get(last, ())):
        return match
    form = run_start(tokens, len(tokens), IN_CONDITIONS) - 1
    journey = next((at for at in reversed(range(len(tokens))) if drives(tokens[at].value)), -1)
    if form < 0 or tokens[form].kind not in _ASKING or journey < 0 or not leads_to(tokens[journey], place):
        return match
    begun, first = statement_start(tokens, form), statement_start(tokens, journey)
    if begun != first and any(token.kind in BRANCHES or token.kind in LINES for token in tokens[first:journey]):
        return match  # `if C, go to the lab. If somebody is there, A`: it may not be there
    asked = Token("condition", 0, 0, Called(entry, tuple((value.name, value.text) for value in match.values)))
    settled = asked_about(tokens, form, lambda token: achieves(token, asked) or misses(token, asked))
    if settled is not None and settled > journey:
        return match
    if there is None:
        known: Match = match.replace(values=(match.values[0].replace(text=inside[0]),))
        return known
    slot = next(slot for slot in there.slots if slot.type == PLACE)
    value = SlotValue(slot.name, PLACE, place, match.last - 1, match.last)
    placed: Match = match.replace(meaning=match.meaning.replace(entry=there), values=(*match.values, value))
    return placed


def placed_before(asked: Token, tokens: Sequence[Token], vocabulary: Lexicon, source: Source) -> None:
    """`if Bob is in the lab, wait until he leaves`: until he isn't in the lab, wherever the robot looks.

    The same behind `avoid the lab while Bob is there`, in the next statement, and of `check that nobody is in the lab.
    If someone is there, A`.
    """
    value = asked.value
    say_there(asked, tokens, vocabulary, source.text[asked.start : asked.end])
    there = _SEEN_AT.get(value.entry.id, "") if isinstance(value, Called) else ""
    if not there or not isinstance(value, Called) or not tokens or tokens[-1].kind != "not":
        return
    here = run_start(tokens, statement_start(tokens, len(tokens)), STATEMENT_ENDS)
    placed: Called | None = None
    for token in tokens[statement_start(tokens, here) :]:
        before = token.value
        if token.kind == "condition" and isinstance(before, Called) and before.entry.id == there:
            placed = before if {*dict(value.arguments).values()} <= {*dict(before.arguments).values()} else placed
        elif token.kind == "command" and drives(before):
            placed = None  # `if Bob isn't in the lab, go to the hall, and if he isn't there, ...`
    asked.value = placed or asked.value


def with_words_before(
    origin: Origin,
    tokens: Sequence[Token],
    text: Words,
    match: Match | None,
    at: int,
    vocabulary: Lexicon,
    names: TrieNode,
    context: ReadingContext,
) -> tuple[Match | None, Diagnostic | None]:
    """Words behind `and` or `or` that are no condition, or one of the robot alone, with those of the one before them.

    `if Alice is near or in the lab` is about Alice, as if `in the lab` weren't a condition without her.
    """
    before = tokens[-2 if tokens[-2].kind != "comma" else -3]
    if before is not origin[0]:
        return None, None
    is_whole = match is not None and match.meaning.role == "condition"
    if match is not None and not is_whole:  # `not`
        following = (longest(root, text, match.last, context) for root in (vocabulary.trie, names))
        if any(own is not None and own.meaning.role in ("name", "condition", "negated") for own in following):
            return None, None
    from btlang.frontends.mission.tokens.shared_words import continued  # most missions have none

    shared, problem = continued(*origin[1:], text, at, vocabulary, context) or (None, None)
    if match is None or not is_whole:
        return shared, problem
    if shared is not None and shared.last >= match.last:
        return shared, problem
    return None, _other_subject(origin[2], text, match, at, vocabulary)


def _other_subject(before: Match, text: Words, match: Match, at: int, vocabulary: Lexicon) -> Diagnostic | None:
    """BT150 for `if Alice is near and holding a cup`: who holds it isn't said, and only the robot's own hands count."""
    is_about_person = any(value.type == PERSON and value.first < at - 2 for value in before.values[:1])
    is_name = any(value.first == at for value in match.values)  # `the reading corner is off limits`
    if not is_about_person or is_name or not text.words[at].endswith(tuple(vocabulary.doing)):
        return None
    span = text.span(at, match.last)
    example = f"you are {span.text}"
    return diagnostic("BT150", span, words=span.text, reason="it may be said of somebody else", example=example)


def is_so_of_none(value: object, text: Words, match: Match, at: int, vocabulary: Lexicon) -> TypeGuard[Listed]:
    """Whether a verb denies something of each of a group: `everyone has left the lab`; not `everyone isn't there`."""
    return isinstance(value, Listed) and value.joiner == "and" and is_denied_by_verb(text, match, at, vocabulary)


def is_denied_by_verb(text: Words, match: Match, at: int, vocabulary: Lexicon) -> bool:
    """Whether a phrase denies a condition without a word such as `not`: `Bob has left the lab`."""
    said = f" {' '.join(text.words[at : match.last])} "
    denials = (denial for denials in vocabulary.negations.values() for denial in denials)
    return match.meaning.role == "negated" and not any(f" {denial} " in said for denial in denials)


def with_each_denied(text: Words, match: Match, at: int, vocabulary: Lexicon) -> Match:
    """Name all of a set of which something is denied: `nobody is in the rooms`, `the rooms are empty`; so of none."""
    if all(value.more or not value.group for value in match.values):
        return match  # as nearly always
    if not is_denied_by_verb(text, match, at, vocabulary):
        return match

    def named(value: SlotValue) -> SlotValue:
        choice = choice_of(value.group) if not value.more else None
        parts = dict(choice.parts) if choice is not None else {}
        count = parts.pop(COUNT, "")
        names = vocabulary.values.likenesses.members(choice.replace(parts=tuple(parts.items()))) if choice else None
        if not names or count not in ("", str(len(names))):
            return value
        made: SlotValue = value.replace(text=names[0], more=names[1:], joiner="and")
        return made

    return match.replace(values=tuple(map(named, match.values)))  # type: ignore[no-any-return]


def check_negation(
    text: Words, match: Match, at: int, vocabulary: Lexicon, tokens: Sequence[Token]
) -> Iterator[Diagnostic]:
    """BT151 for a second negation, for the negation of a list, and for an empty place that may be no room."""
    listed = next((value for value in match.values if value.more and not value.group), None)
    is_subject = listed is not None and listed.first == at
    has_list = listed is not None and (is_subject or listed.joiner == "and")
    if has_list or match.meaning.role == "negated_twice":
        from btlang.frontends.mission.explanations import negations  # most missions have none

        if is_subject:
            yield negations.negated_subjects(text, at, match.last, vocabulary, tokens[-2] if len(tokens) > 1 else None)
        elif has_list:
            yield negations.negated_list(text, at, match.last, vocabulary)
        else:
            yield negations.negated_twice(text, at, match.last, vocabulary)
    elif match.values and text.words[match.last - 1] in vocabulary.asking["vacant"]:
        place, surfaces = match.values[0], vocabulary.asking["surfaces"]
        if (
            text.words[place.last - 1] in surfaces
            or vocabulary.values.likenesses.kind_of(PLACE, place.text) in surfaces
        ):
            from btlang.frontends.mission.explanations import negations

            yield negations.empty_surface(text, at, match.last, place.text, vocabulary)
