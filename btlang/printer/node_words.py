"""Words of the nodes of a tree, also of those that only lead others: as the mission says them, else as its language."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache

from btlang.printer.exact import node_head
from btlang.printer.phrase import is_sentence, is_written, phrase_of, seconds
from btlang.printer.printer import Printer
from btlang.text.source import NOWHERE, Span
from btlang.tree import ast
from btlang.tree.catalogue import CONSTRAINTS, SEQUENCE, SUBTREE, zone_names
from btlang.tree.dump import describe_node
from btlang.tree.node import Node
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import forms

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Words: TypeAlias = Callable[[Node, Printer], str]

_LONGEST = 60  # characters of words that are still a name
_COMMENT = re.compile(r"(?m)(^|\s)#[^\n]*")
_ROUND = re.compile(r"each_(\w+?)(?:_\d+)?")  # the subtree of a round: see btlang.passes.scope
_EDGES = " \t\r\n,;:.()"
_ENDLESS = "-1"


def words_of_node(node: Node, vocabulary: Lexicon) -> str:
    """Return the words of a node.

    Those of one that leads others are what the mission says of it, without what it says of these: `try up to 4 times`.
    Where the mission has no words for it alone, they are those of its language: `then`, `without entering kitchen`; of
    a node that no phrase says, such as one of a tree in XML, those that name its id: `open gripper with width 0.05`.
    """
    if node.id == SUBTREE:
        return _round_of(node)[1] or phrase_of(node, vocabulary)
    if node.children:
        return _own_words(node, _leading_words(vocabulary)) or _usual_words(node, vocabulary)
    said = phrase_of(node, vocabulary)
    return _exact_words(node, vocabulary) if said == describe_node(node) else said


def words_in(node: Node, vocabulary: Lexicon) -> str:
    """Return the words of a node in another language than its mission's, "" if that has none for it.

    It has none for names, for values that the mission computes, and for words of keyword files without a translation.
    """
    if node.name or node.id == SUBTREE:
        return ""
    if node.children:
        say = _WORDS.get(node.id)
        return say(node, _printer(vocabulary)) if say is not None else ""
    said = "" if is_written(node) else phrase_of(node.replace(span=None), vocabulary)
    return "" if said == describe_node(node) else said


@lru_cache(maxsize=4)
def _leading_words(vocabulary: Lexicon) -> tuple[tuple[str, ...], ...]:
    """Return what belongs to the condition or thing behind it: articles, and `check that`; the longest first."""
    checks = {tuple(map(str, form)) for phrase in vocabulary.roles["check"] for form in forms(phrase)}
    return tuple(sorted((*checks, *((article,) for article in vocabulary.articles)), key=len, reverse=True))


def _round_of(node: Node) -> tuple[str, str]:
    """Return the name and the value of what a round is for: ("room", "lobby"); ("", "") for what is no round."""
    found = _ROUND.fullmatch(node.port("ID")) if node.id == SUBTREE else None
    ports = dict(node.ports)
    return (found[1], ports[found[1]]) if found is not None and found[1] in ports else ("", "")


def _own_words(node: Node, leading: Sequence[tuple[str, ...]]) -> str:
    """Return what only the node itself is said with, "" if nothing is."""
    span = node.span
    if span is None or not is_sentence(span):
        return ""
    holes = _holes(node, span)
    if not holes:
        return ""
    pieces: list[str] = []
    at = span.start
    for start, end in [*sorted(holes), (span.end, span.end)]:
        gap = span.source.text[at : max(at, start)]
        if at > span.start and node.id == SEQUENCE and "\n" in gap:
            at = max(at, end)
            continue  # one statement after the other: what is between them is said of these
        words = _words_between(gap, at > span.start, start < span.end).split()
        while words and (found := next((each for each in leading if _ends_with(words, each)), None)):
            del words[-len(found) :]
        pieces.append(" ".join(words).strip(_EDGES))
        at = max(at, end)
    said = " … ".join(dict.fromkeys(piece for piece in pieces if piece))
    return said if len(said) <= _LONGEST else ""


def _ends_with(words: Sequence[str], end: Sequence[str]) -> bool:
    return [word.lower() for word in words[-len(end) :]] == [*end]


def _holes(node: Node, span: Span) -> list[tuple[int, int]]:
    """Return the places of what others say in a span; nothing if one of them says all of it."""
    holes = []
    waiting = list(node.children)
    while waiting:
        child = waiting.pop()
        place = child.span
        if place is None or place.source is not span.source:
            continue
        if (place.start, place.end) == (span.start, span.end):
            if not child.children and not _is_filler(child):
                return []
            waiting += child.children
        elif span.start <= place.start and place.end <= span.end:
            holes.append((place.start, place.end))
    return holes


def _is_filler(node: Node) -> bool:
    """Whether it is a leaf that reading puts where nothing is said, or what is said elsewhere."""
    return node.id in ("AlwaysSuccess", "AlwaysFailure", "Sleep", SUBTREE)


def _words_between(text: str, is_behind: bool, is_before: bool) -> str:
    """Return the words in a gap: not those of other statements, on lines of their own."""
    lines = _COMMENT.sub(r"\1", text).split("\n")
    first, *more = lines
    kept = [first] if is_behind or not more else [line for line in [first] if line.strip()]
    middle = [line for line in more[:-1] if line.strip()]
    if len(middle) == 1 and middle[0].rstrip().endswith(":"):  # a head of a block
        kept += middle
    elif middle and not is_behind:
        kept += middle[-1:]
    if more and (is_before or more[-1].strip()):
        kept.append(more[-1])
    return " ".join(" ".join(kept).split()).strip(_EDGES)


def _usual_words(node: Node, vocabulary: Lexicon) -> str:
    say = _WORDS.get(node.id)
    return (say(node, _printer(vocabulary)) if say is not None else "") or _exact_words(node, vocabulary)


def _exact_words(node: Node, vocabulary: Lexicon) -> str:
    """Return what the English of a tree in XML says, without the `do` before it."""
    leaf = ast.Exact(node.id, node.ports, "", (), False, NOWHERE)
    said = node_head(leaf.replace(items=(leaf,)) if node.children else leaf, _printer(vocabulary))
    return said.removeprefix(f"{vocabulary.word('do')} ")


@lru_cache(maxsize=4)
def _printer(vocabulary: Lexicon) -> Printer:
    return Printer({}, vocabulary)


def _role(role: str) -> Words:
    return lambda _, printer: printer.word(role).text


def _sequence(node: Node, printer: Printer) -> str:
    key = _round_of(node.children[0])[0]
    return f"{printer.vocabulary.word('each')} {key.replace('_', ' ')}" if key else printer.word("then").text


def _parallel(node: Node, printer: Printer) -> str:
    return "" if node.ports else printer.word("in_parallel").text


def _repeat(node: Node, printer: Printer) -> str:
    return " ".join(_repeated("repeat", node.port("num_cycles"), printer))


def _retry(node: Node, printer: Printer) -> str:
    attempts, child = node.port("num_attempts"), node.children[0]
    entry = printer.vocabulary.entry(child.id)
    if attempts == _ENDLESS and not child.children and entry is not None and entry.sort == "condition":
        return printer.word("wait_until").text
    return " ".join(_repeated("retry", attempts, printer))


def _repeated(role: str, rounds: str, printer: Printer) -> Iterator[str]:
    yield printer.word(role).text
    if rounds != _ENDLESS:
        yield printer.rounds(rounds).text


def _timed(role: str, port: str) -> Words:
    def words(node: Node, printer: Printer) -> str:
        return printer.word(role, duration=seconds(node.port(port))).text

    return words


def _constrained(role: str) -> Words:
    def words(node: Node, printer: Printer) -> str:
        zones = [printer.value(zone, "zone") for zone in zone_names(node.port("zones"))]
        return printer.word(role, zone=f" {printer.word('and').text} ".join(zones)).text

    return words


_CONSTRAINED = {"keep out": "without_entering", "keep in": "without_leaving"}
_WORDS: dict[str, Words] = {
    SEQUENCE: _sequence,
    "Fallback": _role("otherwise"),
    "Parallel": _parallel,
    "IfThenElse": _role("if"),
    "WhileDoElse": _role("while"),
    "ReactiveSequence": _role("provided"),
    "Whenever": _role("whenever"),
    "Repeat": _repeat,
    "RetryUntilSuccessful": _retry,
    "ForceSuccess": _role("if_possible"),
    "Inverter": _role("not"),
    "Timeout": _timed("within", "msec"),
    "Delay": _timed("delay", "delay_msec"),
    **{node_id: _constrained(_CONSTRAINED[kind]) for kind, node_id in CONSTRAINTS.items()},
}
"""The words of nodes that lead others, by their ids."""
