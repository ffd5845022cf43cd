"""Lint BT068 for conditions about commands that are over by then, with others between, and for doors on the way.

- `go to the lab and ask Alice "Tea?". Then go to Bob. If Alice isn't in the lab, A`: the question has failed by then;
- `take the cup to Alice in the lab. If the lab door is closed, A`: the door stood on the way there.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import Span
from btlang.tree import ast
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import DOOR, PERSON, PLACE

WHERE = ("at", "inside")
"""The parts of a description that say at which place somebody or something is."""
_FROM = ("off",)
"""The part that says from where something is fetched."""
_CLOSED, _OPEN = "DoorClosed", "DoorOpen"
_FIRST = "comes first, and fails if it can't be done."
_WHICH, _BEFORE = "What decides about it stands before it.", "To ask before it, write: "


def find_asked_too_late(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `if Alice isn't in the lab` behind what was done with her there and a journey to somewhere else."""
    vocabulary = compilation.vocabulary
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is not ast.Chain or node.operator != "sequence":
                continue
            for at, item in enumerate(node.items):
                if at > 1 and type(item) is ast.If and _denies_a_place(item):
                    before = [each for each in node.items[:at] if not isinstance(each, ast.Whenever)]
                    partner = _partner(item, _commands(before))
                    said = {warning.span for warning in compilation.warnings if warning.code == "BT068"}
                    if partner is not None and item.span not in said:
                        yield _about_partner(item, partner, vocabulary)


def asked_by(node: ast.If) -> ast.Ast:
    """Return what a form asks, also where it denies it."""
    return node.condition.condition if isinstance(node.condition, ast.Not) else node.condition


def _denies_a_place(node: ast.If) -> bool:
    """Whether a form begins with a condition that somebody isn't at a place: `if Alice isn't in the lab, A`."""
    asked = node.condition.condition if isinstance(node.condition, ast.Not) else None
    is_plain = not node.negated and node.otherwise is None and node.condition.span.start < node.body.span.start
    return is_plain and isinstance(asked, ast.Phrase) and bool(_people(asked)) and bool(_places(asked))


def _commands(items: Sequence[ast.Ast]) -> list[ast.Phrase]:
    """List the commands of some items, in the order in which they are done."""
    nodes = (each for item in items for each in ast.parents_first(item))
    return [each for each in nodes if isinstance(each, ast.Phrase) and each.entry.sort == "action"]


def _partner(node: ast.If, commands: Sequence[ast.Phrase]) -> ast.Phrase | None:
    """Return the last command about whom a condition denies to be at a place, if it was done there and the robot has
    left since.
    """
    asked = asked_by(node)
    if not isinstance(asked, ast.Phrase):
        return None
    people, places = _people(asked), _places(asked)
    at = next((at for at in reversed(range(len(commands))) if _people(commands[at]) & people), None)
    if at is None:
        return None
    was_there = any(_places(each) & places for each in commands[: at + 1])
    later = commands[at + 1 :]
    has_left = any(MOVES in each.entry.resources for each in later)
    return commands[at] if was_there and has_left and not any(_places(each) & places for each in later) else None


def _people(phrase: ast.Phrase) -> set[str]:
    """Return the names of the people that a phrase is about, also of those who are chosen by a name."""
    found = set[str]()
    for text in phrase.entry.given(PERSON, phrase.arguments):
        choice = choice_of(text)
        found.add(text if choice is None else dict(choice.parts).get(NAME, ""))
    return found - {""}


def _places(phrase: ast.Phrase) -> set[str]:
    """Return the names of the places that a phrase is about, also of those where somebody or something is."""
    return {*described_places(phrase), *phrase.entry.given(PLACE, phrase.arguments)}


def described_places(phrase: ast.Phrase, relations: Collection[str] = WHERE) -> list[str]:
    """Return the names of the places where somebody or something is that a phrase describes: `anyone in the hall`."""
    choices = (choice_of(text) for _, text in phrase.arguments)
    return [text for choice in choices if choice is not None for part, text in choice.parts if part in relations]


def _about_partner(node: ast.If, partner: ast.Phrase, vocabulary: Lexicon) -> Diagnostic:
    """Make BT068 with what to write before a command with somebody who may not be there."""
    words, done = node.span.source.text[node.span.start : node.condition.span.end], partner.span.text
    advice = _WHICH
    if not _refers(f"{node.span.text} {done}", vocabulary, but=PERSON):
        advice = f"{_BEFORE}{_lower(node.span.text)}, {vocabulary.word('otherwise')} {_lower(done)}"
    return diagnostic("BT068", node.span, words=words, advice=f"'{done}' {_FIRST} {advice}")


def _refers(words: str, vocabulary: Lexicon, but: str = "") -> bool:
    """Whether words stand on several lines, or have a pronoun (but none for a type) that means nothing elsewhere."""
    pronouns = {word for word, types in vocabulary.values.pronouns.items() if but not in types}
    return "\n" in words or not pronouns.isdisjoint(vocabulary.orthography.words(words.lower()))


def leads_through(node: ast.If, before: Sequence[ast.Phrase]) -> bool:
    """Return whether a form asks if the door is closed of a place to which commands lead that haven't asked about it:
    `kitchen door`.
    """
    is_denied = isinstance(node.condition, ast.Not)
    asked = asked_by(node)
    if not isinstance(asked, ast.Phrase) or asked.entry.id != (_OPEN if is_denied else _CLOSED):
        return False
    doors = {*asked.entry.given(DOOR, asked.arguments)}
    if any(not doors.isdisjoint(each.entry.given(DOOR, each.arguments)) for each in before):
        return False  # `wait until the kitchen door is open`
    journeys = [each for each in before if MOVES in each.entry.resources]
    goals = {goal for each in journeys for goal in (*_places(each), *described_places(each, _FROM))}
    return any(f" {goal.lower()} " in f" {door.lower()} " for door in doors for goal in goals)


def on_the_way(node: ast.If, before: Sequence[ast.Ast], vocabulary: Lexicon) -> Diagnostic:
    """Make BT068 of a door that stood on the way, with the condition before the journey if both may change places."""
    source, done = node.span.source, before[-1].span.text
    words = source.text[node.span.start : node.condition.span.end]
    whole = Span(source, before[0].span.start, node.span.end)
    is_front = node.condition.span.start < node.body.span.start and node.otherwise is None
    if not is_front or _refers(whole.text, vocabulary):
        return diagnostic("BT068", node.span, words=words, advice=f"'{done}' {_FIRST} {_WHICH}")
    journey = _lower(Span(source, whole.start, before[-1].span.end).text)
    leads = any(MOVES in each.entry.resources for each in _commands([node.body]))  # elsewhere, instead
    joint = f", {vocabulary.word('otherwise')}" if leads else f". {vocabulary.word('then').capitalize()}"
    asked = f"{node.span.text[:1].upper()}{node.span.text[1:]}{joint} {journey}"
    problem = diagnostic("BT068", node.span, words=words, advice=f"'{done}' {_FIRST} {_BEFORE}{asked}")
    return problem.replace(readings=((whole, asked),))  # type: ignore[no-any-return]


def _lower(text: str) -> str:
    """Return a text as it stands behind others."""
    return f"{text[:1].lower()}{text[1:]}"
