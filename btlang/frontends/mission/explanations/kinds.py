"""Why a set of places of a kind isn't clear: the world doesn't say of which kind each place is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import SlotValue
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import PLACE, ZONE


def find_unclear_rooms(text: Words, values: Sequence[SlotValue], vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """BT150 for `every room` where only names say what a room is: a boiler room, but not the kitchen beside it."""
    for value in values:
        choice = choice_of(value.group) if value.group and value.type == PLACE else None
        kind = dict(choice.parts).get("kind", "") if choice is not None else ""
        if choice is None or kind not in vocabulary.asking["rooms"]:
            continue  # as nearly always
        known, names = vocabulary.values, vocabulary.values.likenesses.members(choice.replace(parts=(("kind", kind),)))
        of_name = names is not None and all(kind in name.lower().split() for name in names)
        areas = known.listed(ZONE)
        others = [name for name in known.listed(PLACE) if of_name and name in areas and name not in (names or ())]
        if others:
            span, word = text.span(value.first, value.last), vocabulary.word("and")
            reason = f"the world doesn't say whether '{others[0]}' is one"
            example = f'{others[0]} {word} {(names or others)[0]}; or, in the world file, kind = "{kind}"'
            yield diagnostic("BT150", span, words=span.text, reason=reason, example=example)
