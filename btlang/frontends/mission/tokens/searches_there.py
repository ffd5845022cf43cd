"""Searches where a journey leads: `go to the lab and look for the ball`, `visit A and B and look for it in each`."""

from __future__ import annotations

from btlang.frontends.mission.token import (
    Called,
    Listed,
    Token,
    arguments_of,
    constraint_of,
    drives,
    run_start,
    with_arguments,
)
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader
from btlang.vocabulary.capabilities import TRAVELS
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.references import ALL, choice_of
from btlang.vocabulary.value_type import PLACE

_AND = frozenset(("and", "comma"))


class SearchesThere(SentenceReader):
    """Those of one text."""

    def search_there(self, match: Match) -> None:
        """`go to the lab and look for the ball`: a search there; of several places in each, instead of the journeys."""
        tokens = self._tokens
        search = tokens[-1].value
        if not isinstance(search, Called | Listed) or not search.entry.first:
            return
        everywhere = self._text.words[match.values[-1].last : match.last] if match.values else []
        if everywhere and self._context.values.each.isdisjoint(everywhere):
            return  # `go to the lab and look for the ball everywhere`; but `in each room`
        slot = next((each.name for each in search.entry.slots if each.type == PLACE), "")
        if not slot:
            return
        at = len(tokens) - 2
        while at > 0 and (tokens[at].kind in _AND or self._is_beside(tokens[at])):
            at -= 1
        journey = tokens[at].value if 0 <= at < len(tokens) - 2 else None
        if not drives(journey):
            return
        places = [dict(each) for each in arguments_of(journey)]
        goals = [text for each in places for text in journey.entry.given(PLACE, each.items())]
        if not goals or any(len(each) != 1 for each in places):
            return
        choice = choice_of(goals[0])
        again = (slot, f"{{{choice.key}}}") if choice is not None else None  # `and look for the ball in each of them`
        rows = [tuple(part for part in each if part != again) for each in arguments_of(search)]
        if any(slot in dict(each) for each in rows):
            return
        search = with_arguments(search, rows)
        is_set = len(goals) > 1 or (choice is not None and choice.how == ALL)
        is_right_behind = at == run_start(tokens, len(tokens) - 1, _AND) - 1
        if len(goals) == 1 and choice is None:
            tokens[-1].value = with_arguments(search, [(*each, (slot, goals[0])) for each in rows])
        elif is_set and is_right_behind and isinstance(search, Called):
            each = tuple((*search.arguments, (slot, goal)) for goal in goals)
            value = Called(search.entry, each[0]) if len(goals) == 1 else Listed(search.entry, each, "or")
            tokens[at:] = [Token("command", tokens[at].start, tokens[-1].end, value)]

    def looking_there(self, match: Match) -> Match:
        """The same; `look for the cup there` looks in that place, where the cup needn't be known to be."""
        entry = match.meaning.entry
        slot = next((each for each in entry.slots if each.type == PLACE), None) if entry is not None else None
        if entry is None or not entry.first or slot is None or any(value.name == slot.name for value in match.values):
            return match
        for value in match.values:
            choice, last = choice_of(value.text), value.last - 1
            parts = dict(choice.parts) if choice is not None else {}
            if parts.keys() == {"inside", "named"} and PLACE in self._context.pronouns.get(self._text.words[last], ()):
                others = (each for each in match.values if each is not value)
                thing = value.replace(text=parts["named"], last=last)
                place = SlotValue(slot.name, PLACE, parts["inside"], last, value.last)
                placed: Match = match.replace(values=(*others, thing, place))
                return placed
        return match

    @staticmethod
    def _is_beside(token: Token) -> bool:
        """Whether a command is done where the robot is, or is a search that is about the same place."""
        value = token.value
        if token.kind != "command" or not isinstance(value, Called | Listed) or constraint_of(token) is not None:
            return False
        return value.entry.first or TRAVELS not in value.entry.needs
