"""Reads grammars in GBNF, derives random sentences of them that use every rule and every alternative, and accepts."""

from __future__ import annotations

import random
import re
from collections import Counter, deque
from collections.abc import Iterator
from functools import cache, cached_property
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
    pieces: deque[tuple[str, str]] = deque()
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


def _choice(pieces: deque[tuple[str, str]]) -> Node:
    rows = [_row(pieces)]
    while pieces and pieces[0] == ("mark", "|"):
        pieces.popleft()
        rows.append(_row(pieces))
    return rows[0] if len(rows) == 1 else Node("choice", parts=tuple(rows))


def _row(pieces: deque[tuple[str, str]]) -> Node:
    parts = []
    while pieces and pieces[0] not in (("mark", "|"), ("mark", ")")):
        kind, piece = pieces.popleft()
        if (kind, piece) == ("mark", "("):
            node = _choice(pieces)
            if not pieces or pieces.popleft() != ("mark", ")"):
                raise ValueError("a bracket is not closed")
        elif kind == "text":
            node = Node("text", _ESCAPE.sub(lambda found: {"n": "\n"}.get(found[1], found[1]), piece))
        elif kind in ("chars", "name"):
            node = Node(kind, piece)
        else:
            raise ValueError(f"unexpected {piece}")
        while pieces and pieces[0][0] == "mark" and pieces[0][1] in "?*+":
            node = Node(pieces.popleft()[1], parts=(node,))
        parts.append(node)
    return parts[0] if len(parts) == 1 else Node("joined", parts=tuple(parts))


@cache
def _characters(written: str) -> str:
    found = ""
    for first, last in re.findall(r"(.)(?:-(.))?", written[1:-1]):
        found += "".join(map(chr, range(ord(first), ord(last or first) + 1)))
    return found


def accepts(rules: dict[str, Node], text: str) -> bool:
    """Whether the rule root makes a text."""
    known: dict[tuple[str, int], frozenset[int]] = {}

    def ends(node: Node, starts: frozenset[int]) -> frozenset[int]:
        """The places up to which the node makes the text from one of the places on."""
        if node.kind == "text":
            return frozenset(at + len(node.text) for at in starts if text.startswith(node.text, at))
        if node.kind == "chars":
            return frozenset(at + 1 for at in starts if text[at : at + 1] in tuple(_characters(node.text)))
        if node.kind == "name":
            return frozenset().union(*(named(node.text, at) for at in starts))
        if node.kind == "choice":
            return frozenset().union(*(ends(part, starts) for part in node.parts))
        if node.kind == "joined":
            for part in node.parts:
                starts = ends(part, starts) if starts else starts
            return starts
        found, latest = frozenset[int]() if node.kind == "+" else starts, starts
        while latest:
            latest = ends(node.parts[0], latest) - found
            found |= latest
            if node.kind == "?":
                break
        return found

    def named(name: str, at: int) -> frozenset[int]:
        if (name, at) not in known:
            known[name, at] = ends(rules[name], frozenset((at,)))
        return known[name, at]

    return len(text) in named("root", 0)


class Sampler:
    """Derives sentences. Each one uses the rule that was used least so far, and apart from that the alternatives that
    were used least.

    `used` counts the uses of each rule.
    """

    def __init__(self, rules: dict[str, Node], seed: int) -> None:
        self.rules = rules
        self.used: Counter[str] = Counter()
        self._random = random.Random(seed)
        self._depths = self._least_depths()
        self._taken: Counter[tuple[int, int]] = Counter()
        self._steps: dict[str, dict[str, int]] = {}
        self._within: dict[int, tuple[str, ...]] = {}
        self._shallow: dict[int, list[int]] = {}
        self._target = ""

    def sentence(self, target: str = "") -> str:
        """One derivation of the rule root that uses a rule, by default the one that was used least."""
        self._target = target or min(self.rules, key=lambda name: self.used[name])
        return self._derived(Node("name", "root"), 0, aims=True)

    def _derived(self, node: Node, depth: int, aims: bool) -> str:
        """A derivation; one that `aims` uses the target where that is nearest."""
        if node.kind == "text":
            return node.text
        if node.kind == "chars":
            return self._random.choice(_characters(node.text))
        if node.kind == "name":
            self.used[node.text] += 1
            return self._derived(self.rules[node.text], depth + 1, aims and node.text != self._target)
        aim = min(range(len(node.parts)), key=lambda place: self._distance(node.parts[place])) if aims else -1
        if node.kind == "joined":
            return "".join(self._derived(part, depth, place == aim) for place, part in enumerate(node.parts))
        if node.kind == "choice":
            place = aim if aims else self._chosen(node, depth)
            self._taken[id(node), place] += 1
            return self._derived(node.parts[place], depth, aims)
        rounds = max(int(node.kind == "+") + int(self._random.random() < 0.3), int(aims))
        return "".join(self._derived(node.parts[0], depth, aims and not round) for round in range(rounds))

    def _chosen(self, node: Node, depth: int) -> int:
        """The alternative with the fewest uses, among those that are not too deep; of equal ones any."""
        places = list(range(len(node.parts)))
        if depth > _DEEPEST:
            places = self._shallowest(node)
        uses = {place: self._taken[id(node), place] + self._random.random() for place in places}
        return min(uses, key=lambda each: uses[each])

    def _shallowest(self, node: Node) -> list[int]:
        """The alternatives that are the least deep."""
        if id(node) not in self._shallow:
            depths = [self._depth(part) for part in node.parts]
            least = min(depths)
            self._shallow[id(node)] = [place for place, depth in enumerate(depths) if depth == least]
        return self._shallow[id(node)]

    def _distance(self, node: Node) -> float:
        """Through how many rules it is to the target."""
        steps = self._steps_to(self._target)
        return min((steps[name] for name in self._names(node) if name in steps), default=float("inf"))

    def _steps_to(self, target: str) -> dict[str, int]:
        """From each rule that leads there."""
        if target not in self._steps:
            steps, latest, step = {target: 0}, {target}, 0
            while latest:
                step += 1
                latest = {name for each in latest for name in self._users.get(each, ()) if name not in steps}
                steps |= dict.fromkeys(latest, step)
            self._steps[target] = steps
        return self._steps[target]

    def _names(self, node: Node) -> tuple[str, ...]:
        """The rules that a node of the rules uses."""
        if id(node) not in self._within:
            self._within[id(node)] = tuple(dict.fromkeys(_names_in(node)))
        return self._within[id(node)]

    @cached_property
    def _users(self) -> dict[str, set[str]]:
        """The rules that use each rule."""
        users: dict[str, set[str]] = {}
        for name, node in self.rules.items():
            for used in self._names(node):
                users.setdefault(used, set()).add(name)
        return users

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


def _names_in(node: Node) -> Iterator[str]:
    if node.kind == "name":
        yield node.text
    for part in node.parts:
        yield from _names_in(part)
