"""Checks of a mission against a robot before anything moves: parts, languages, zones and gestures."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import BEARING
from btlang.robots.bodies.gesture_file import ARTICLES, phrase_forms
from btlang.robots.bodies.speech_tables import engine_of
from btlang.robots.geometry import Point
from btlang.robots.worlds.world import World
from btlang.speech.engine import SpeechError
from btlang.speech.marks import read_marks
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Span
from btlang.text.spelling import nearest
from btlang.tree.catalogue import SUBTREE
from btlang.vocabulary.capabilities import POSTURE, TRAVELS, part_of
from btlang.vocabulary.pattern import Slot
from btlang.vocabulary.references import keys_in

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon

_TYPE = "spoken_language"
"""The type of slots for a language, such as "es"."""
_OPENS = "OpenZone"
"""The id of the word that lets the robot into a zone."""
_LITERAL = re.compile(r"'([^']*)'")


def needs_of(node: Node, vocabulary: Lexicon) -> tuple[str, ...]:
    """Return what a leaf needs, by the keyword entry that does its work."""
    entries = vocabulary.entries.get(node.id, ())
    chosen = next((entry for entry in reversed(entries) if entry.replaces), entries[0] if entries else None)
    return chosen.needs if chosen is not None else ()


def needs_of_tree(tree: Tree, vocabulary: Lexicon) -> tuple[str, ...]:
    """Return the capabilities that the leaves of a tree need, each once, in alphabetical order."""
    return tuple(sorted({need for node in tree.walk() for need in needs_of(node, vocabulary)}))


def find_missing_parts(body: Body, tree: Tree, vocabulary: Lexicon, but: Collection[str] = ()) -> dict[str, Node]:
    """Return each part that the body lacks, with the first leaf that needs it; leaves with ids in `but` don't count."""
    found: dict[str, Node] = {}
    for node in tree.walk():
        missing = [] if node.id in but else [need for need in needs_of(node, vocabulary) if not body.has(need)]
        parts = [need for need in missing if not need.startswith(POSTURE)]
        for need in parts or missing:  # without an arm no posture of it is missed
            found.setdefault(part_of(need), node)
    return found


def check_body(body: Body, tree: Tree, vocabulary: Lexicon, but: Collection[str] = ()) -> None:
    """Raise MissionError with all parts that the body lacks, each at the first leaf that needs it (BT072)."""
    by_leaf: dict[int, tuple[Node, list[str]]] = {}
    for part, node in find_missing_parts(body, tree, vocabulary, but).items():
        by_leaf.setdefault(id(node), (node, []))[1].append(part)
    if by_leaf:
        raise MissionError([lack(body, parts, node) for node, parts in by_leaf.values()])


def words_of(node: Node) -> str:
    """Return the words of a node in the mission; its id if it has no place in a text."""
    return node.span.text if node.span is not None else node.id


def lack(body: Body, parts: Sequence[str], node: Node, span: Span | None = None, help: str = "") -> Diagnostic:
    """Return the message (BT072) that the body lacks parts, such as "left arm"; by default at the leaf."""
    said = [part for part in parts if not any(other.endswith(f" {part}") for other in parts)]  # a right hand is a hand
    place, listed = span or node.span or NOWHERE, " and no ".join(said)
    return diagnostic("BT072", place, words=words_of(node), parts=listed, robot=body.name, help=help)


def check_languages(body: Body, tree: Tree, vocabulary: Lexicon) -> None:
    """Raise MissionError with each language that the robot can't speak, at its first leaf (BT072).

    Languages that only the run knows fail when they are reached.
    """
    leaves: dict[str, Node] = {}
    for node in tree.walk():
        entry = vocabulary.entry(node.id)
        for slot in entry.slots if entry is not None else ():
            if slot.type == _TYPE and (language := node.port(slot.name)) and "{" not in language:
                leaves.setdefault(language, node)
    problems = []
    for language, node in leaves.items():
        try:
            engine_of(body, language, may_estimate=True)  # what the run needs of it is found when it connects
        except SpeechError:
            problems.append(lack(body, [f'voice for the language "{language}"'], node))
    if problems:
        raise MissionError(problems)


def check_zones(world: World, tree: Tree, vocabulary: Lexicon) -> None:
    """Raise MissionError for each journey into a zone to keep out of that the mission doesn't open (BT074).

    Only goals written in the mission are checked: not those that it computes, nor zones that it closes itself.
    """
    closed = [zone for zone in world.zones if zone.is_closed]
    if not closed:
        return
    opened = {node.port("zone").lower() for node in tree.walk() if node.id == _OPENS}
    closed = [zone for zone in closed if zone.name.lower() not in opened]
    places = {place.name.lower(): (place.x, place.y) for place in world.places}
    problems: list[Diagnostic] = []
    for node in tree.walk():
        if closed and TRAVELS in needs_of(node, vocabulary):
            for point in _goals(node, places, vocabulary):
                zone = next((zone for zone in closed if zone.contains(point)), None)
                if zone is not None:
                    place = node.span or NOWHERE
                    problems.append(diagnostic("BT074", place, words=words_of(node), zone=zone.name))
    if problems:
        raise MissionError(problems)


