"""The gestures that marks in what is said stand for, and the check that a robot has them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.robots.body import Body
from btlang.robots.gesture import BEARING
from btlang.robots.gesture_file import ARTICLES, phrase_forms
from btlang.robots.needs import lack, needs_of
from btlang.robots.world import World
from btlang.speech.marks import read_marks
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Span
from btlang.text.spelling import nearest
from btlang.tree.catalogue import SUBTREE
from btlang.vocabulary.pattern import Slot
from btlang.vocabulary.references import keys_in

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon

_LITERAL = re.compile(r"'([^']*)'")


class SaidGesture(Record):
    """The name of a gesture or posture of a body, and what it is aimed at: a name, "" for nothing."""

    name: str
    target: str = ""


def said_gesture(body: Body, words: str) -> SaidGesture | None:
    """What a mark stands for, by its name or by a phrase; None where the body has no such gesture."""
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
    """Names of gestures, the words that each begins with, and whether what it is aimed at may follow."""
    for name, gesture in body.gestures.items():
        yield name, name.lower().split(), bool(gesture.aim)
        for form in phrase_forms(gesture):
            yield name, [part for part in form if isinstance(part, str)], isinstance(form[-1], Slot)
    for name, steps in body.postures.items():
        if name not in body.gestures:
            yield name, name.lower().split(), any(BEARING in step.values() for step in steps)


def check_marks(world: World, body: Body, tree: Tree, vocabulary: Lexicon) -> None:
    """Raises MissionError for each gesture in what a mission says that the body lacks (BT072), and for each target that
    isn't in the world (BT013).

    Texts that only the run knows are looked at when they are said.
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
    """The texts that leaves with a voice say, also those that reach them as values; each with its node."""
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
