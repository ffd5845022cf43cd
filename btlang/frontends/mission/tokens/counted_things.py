"""What a comparison of a count is about: `count the cups. If there are more than 3 cups, wave`, not `3 people`."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Called, Listed, Token, arguments_of, drives, statement_start
from btlang.frontends.mission.tokens.settling import is_presence
from btlang.text.source import Source, Span
from btlang.tree.sums import COMPARED, COUNTING
from btlang.vocabulary.antecedents import says_there
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import KINDS, OBJECT, PERSON, PLACE

_SORT = "counted"
COUNTED = {"CountPeople": PERSON, "CountObjects": OBJECT, "CountKind": OBJECT}
"""What commands count, by their ids."""
_AT = {PERSON: "PeopleAt", KINDS: "ObjectsAt"}


def with_counted_things(tokens: list[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """Leave out of a comparison what it says that was counted; report it where something else was (BT150).

    Where nothing was counted, it is asked where the robot has gone: `go to the lab. If there are 3 people there, wave`.
    `count the people. If nobody is there, wave` is about the count, too.
    """
    said_of = (token.value.entry.id for token in tokens if isinstance(token.value, Called))
    if (COUNTING | {COMPARED}).isdisjoint(said_of):
        return  # as nearly always
    last: Called | Listed | None = None
    here: Called | Listed | None = None  # the count, where the robot still is
    goal = ""
    for at, token in enumerate(tokens):
        said = token.value
        if not isinstance(said, Called | Listed):
            continue
        goal = next(iter(said.entry.given(PLACE, arguments_of(said)[-1])), goal)
        if said.entry.id in COUNTING:
            last = here = said
        elif token.kind == "command" and drives(said) and not _depends(tokens, at):
            here = None
        elif here is not None and isinstance(said, Called) and _asks_if_any(tokens, at, here, vocabulary, source):
            token.value = Called(vocabulary.entries[COMPARED][0], ())
        elif said.entry.id == COMPARED and isinstance(said, Called):
            things = {name: text for name, text in said.arguments if name in (KINDS, _SORT)}
            compared: Called = said.replace(arguments=tuple(each for each in said.arguments if each[0] not in things))
            token.value = compared
            span = Span(source, token.start, token.end)
            if things and goal and last is None and says_there(span.text, vocabulary.values.pronouns):
                token.value = _asked_there(compared, things, goal, vocabulary)
            elif things and last is not None and not _counts(last, things):
                reason = "what was counted last is something else"
                example = f"count the {span.text.split()[-1]}. If {span.text}, wave"
                yield diagnostic("BT150", span, words=span.text, reason=reason, example=example)


def _depends(tokens: list[Token], at: int) -> bool:
    """Whether what is done at a place depends on a count: `if there are more than 2, dance. If there is nobody, A`."""
    first = statement_start(tokens, at)
    said = (token.value for token in tokens[first:at] if token.kind == "condition")
    return tokens[first].kind == "if" and any(isinstance(each, Called) and each.entry.id == COMPARED for each in said)


def _asks_if_any(tokens: list[Token], at: int, counted: Called | Listed, vocabulary: Lexicon, source: Source) -> bool:
    """Whether `if` and a condition at a place ask for anybody where people were counted."""
    said, form = tokens[at].value, tokens[at - 1 - (tokens[at - 1].kind == "not")]
    if COUNTED.get(counted.entry.id) != PERSON or form.kind not in ("if", "unless") or not isinstance(said, Called):
        return False
    where = [*said.entry.given(PLACE, said.arguments)]
    is_there = not where or where == [*counted.entry.given(PLACE, arguments_of(counted)[-1])]
    is_event = vocabulary.says_event(source.text[tokens[at].start : tokens[at].end])
    return is_there and not is_event and is_presence(said, vocabulary.negative_subjects)


def _asked_there(said: Called, things: dict[str, str], goal: str, vocabulary: Lexicon) -> Called:
    """Compare how many people or things of a kind there are at a place, in place of what was counted."""
    entry = vocabulary.entry(_AT.get(KINDS if KINDS in things else things[_SORT], ""))
    if entry is None:
        return said
    choice = choice_of(goal)
    given = {**dict(said.arguments), **things}
    arguments = ((slot.name, given[slot.name]) for slot in entry.slots if slot.name in given)
    where = next(slot.name for slot in entry.slots if slot.type == PLACE)
    return Called(entry, (*arguments, (where, goal if choice is None else f"{{{choice.key}}}")))


def _counts(said: Called | Listed, things: dict[str, str]) -> bool:
    """Whether a command counts things of a kind, or people."""
    first = said.arguments if isinstance(said, Called) else said.arguments[0]
    counted = {_SORT: COUNTED[said.entry.id], KINDS: dict(first).get(KINDS, "")}
    return all(counted[name] == text for name, text in things.items())
