"""Which things are meant: two in `take a cup to the lab and a cup to the hall`, those there behind a journey."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import JOINTS, STATEMENT_ENDS, Called, Token, run_start
from btlang.frontends.mission.tokens.ended_rules import GO
from btlang.frontends.mission.tokens.word_matches import words_of
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import ALL, NAMES, RELATIONS, Choice, choice_of
from btlang.vocabulary.value_type import OBJECT

_TAKING, _PLACED = ("PickUp", "Take", "Bring"), {NAMES, *RELATIONS}
_NEAREST, _OTHER = "nearest", "other_than"
_REASON = "it may be one that was meant before"
_SIMPLE = frozenset(("command", "name", "open", "close", *JOINTS, *STATEMENT_ENDS))


def with_other_things(tokens: list[Token], vocabulary: Lexicon, text: Words) -> Iterator[Diagnostic]:
    """Make a thing that goes somewhere another one than that of the same command before; report a third one (BT150).

    The robot remembers the last one that it chose, and no others.
    """
    counts: dict[tuple[str, Choice], int] = {}
    for token in tokens:
        if token.kind not in _SIMPLE:
            counts.clear()
        value = token.value
        thing = _chosen(value) if token.kind == "command" and isinstance(value, Called) else None
        if thing is None or not isinstance(value, Called):
            continue
        parts = tuple(part for part in thing.parts if part[0] != _OTHER)
        which = value.entry.id, thing.replace(parts=parts)
        is_new = parts != thing.parts or _is_introduced(token, vocabulary, text)
        counts[which] = counts.get(which, 0) + 1 if is_new else 1
        if counts[which] > 1:
            other = thing.replace(parts=tuple(sorted((*parts, (_OTHER, f"{{{thing.key}}}")))))
            changed = ((name, other.text if said == thing.text else said) for name, said in value.arguments)
            token.value = value.replace(arguments=tuple(changed))
        if counts[which] > 2:
            words, names = Span(text.source, token.start, token.end), vocabulary.values.likenesses.members(which[1])
            example = next(iter(names or ()), words.text)
            yield diagnostic("BT150", words, words=words.text, reason=_REASON, example=example)


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


def _placed(said: str, place: str) -> str:
    """A value, with the place where it is for all things of a kind of which nothing says where they are."""
    choice = choice_of(said)
    if choice is None or choice.how != ALL or dict(choice.parts).keys() & _PLACED:
        return said
    parts = tuple(sorted((*choice.parts, ("inside", place))))
    text: str = choice.replace(parts=parts).text
    return text


def _chosen(value: Called) -> Choice | None:
    """The object that a command chooses, the nearest of its kind, and takes to somebody or somewhere."""
    if len(value.arguments) < 2:
        return None
    for choice in (choice_of(said) for _, said in value.arguments if said[:1] == "{"):
        if choice is not None and choice.type == OBJECT and choice.how == _NEAREST and choice.parts:
            return choice
    return None


def _is_introduced(token: Token, vocabulary: Lexicon, text: Words) -> bool:
    """Whether the words of a command introduce something: `a cup` or `one`, not `the cup`."""
    said, values = words_of(text, token), vocabulary.values
    articles = (text.source.text[slice(*text.articles[at])].lower() for at in said if at in text.articles)
    is_one = any(text.words[at] in values.ones and at not in text.articles for at in said)
    return is_one or any(article != values.definite for article in articles)
