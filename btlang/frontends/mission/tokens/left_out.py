"""Commands that leave out words of the one before: `go to the lab, then the office`, `bring Bob the cup, the book`."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Called, Listed, Token, arguments_of, with_arguments
from btlang.frontends.mission.tokens.word_matches import match_of, relocated, rest_of
from btlang.text.source import Source, Span
from btlang.text.words import Words
from btlang.vocabulary.entry import MANNER, RECIPIENT, THEME, VIA
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.trie import TrieNode
from btlang.vocabulary.value_type import PLACE

_FROM = ("off", "inside", "at", "on")
"""The relations of a thing to where it lies."""


def left_out(
    text: Words, said: Sequence[int], at: int, tries: Sequence[TrieNode], context: ReadingContext
) -> tuple[Match, list[int]] | None:
    """The command that words make behind the longest beginning of another one, `said`, and all of its words.

    A text is never a part of it: `say hello, then goodbye` is no such command.
    """
    rest, particles = rest_of(text, at), context.values.role_words.particles
    whole = match_of(text, [*said, *said[-1:]], {}, tries, context)
    values = whole.values if whole else ()
    if values and _is_own(values[-1]) and text.words[at - 1] in context.joiners:
        return None  # `through the hall or the lobby`
    of_values = {number for value in values for number in range(value.first, value.last)}
    own = [number for value in values if _is_own(value) for number in _with_its_words(value, of_values)]
    inside = {number for value in values for number in range(value.first + 1, value.last)}
    for kept in range(len(said), 0, -1):
        if kept in inside or kept - 1 in own:
            continue  # a part of a value: `the orange room, then the yellow room`
        front = [place for number, place in enumerate(said[:kept]) if number not in own]
        places = [*front, *rest]
        match = match_of(text, places, {}, tries, context)
        if match is not None and any(
            value.first < len(front) < value.last or (_is_own(value) and value.last <= len(front))
            for value in match.values
        ):
            continue  # a part of a value, or the way of the command before
        added = [value for value in match.values if value.last > len(front)] if match is not None else []
        if added and all(text.words[places[value.first]] in context.values.plural_pronouns for value in added):
            continue  # `go to the lab and the hall, each`: what was said before
        if len(added) == 1 and added[0].type == PLACE and _has_one_elsewhere(text, places, added[0], context):
            continue  # `put a cup in the lab and another one in the hall`: no place
        if added and all(map(_is_own, added)):
            continue  # only the way or the manner of the command before: `to the lab, going through the hall`
        if match is None or match.last <= len(front) or match.meaning.role not in ("command", "name"):
            continue
        is_particle = match.last == len(front) + 1 and text.words[at] in particles
        if is_particle and len(said) > kept + 1:
            continue  # `from the lab to the hall and back`: not backwards; `look right, up` says another one
        if len(added) == 1 and added[0].first == len(front) and _may_be_theme(match, added[0]):
            continue  # `put the cup on the table and the book`
        if all(context.types[value.type].kind != "text" for value in match.values):
            last = places[match.last - 1] + 1
            match, places = _with_recipient(match, places[: match.last], whole, said, text, tries, context)
            return relocated(match, places).replace(last=last), places
    return None


def _with_recipient(
    match: Match,
    places: list[int],
    whole: Match | None,
    said: Sequence[int],
    text: Words,
    tries: Sequence[TrieNode],
    context: ReadingContext,
) -> tuple[Match, list[int]]:
    """The same for whom the command before was, with all of its words: `bring Alice the cup, then the book`."""
    entry = match.meaning.entry
    slots = entry.slots_of(RECIPIENT) if entry is not None else frozenset()
    values = whole.values if whole is not None else ()
    recipient = next((value for value in values if value.name in slots), None)
    if recipient is None or any(value.name in slots for value in match.values):
        return match, places
    of_values = {number for value in values for number in range(value.first, value.last)}
    words = [said[number] for number in _with_its_words(recipient, of_values)]
    wider = [*places, *words]
    found = match_of(text, [*wider, *wider[-1:]], {}, tries, context)
    is_so = found is not None and found.meaning.entry is entry and found.last == len(wider)
    return (found, wider) if found is not None and is_so else (match, places)


def _has_one_elsewhere(text: Words, places: Sequence[int], value: SlotValue, context: ReadingContext) -> bool:
    """Whether a place that is read is something else, and where that goes."""
    values, inside = context.values, places[value.first + 1 : value.last]
    behind = places[value.last - 1] + 1
    return any(values.role_words.is_one_elsewhere(text.words, at, values.ones) for at in (*inside, behind))


def _may_be_theme(match: Match, goal: SlotValue) -> bool:
    """Whether a bare thing that a command is left with as its goal could be one more theme as well."""
    entry = match.meaning.entry
    slots = entry.slots_of(THEME) if entry is not None else frozenset()
    themes = [value for value in match.values if value.name in slots]
    return any(theme.name != goal.name and theme.type == goal.type for theme in themes)


def _is_own(value: SlotValue) -> bool:
    """Whether a part of a command is never repeated by the next one: its way and its manner."""
    return value.type == MANNER or value.name == VIA


def _with_its_words(value: SlotValue, places: Container[int]) -> range:
    """The words of a value with those that introduce it."""
    first = value.first
    while first > 1 and first - 1 not in places:
        first -= 1
    return range(first, value.last)


def find_unplaced(tokens: Sequence[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """BT150 for `take the red cups from the lab to the hall and the blue ones to the kitchen`: those from the lab?"""
    for at in range(2, len(tokens)):
        said, before = tokens[at].value, tokens[at - 2].value
        if tokens[at - 1].kind != "and" or not isinstance(said, Called | Listed) or not isinstance(before, Called):
            continue
        words = source.text[tokens[at].start : tokens[at].end].lower().split()
        ones = next((word for word in words if word in vocabulary.values.ones), "")
        choices = [choice for _, text in before.arguments if (choice := choice_of(text)) is not None]
        places = [(part, value) for choice in choices for part, value in choice.parts if part in _FROM]
        span = Span(source, tokens[at].start, tokens[at].end)
        if said.entry is before.entry and ones and places and places[0][1] not in span.text:
            reason = f"those from '{places[0][1]}' may be meant, or any"
            example = span.text.replace(ones, f"{ones} from {places[0][1]}", 1)
            yield diagnostic("BT150", span, words=span.text, reason=reason, example=example)


def keep_theme(command: Token, before: Token) -> None:
    """Give a command that goes on with another one exactly the things of that."""
    value, said = command.value, before.value
    if isinstance(value, Called | Listed) and isinstance(said, Called | Listed):
        slots, rows = value.entry.slots_of(THEME), zip(arguments_of(value), arguments_of(said), strict=True)
        kept = [tuple((name, dict(own).get(name, text)) for name, text in row) for row, own in rows]
        command.value = with_arguments(value, kept) if slots else value


def complete(command: Token, before: Token | None) -> None:
    """Give a command that only names a thing the goal of another one: `take the cup to the lab, then the book`."""
    said, value = command.value, before.value if before is not None else None
    if not isinstance(said, Called) or not isinstance(value, Called | Listed) or said.entry is value.entry:
        return
    themes, given = value.entry.slots_of(THEME), {slot.name: slot.type for slot in said.entry.slots}
    types, rows = {slot.name: slot.type for slot in value.entry.slots}, arguments_of(value)
    named = {given[name]: text for name, text in said.arguments}
    if len(named) == 1 and len(themes) == 1 and {types[name] for name in themes} == named.keys():
        rest = [each for each in rows[0] if each[0] not in themes and all(each in row for row in rows)]
        theme = next(iter(themes))
        if not rest:
            return  # `turn the light on, then off`
        command.value = Called(value.entry, ((theme, named[types[theme]]), *rest))
