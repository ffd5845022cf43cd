"""The lint on who or what is said to be somewhere, where a mission asks whether that is so (BT254).

`bring the cup to Tom in the lab. If he isn't there, A`: as everything that is chosen by what it is like, Tom is chosen
from what the robot knows when the command starts. It drives to the lab only if it knows that he is there. So also for
`check whether there is a cup in the lab`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.asked_too_late import WHERE, described_places
from btlang.text.source import Span
from btlang.tree import ast
from btlang.vocabulary.capabilities import MOVES, TRAVELS
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import ways
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import PERSON, PLACE

LIES = (*WHERE, "on")
"""The parts of a description that say where something lies."""
_MOST_BEFORE = 60  # characters in which the words for a test stand, and an article


def find_known_only(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report the first such command, unless a journey to the place is right before it."""
    vocabulary = compilation.vocabulary
    for body in ast.bodies(compilation.mission):
        nodes = compilation.syntax(body)
        checked = _first_checked(nodes, vocabulary)
        if checked is not None:
            yield checked
            return
        for node in nodes:
            tried = node.tried if type(node) is ast.IfWorks and node.otherwise is not None else None
            if type(node) is ast.Chain and node.operator == "fallback":
                tried = node.items[0]
            found = _first_known(ast.parents_first(tried), vocabulary) if tried is not None else None
            if found is not None:
                yield found
                return


def _first_known(nodes: Iterable[ast.Ast], vocabulary: Lexicon) -> Diagnostic | None:
    been = set[str]()
    for phrase in _phrases(nodes):
        named = phrase.entry.given(PERSON, phrase.arguments)
        choice = choice_of(named[0]) if named and drives_robot(phrase.entry) else None
        parts = dict(choice.parts) if choice is not None else {}
        place = next((parts[relation] for relation in WHERE if relation in parts), "")
        if place and place not in been:
            return _from_memory(phrase.span, place, vocabulary)
        been.update(text for _, text in phrase.arguments)
    return None


def _first_checked(nodes: Iterable[ast.Ast], vocabulary: Lexicon) -> Diagnostic | None:
    """`check whether there is a cup in the lab`, unless the lab has been named before."""
    been = set[str]()
    for phrase in _phrases(nodes):
        places = [*phrase.entry.given(PLACE, phrase.arguments), *described_places(phrase, LIES)]
        span = _with_check(phrase.span, vocabulary) if places and been.isdisjoint(places) else phrase.span
        if span.start < phrase.span.start and phrase.entry.sort == "condition":
            return _from_memory(span, places[0], vocabulary)
        been.update(places, (text for _, text in phrase.arguments))
    return None


def _with_check(span: Span, vocabulary: Lexicon) -> Span:
    """Return the span with the word for a test that stands before it: `check whether`."""
    begin = max(span.start - _MOST_BEFORE, 0)
    before = span.source.text[begin : span.start].rstrip()
    last = before.split()[-1:]
    if vocabulary.articles.issuperset(last):
        before = before.removesuffix("".join(last)).rstrip()
    said = (words for words in ways(vocabulary.roles["check"]) if before.lower().endswith(words))
    longest = max(said, key=len, default="")
    return Span(span.source, begin + len(before) - len(longest), span.end) if longest else span


def _phrases(nodes: Iterable[ast.Ast]) -> list[ast.Phrase]:
    return sorted((node for node in nodes if type(node) is ast.Phrase), key=lambda each: each.span.start)


def _from_memory(span: Span, place: str, vocabulary: Lexicon) -> Diagnostic:
    fixed = with_journey_first(place, span.text, vocabulary)
    return diagnostic("BT254", span, words=span.text, place=place, fixed=fixed)


def drives_robot(entry: Entry) -> bool:
    """Whether a command drives the robot, by a measure or to somebody or somewhere."""
    return MOVES in entry.resources or TRAVELS in entry.needs


def with_journey_first(goal: str, words: str, vocabulary: Lexicon) -> str:
    """Write a command with a journey before it: `go to Bob then ask him "Tea?"`."""
    journey = " ".join((*vocabulary.asking["journey"], goal, vocabulary.word("then")))
    return f"{journey} {words[:1].lower()}{words[1:]}"
