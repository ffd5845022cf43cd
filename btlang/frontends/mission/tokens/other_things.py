"""Which things are meant: two in `take a cup to the lab and a cup to the hall`, those there behind a journey."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    JOINTS,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    arguments_of,
    run_start,
    with_arguments,
)
from btlang.frontends.mission.tokens.ended_rules import GO, journey_to
from btlang.frontends.mission.tokens.settling import STAYS
from btlang.frontends.mission.tokens.word_matches import words_of
from btlang.support.record import Record
from btlang.text.source import Source, Span
from btlang.text.words import Words
from btlang.vocabulary.antecedents import says_there
from btlang.vocabulary.capabilities import TRAVELS
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import ALL, COUNT, NAMES, RELATIONS, Choice, Parts, choice_of
from btlang.vocabulary.value_type import OBJECT, PLACE
from btlang.vocabulary.word_tree import find

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.frontends.mission.token import Value

Arguments: TypeAlias = "tuple[tuple[str, str], ...]"
_TAKING, _PLACED = ("PickUp", "Take", "Bring"), {NAMES, *RELATIONS}
_NEAREST, _OTHER, _KIND = "nearest", "other_than", "kind"
_ALL_OR_ONE = (ALL, _NEAREST)
_WAITS = frozenset(("wait", "wait_time"))
_ONE = "bring the book to Alice"
_REASON = "it may be one that was meant before"
_SIMPLE = frozenset(("command", "name", "open", "close", *JOINTS, *STATEMENT_ENDS))


class _Meant(Record):
    """A thing that goes somewhere: its name, or a reference to what was chosen, and the names that it may have."""

    other: str
    names: frozenset[str]


def with_other_things(tokens: list[Token], vocabulary: Lexicon, text: Words) -> Iterator[Diagnostic]:
    """Make a thing that goes somewhere another one than that of the same command before; report a third one (BT150).

    The robot remembers the last one that it chose, and no others.
    """
    before: dict[str, list[_Meant]] = {}
    for token in tokens:
        if token.kind not in _SIMPLE:
            before.clear()
        value = token.value = _in_rows(token, tokens, vocabulary)
        if token.kind != "command" or not isinstance(value, Called | Listed):
            continue
        if value.entry.first or all(slot.type != OBJECT for slot in value.entry.slots):
            continue  # as nearly always; a search in several places is for one thing
        is_list = isinstance(value, Listed)
        meant = [] if is_list else before.setdefault(value.entry.id, [])
        rows, unclear = list[Arguments](), None
        for arguments in arguments_of(value):
            thing = _chosen(arguments) if is_list or len(arguments) > 1 else None  # to somebody, or somewhere
            if thing is not None:
                one = _Meant(f"{{{thing.key}}}", _names_of(thing, vocabulary))
                others = _named_in(value, arguments_of(value)) if is_list and not meant else meant
                same = [other for other in others if other.names & one.names]  # `a cup and the red cup`, too
                if not (is_list or _is_introduced(token, thing, vocabulary, text)):
                    meant[:] = [other for other in meant if other not in same]
                elif same:
                    arguments = _with_other(thing, arguments, same[-1].other)
                    is_known = same[-1].other[:1] != "{" or same[-1] is meant[-1]
                    unclear = unclear or (thing if len(same) > 1 or not is_known else None)
                meant.append(one)
            elif is_list or len(arguments) > 1:
                named = _named_in(value, [arguments])
                if any(one in meant for one in named) and any(
                    _is_any(text, at, vocabulary) for at in words_of(text, token)
                ):
                    words, reason = Span(text.source, token.start, token.end), f"there is only one {named[0].other}"
                    yield diagnostic("BT150", words, words=words.text, reason=reason, example=_ONE)
                meant += named
            rows.append(arguments)
        if rows != [*arguments_of(value)]:
            token.value = with_arguments(value, rows)
        if unclear is not None:
            words, of_kind = Span(text.source, token.start, token.end), unclear.replace(parts=_kind_in(unclear.parts))
            members = vocabulary.values.likenesses.members
            example = next(iter(members(unclear) or members(of_kind) or ()), words.text)
            yield diagnostic("BT150", words, words=words.text, reason=_REASON, example=example)


def _is_any(text: Words, at: int, vocabulary: Lexicon) -> bool:
    """Whether an object is named at a word behind an indefinite article: `a book`."""
    if find(vocabulary.values.names_tree(OBJECT), text.words, at) is None or at not in text.articles:
        return False
    return text.source.text[slice(*text.articles[at])].lower() in vocabulary.asking["indefinite"]


def _kind_in(parts: Parts) -> Parts:
    return tuple(part for part in parts if part[0] == _KIND)


def _in_rows(token: Token, tokens: Sequence[Token], vocabulary: Lexicon) -> Value:
    """`bring a cup to each guest` for each by name, where nothing else is done in the round: a cup for each."""
    said = token.value
    if token.kind != "command" or not isinstance(said, Called) or len(said.arguments) < 2:
        return said
    sets = [choice for _, text in said.arguments if (choice := choice_of(text)) is not None and choice.how == ALL]
    names = vocabulary.values.likenesses.members(sets[0]) if len(sets) == 1 and sets[0].type != OBJECT else None
    if _chosen(said.arguments) is None or names is None or len(names) < 2:
        return said
    used = (text for each in tokens if isinstance(each.value, Called | Listed) for row in arguments_of(each.value)
            for _, text in row)  # fmt: skip
    if any(f"{{{sets[0].key}}}" in text for text in used):
        return said
    rows = (tuple((name, one if text == sets[0].text else text) for name, text in said.arguments) for one in names)
    return Listed(said.entry, tuple(rows), "and")


def _named_in(said: Called | Listed, rows: Iterable[Arguments]) -> list[_Meant]:
    """The objects that rows of arguments of a command name."""
    named = (name for arguments in rows for name in said.entry.given(OBJECT, arguments))
    return [_Meant(name, frozenset((name,))) for name in named if name[:1] != "{"]


def _names_of(thing: Choice, vocabulary: Lexicon) -> frozenset[str]:
    """The names that what is chosen may have, or its kind where the world names none."""
    parts = tuple(part for part in thing.parts if part[0] not in (_OTHER, COUNT))
    plain = thing.replace(how=_NEAREST, parts=parts)
    return frozenset(vocabulary.values.likenesses.members(plain) or (plain.text,))


def _with_other(thing: Choice, arguments: Arguments, other: str) -> Arguments:
    """The arguments with another thing of the kind than one that is named, or was chosen last."""
    parts = (part for part in thing.parts if part[0] != _OTHER)
    changed = thing.replace(parts=tuple(sorted((*parts, (_OTHER, other)))))
    return tuple((name, changed.text if said == thing.text else said) for name, said in arguments)


def with_things_there(tokens: list[Token]) -> None:
    """Make `go to the lab and pick up the cups` pick up those in the lab."""
    for at in range(2, len(tokens)):
        said = tokens[at].value
        if not isinstance(said, Called) or said.entry.id not in _TAKING:
            continue
        before = run_start(tokens, at, JOINTS)
        is_next = any(token.kind == "then" for token in tokens[before:at])
        if not 0 < before < at or (is_next and said.entry.id != _TAKING[0]):
            continue  # `go to the dock, then take the cups to the lab`
        journey = tokens[before - 1].value
        goals = journey.arguments if isinstance(journey, Called) and journey.entry.id == GO else ()
        place = dict(goals).get("place", "{")
        if place[:1] != "{":
            arguments = tuple((name, _placed(text, place)) for name, text in said.arguments)
            tokens[at].value = said.replace(arguments=arguments)


def with_goals_there(tokens: list[Token], vocabulary: Lexicon, source: Source) -> None:
    """Make `if nobody is in the lab, take the cup there` take it to the lab, where the robot hasn't gone before."""
    take = vocabulary.entry(_TAKING[1])
    been = set[str]()
    for token in tokens:
        said = token.value
        if token.kind != "command" or not isinstance(said, Called | Listed) or take is None or not take.phrases:
            continue
        if TRAVELS in said.entry.needs:
            been.update(said.entry.given(PLACE, arguments_of(said)[-1]))
        if said.entry.id != _TAKING[0]:
            continue
        words, thing = source.text[token.start : token.end].lower(), _chosen(arguments_of(said)[0], _ALL_OR_ONE)
        place = dict(thing.parts).get("inside", "") if thing is not None else ""
        is_taken = words.startswith(take.phrases[0].partition("{")[0])
        is_goal = place not in ("", *been) and says_there(words, vocabulary.values.pronouns)
        if thing is not None and is_taken and is_goal:
            parts = tuple(part for part in thing.parts if part != ("inside", place))
            named = dict(parts).get(NAME, "") if len(parts) == 1 else ""
            token.value = Called(take, ((OBJECT, named or thing.replace(parts=parts).text), (PLACE, place)))


