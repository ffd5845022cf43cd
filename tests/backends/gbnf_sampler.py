"""Reads grammars in GBNF, and derives random sentences of them that use every rule and every alternative."""

from __future__ import annotations

import random
import re
from collections import Counter
from functools import cache
from typing import NamedTuple

_PIECE = re.compile(
    r"""\s*(?:"(?P<text>(?:\\.|[^"\\])*)"|(?P<chars>\[(?:\\.|[^\]])+\])|(?P<name>[a-z][a-z0-9-]*)|(?P<mark>[|()?*+]))"""
)
_ESCAPE = re.compile(r"\\(.)")
_DEEPEST = 6  # rules that use themselves, in each other


class Node(NamedTuple):
    """A right-hand side: `kind` is text, chars, name, choice, joined, ?, * or +."""

    kind: str
    text: str = ""
    parts: tuple[Node, ...] = ()


def read(gbnf: str) -> dict[str, Node]:
    """The rules of a grammar. Raises ValueError for what is no GBNF."""
    rules: dict[str, Node] = {}
    for line in gbnf.splitlines():
        head, is_rule, body = line.partition(" ::= ")
        if not is_rule or not re.fullmatch("[a-z][a-z0-9-]*", head) or head in rules:
            raise ValueError(f"no rule, or one that is there already: {line}")
        rules[head] = _parsed(body)
    return rules


def _parsed(body: str) -> Node:
    pieces: list[tuple[str, str]] = []
    at = 0
    while at < len(body):
        match = _PIECE.match(body, at)
        if match is None:
            raise ValueError(f"no GBNF: {body[at:]}")
        pieces.append((str(match.lastgroup), str(match[str(match.lastgroup)])))
        at = match.end()
    node = _choice(pieces)
    if pieces:
        raise ValueError(f"no GBNF: {body}")
    return node


def _choice(pieces: list[tuple[str, str]]) -> Node:
    rows = [_row(pieces)]
    while pieces and pieces[0] == ("mark", "|"):
        pieces.pop(0)
        rows.append(_row(pieces))
    return rows[0] if len(rows) == 1 else Node("choice", parts=tuple(rows))


def _row(pieces: list[tuple[str, str]]) -> Node:
    parts = []
    while pieces and pieces[0] not in (("mark", "|"), ("mark", ")")):
        kind, piece = pieces.pop(0)
        if (kind, piece) == ("mark", "("):
            node = _choice(pieces)
            if not pieces or pieces.pop(0) != ("mark", ")"):
                raise ValueError("a bracket is not closed")
        elif kind == "text":
            node = Node("text", _ESCAPE.sub(lambda found: {"n": "\n"}.get(found[1], found[1]), piece))
        elif kind in ("chars", "name"):
            node = Node(kind, piece)
        else:
            raise ValueError(f"unexpected {piece}")
        while pieces and pieces[0][0] == "mark" and pieces[0][1] in "?*+":
            node = Node(pieces.pop(0)[1], parts=(node,))
        parts.append(node)
    return parts[0] if len(parts) == 1 else Node("joined", parts=tuple(parts))


@cache
def _characters(written: str) -> str:
    found = ""
    for first, last in re.findall(r"(.)(?:-(.))?", written[1:-1]):
        found += "".join(map(chr, range(ord(first), ord(last or first) + 1)))
    return found


class Sampler:
    """Derives sentences. Of alternatives it prefers those that were used least, so that all are used soon.

    `used` counts the uses of each rule.
    """

    def __init__(self, gbnf: str, seed: int) -> None:
        self.rules = read(gbnf)
        self.used: Counter[str] = Counter()
        self._random = random.Random(seed)
        self._depths = self._least_depths()
        self._taken: Counter[tuple[int, int]] = Counter()

    def sentence(self) -> str:
        """One derivation of the rule root."""
        return self._derived(self.rules["root"], 0)

    def _derived(self, node: Node, depth: int) -> str:
        if node.kind == "text":
            return node.text
        if node.kind == "chars":
            return self._random.choice(_characters(node.text))
        if node.kind == "name":
            self.used[node.text] += 1
            return self._derived(self.rules[node.text], depth + 1)
        if node.kind == "joined":
            return "".join(self._derived(part, depth) for part in node.parts)
        if node.kind == "choice":
            return self._derived(self._chosen(node, depth), depth)
        rounds = int(node.kind == "+") + int(self._random.random() < 0.3)
        return "".join(self._derived(node.parts[0], depth) for _ in range(rounds))

    def _chosen(self, node: Node, depth: int) -> Node:
        """The alternative with the fewest uses, among those that are not too deep; of equal ones any."""
        places = list(range(len(node.parts)))
        if depth > _DEEPEST:
            least = min(self._depth(node.parts[place]) for place in places)
            places = [place for place in places if self._depth(node.parts[place]) == least]
        uses = {place: self._taken[id(node), place] + self._random.random() for place in places}
        place = min(uses, key=lambda each: uses[each])
        self._taken[id(node), place] += 1
        return node.parts[place]

    def _depth(self, node: Node) -> float:
        """How many rules deep the shortest derivation is."""
        if node.kind == "name":
            return 1 + self._depths.get(node.text, float("inf"))
        if node.kind in "?*":
            return 0
        below = [self._depth(part) for part in node.parts]
        return (min(below) if node.kind == "choice" else max(below)) if below else 0

    def _least_depths(self) -> dict[str, float]:
        self._depths = {}
        while True:
            found = {name: self._depth(node) for name, node in self.rules.items()}
            if found == self._depths:
                return found
            self._depths = found
