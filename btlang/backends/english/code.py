"""Code of scripts and bodies of loops, as the statements, comparisons, texts and `for each` that they were made of."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Container, Iterator, Mapping, Sequence

from btlang.passes.scripts import OPERATORS
from btlang.support.record import Record
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree
from btlang.vocabulary.entry import FOUND
from btlang.vocabulary.references import choice_by, plain

_TOKEN = re.compile(
    r"\s*('[^']*'|[^\W\d]\w*|_\w+|-?\d+(?:\.\d+)?(?:e[+-]?\d+)?|:=|\+=|-=|==|>=|<=|&&|\.\.|[<>*;])", re.DOTALL
)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_KEY = re.compile(r"[^\W\d]\w*|_\w+")
_WAYS = {sign: way for way, sign in OPERATORS.items()}
_SIGNS = {"+=": "increase", "-=": "decrease"}
_PREFIX = "each_"


class GivenValue(Record):
    """A value that a Script gives a key: `operation` is that of ast.Assign, or "time" for milliseconds of a time in
    seconds.

    `is_number` is None if the code doesn't show it, as it only copies a value.
    """

    key: str
    operation: str
    is_number: bool | None
    text: str


class Comparison(Record):
    """A comparison of a ScriptCondition; `arguments` as in ast.Compared, `is_number` as in Given."""

    key: str
    is_number: bool | None
    arguments: tuple[tuple[str, str], ...]


def read_given(code: str, texts: Mapping[str, str]) -> GivenValue | None:
    """Read what a Script sets. `texts` are the keys that represent a text: quotes, which no string of a script can
    hold.
    """
    match _statements(code):
        case [[key, ":=", value]] if _NUMBER.fullmatch(value):
            return GivenValue(key, "set", True, value)
        case [[key, ":=", other]] if _KEY.fullmatch(other) and other not in texts:
            return GivenValue(key, "set", None, f"{{{other}}}")
        case [[key, ":=", other, "*", "1000"]] if _KEY.fullmatch(other):
            return GivenValue(key, "time", True, f"{{{other}}}")
        case [[key, ":=", *terms]]:
            text = _join(terms, texts)
            return GivenValue(key, "set", False, text) if text is not None else None
        case [[key, ("+=" | "-=") as sign, value]] if _NUMBER.fullmatch(value):
            return GivenValue(key, _SIGNS[sign], True, value)
        case [[key, ("+=" | "-=") as sign, other]] if _KEY.fullmatch(other):
            return GivenValue(key, _SIGNS[sign], True, f"{{{other}}}")
    return None


def read_comparison(code: str, texts: Mapping[str, str]) -> Comparison | None:
    """Return the comparison of a ScriptCondition."""
    statements = _statements(code)
    if len(statements) != 1:
        return None
    arguments: list[tuple[str, str]] = []
    keys: set[str] = set()
    numbers: set[bool | None] = set()
    for part in _split(statements[0], "&&"):
        if len(part) < 3:
            return None
        key, sign, *terms = part
        is_number: bool | None = len(terms) == 1 and _NUMBER.fullmatch(terms[0]) is not None
        text = terms[0] if is_number else _join(terms, texts)
        if sign not in _WAYS or text is None:
            return None
        if len(terms) == 1 and _KEY.fullmatch(terms[0]) and terms[0] not in texts:
            is_number = None
        arguments.append((_WAYS[sign], text))
        keys.add(key)
        numbers.add(is_number)
    known = numbers - {None}
    if len(keys) != 1 or len(known) > 1:
        return None
    return Comparison(keys.pop(), known.pop() if known else None, tuple(arguments))


class Computed(Record):
    """A node behind the scripts that put its ports together; `texts` are the port texts that their keys stand for.

    Those of `times` stand for seconds.
    """

    node: Node
    texts: Mapping[str, str]
    times: tuple[str, ...] = ()


def read_computed(node: Node) -> Computed | None:
    """Return what a Sequence computes for its last node; None for any other node."""
    if node.id != "Sequence" or len(node.children) < 2 or node.ports or node.name:
        return None
    texts: dict[str, str] = {}
    times: list[str] = []
    for child in node.children[:-1]:
        ports = dict(child.ports)
        if child.id == "Choose" and ports.keys() >= {"type", "how", "output"}:
            made = choice_by(ports)
            texts[made.key] = made.text
            continue
        if child.id == "SetBlackboard" and ports.keys() == {"value", "output_key"}:
            key, text = ports["output_key"], plain(ports["value"])
        else:
            given = read_given(ports.get("code", ""), texts) if child.id == "Script" else None
            if given is None or given.operation not in ("set", "time"):
                return None
            key, text = given.key, given.text
            times += [key] if given.operation == "time" else []
        if key[:1] != "_":
            return None
        texts[key] = text
    last = node.children[-1]
    found = last.port(FOUND)[1:-1] in texts
    said = tuple(port for port in last.ports if not (found and port[0] == FOUND))
    return Computed(last.replace(ports=said), texts, tuple(times))


def _statements(code: str) -> list[list[str]]:
    tokens: list[str] = []
    at = 0
    while at < len(code):
        match = _TOKEN.match(code, at)
        if match is None:
            return []
        tokens.append(match[1])
        at = match.end()
    statements = _split(tokens, ";")
    return statements if all(len(part) > 2 and _KEY.fullmatch(part[0]) for part in statements) else []


def _split(tokens: Sequence[str], mark: str) -> list[list[str]]:
    parts: list[list[str]] = [[]]
    for token in tokens:
        if token == mark:
            parts.append([])
        else:
            parts[-1].append(token)
    return parts


def _join(terms: Sequence[str], texts: Mapping[str, str]) -> str | None:
    """Return the port text that a concatenation is made of."""
    if len(terms) % 2 == 0 or any(mark != ".." for mark in terms[1::2]):
        return None
    found: list[str] = []
    for term in terms[::2]:
        if term[0] == "'":
            found.append(plain(term[1:-1]))
        elif _KEY.fullmatch(term):
            found.append(texts.get(term, f"{{{term}}}"))
        else:
            return None
    return "".join(found)


class Loop(Record):
    """A loop; `rounds` are the SubTree nodes, each with the texts that are computed for it."""

    name: str
    key: str
    body: Node
    rounds: tuple[Computed, ...]


def find_loops(tree: Tree, refused: Container[str]) -> dict[int, Loop]:
    """Find the loops by the ids of the nodes that go through their values; `refused` are subtrees that are none."""
    bodies = {name: root for name, root in tree.subtrees if name.startswith(_PREFIX) and name not in refused}
    if not bodies:
        return {}
    nodes = list(_is_said_once(tree))
    uses = Counter(node.port("ID") for node in nodes if node.id == SUBTREE)
    loops: dict[int, Loop] = {}
    for node in nodes:
        rounds = [_round(node)] if uses[_used_subtree(node)] == 1 else [_round(child) for child in _children(node)]
        found = [one for one in rounds if one is not None and one.node.port("ID") in bodies]
        names = {one.node.port("ID") for one in found}
        if len(names) == 1 and len(found) == len(rounds) == uses[name := names.pop()]:
            key = _key(name, found)
            if key and name not in {loop.name for loop in loops.values()}:
                loops[id(node)] = Loop(name, key, bodies[name], tuple(found))
    return loops


def _is_said_once(tree: Tree) -> Iterator[Node]:
    """Yield all nodes but the further rounds of `A 3 times 10 s apart`, which are the first one again."""
    stack = [root for _, root in reversed(tree.subtrees)]
    stack.append(tree.root)
    while stack:
        node = stack.pop()
        yield node
        children = node.children
        if len(children) == 2 and [part.id for part in children[1].children] == ["Delay"]:
            delay = children[1].children[0]
            children = children[: 1 + (delay.children != children[:1])]
        stack += reversed(children)


def _children(node: Node) -> tuple[Node, ...]:
    return node.children if node.id == "Sequence" and not node.ports and not node.name else ()


def _round(node: Node) -> Computed | None:
    if node.id == SUBTREE:
        return Computed(node, {})
    made = read_computed(node)
    return made if made is not None and made.node.id == SUBTREE else None


def _used_subtree(node: Node) -> str:
    """Return the subtree that a node alone uses."""
    found = _round(node)
    return found.node.port("ID") if found is not None else ""


def _key(name: str, rounds: list[Computed]) -> str:
    """Return the key that all rounds give a value; behind it the name may have a number."""
    key = name.removeprefix(_PREFIX)
    for one in (key, key.rpartition("_")[0]):
        if one and all(one in dict(found.node.ports) for found in rounds):
            return one
    return ""