def with_waits_there(tokens: list[Token], vocabulary: Lexicon, source: Source) -> None:
    """Make `follow Bob until he is in the lab. Wait there` go to the lab, where the robot may not have come by then."""
    goes, pronouns = vocabulary.entry(GO), vocabulary.values.pronouns
    for at in reversed([at for at, token in enumerate(tokens) if token.kind in _WAITS or token.role == STAYS]):
        wait = tokens[at]
        words = source.text[wait.start : wait.end].lower().split()
        if goes is None or all(PLACE not in pronouns.get(word, ()) for word in words):
            continue  # as nearly always
        before = (token.value for token in tokens[:at] if isinstance(token.value, Called))
        named = [(said.entry.sort, place) for said in before for place in said.entry.given(PLACE, said.arguments)]
        if named and all(sort == "condition" for sort, _ in named):
            journey = Token("command", wait.start, wait.start, journey_to(named[-1][1], goes))
            opening, then, closing = (Token(kind, wait.start, wait.start) for kind in ("open", "then", "close"))
            tokens[at : at + 1] = [opening, journey, then, wait, closing]


def _placed(said: str, place: str) -> str:
    """A value, with the place where it is for all things of a kind of which nothing says where they are."""
    choice = choice_of(said)
    if choice is None or choice.how != ALL or dict(choice.parts).keys() & _PLACED:
        return said
    parts = tuple(sorted((*choice.parts, ("inside", place))))
    text: str = choice.replace(parts=parts).text
    return text


def _chosen(arguments: Arguments, ways: Sequence[str] = (_NEAREST,)) -> Choice | None:
    """The object that a command chooses in one of some ways, or one of its kind."""
    for choice in (choice_of(said) for _, said in arguments if said[:1] == "{"):
        is_one = choice is not None and (choice.how in ways or (COUNT, "1") in choice.parts)  # `one cup`
        if choice is not None and choice.type == OBJECT and is_one and choice.parts:
            return choice
    return None


def _is_introduced(token: Token, thing: Choice, vocabulary: Lexicon, text: Words) -> bool:
    """Whether the words of a command introduce something: `a cup`, `another cup` or `one`, not `the cup`."""
    if any(name == _OTHER for name, _ in thing.parts):
        return True
    said, values = words_of(text, token), vocabulary.values
    articles = (text.source.text[slice(*text.articles[at])].lower() for at in said if at in text.articles)
    is_one = any(text.words[at] in values.ones and at not in text.articles for at in said)
    return is_one or any(article != values.definite for article in articles)