def _goals(node: Node, places: dict[str, Point], vocabulary: Lexicon) -> Iterator[Point]:
    """Return the places and the point that are the goals of a leaf."""
    slots = {slot.name: slot.type for entry in vocabulary.entries.get(node.id, ()) for slot in entry.slots}
    for name, value in node.ports:
        if slots.get(name) == "place" and value.lower() in places:
            yield places[value.lower()]
    try:
        yield float(node.port("x")), float(node.port("y"))
    except ValueError:
        return


class SaidGesture(Record):
    """The name of a gesture or posture of a body, and the name of its target, "" for none."""

    name: str
    target: str = ""


def said_gesture(body: Body, words: str) -> SaidGesture | None:
    """Return what a mark stands for, by its name or by a phrase; None if the body has no such gesture."""
    said = [word for word in words.split() if word.lower() not in ARTICLES]
    lower = [word.lower() for word in said]
    found = (
        (len(start), SaidGesture(name, " ".join(said[len(start) :])))
        for name, start, aims in _phrases(body)
        if lower[: len(start)] == start and (len(start) == len(said) or aims)
    )
    best: list[tuple[int, SaidGesture]] = sorted(found, key=lambda each: -each[0])
    return best[0][1] if best else None


def _phrases(body: Body) -> Iterator[tuple[str, list[str], bool]]:
    """Return the names of gestures, the words that each begins with, and whether a target may follow."""
    for name, gesture in body.gestures.items():
        yield name, name.lower().split(), bool(gesture.aim)
        for form in phrase_forms(gesture):
            yield name, [part for part in form if isinstance(part, str)], isinstance(form[-1], Slot)
    for name, steps in body.postures.items():
        if name not in body.gestures:
            yield name, name.lower().split(), any(BEARING in step.values() for step in steps)


def check_marks(world: World, body: Body, tree: Tree, vocabulary: Lexicon) -> None:
    """Raise MissionError for each gesture in spoken texts that the body lacks (BT072), or whose target is unknown
    (BT013).

    Texts that only the run knows are checked when they are said.
    """
    names = world.names
    known = {name.lower() for kind in (names.places, names.objects, names.people) for name in kind}
    problems = [
        problem
        for node, text in _said(tree, vocabulary)
        for mark in read_marks(text)[1]
        if "{" not in mark.words and (problem := _problem(body, known, node, mark.words)) is not None
    ]
    if problems:
        raise MissionError(problems)


def _problem(body: Body, known: set[str], node: Node, words: str) -> Diagnostic | None:
    found, span = said_gesture(body, words), _place(node, words)
    if found is None:
        near = nearest(words.lower(), [*body.gestures, *body.postures])
        similar = f"Similar: {', '.join(near)}" if near else ""
        return lack(body, [f'gesture "{words}"'], node, span, similar)
    if found.target and found.target.lower() not in known:
        near = nearest(found.target.lower(), known)
        similar = f"Similar: {', '.join(near)}" if near else ""
        return diagnostic("BT013", span, type="place, object or person", words=found.target, help=similar)
    return None


def _place(node: Node, words: str) -> Span:
    if node.span is None:
        return NOWHERE
    found = re.search(r"<\s*" + r"\s+".join(map(re.escape, words.split())) + r"\s*>", node.span.text)
    start = node.span.start
    return node.span if found is None else Span(node.span.source, start + found.start(), start + found.end())


def _said(tree: Tree, vocabulary: Lexicon) -> Iterator[tuple[Node, str]]:
    """Return the texts that leaves with a voice say, including those that reach them as values; each with its node."""
    nodes = [*tree.walk()]
    keys: dict[str, Node] = {}  # and a leaf that says each
    for node in nodes:
        if "voice" in needs_of(node, vocabulary):
            for _, text in node.ports:
                yield node, text
                keys.update((key, node) for key in keys_in(text) if key not in keys)
    known = 0
    while known < len(keys):  # values are handed from tree to tree
        known = len(keys)
        for node in nodes:
            if node.id == SUBTREE:
                read = [(name, key) for name, text in node.ports if name in keys for key in keys_in(text)]
                keys.update((key, keys[name]) for name, key in read if key not in keys)
    for node in nodes if keys else ():
        if node.id == SUBTREE:
            yield from ((node, text) for name, text in node.ports if name in keys)
        else:
            code = node.port("code")
            for key in (key for key in keys if re.search(rf"(?<!\w){re.escape(key)}\s*:?=", code)):
                yield from ((node if node.span is not None else keys[key], text) for text in _LITERAL.findall(code))


def check_mission(world: World, body: Body | None, tree: Tree, vocabulary: Lexicon, but: Collection[str] = ()) -> None:
    """Raise MissionError for everything that keeps a tree from running on a robot.

    That is: the body, if it is known, lacks what a leaf needs, a language or a gesture (BT072), the target of a gesture
    isn't in the world (BT013), or a goal is in a closed zone (BT074). Leaves with an id in `but` need no parts of the
    body.
    """
    if body is not None:
        check_body(body, tree, vocabulary, but)
    check_zones(world, tree, vocabulary)
    if body is not None:
        check_marks(world, body, tree, vocabulary)
        check_languages(body, tree, vocabulary)
