"""The code of scripts as what it was made of: the statement, comparison or text behind it.

Only the ways in which btlang/passes/scripts.py lowers them are known; None stands for any other code.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from btlang.passes.scripts import OPERATORS
from btlang.support.record import Record
from btlang.tree.node import Node
from btlang.vocabulary.references import choice_by, plain

_TOKEN = re.compile(
    r"\s*('[^']*'|[^\W\d]\w*|_\w+|-?\d+(?:\.\d+)?(?:e[+-]?\d+)?|:=|\+=|-=|==|>=|<=|&&|\.\.|[<>*;])", re.DOTALL
)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_KEY = re.compile(r"[^\W\d]\w*|_\w+")
_WAYS = {sign: way for way, sign in OPERATORS.items()}
_SIGNS = {"+=": "increase", "-=": "decrease"}


class Given(Record):
    """What a Script gives a key: `operation` is that of ast.Assign, or "time" for milliseconds of a time in seconds.

    `is_number` is None if the code doesn't show it, as it only copies a value.
    """

    key: str
    operation: str
    is_number: bool | None
    text: str


class Comparison(Record):
    """What a ScriptCondition compares; `arguments` as in ast.Compared, `is_number` as in Given."""

    key: str
    is_number: bool | None
    arguments: tuple[tuple[str, str], ...]


def given_by(code: str, texts: Mapping[str, str]) -> Given | None:
    """`texts` are the keys that stand for a text: for quotes, which no string of a script can hold."""
    match _statements(code):
        case [[key, ":=", value]] if _NUMBER.fullmatch(value):
            return Given(key, "set", True, value)
        case [[key, ":=", other]] if _KEY.fullmatch(other) and other not in texts:
            return Given(key, "set", None, f"{{{other}}}")
        case [[key, ":=", other, "*", "1000"]] if _KEY.fullmatch(other):
            return Given(key, "time", True, f"{{{other}}}")
        case [[key, ":=", *terms]]:
            text = _joined(terms, texts)
            return Given(key, "set", False, text) if text is not None else None
        case [[key, ("+=" | "-=") as sign, value]] if _NUMBER.fullmatch(value):
            return Given(key, _SIGNS[sign], True, value)
        case [[key, ("+=" | "-=") as sign, other]] if _KEY.fullmatch(other):
            return Given(key, _SIGNS[sign], True, f"{{{other}}}")
    return None


def compared_by(code: str, texts: Mapping[str, str]) -> Comparison | None:
    """The comparison of a ScriptCondition."""
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
        text = terms[0] if is_number else _joined(terms, texts)
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


def computed(node: Node) -> Computed | None:
    """What a Sequence computes for its last node; None for any other node."""
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
            given = given_by(ports.get("code", ""), texts) if child.id == "Script" else None
            if given is None or given.operation not in ("set", "time"):
                return None
            key, text = given.key, given.text
            times += [key] if given.operation == "time" else []
        if key[:1] != "_":
            return None
        texts[key] = text
    return Computed(node.children[-1], texts, tuple(times))


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


def _joined(terms: Sequence[str], texts: Mapping[str, str]) -> str | None:
    """The port text that a concatenation is made of."""
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
