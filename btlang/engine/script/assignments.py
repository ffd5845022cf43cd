"""The assignments of a script, and what can be said of their values without running it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.engine.script.tokens import ASSIGNMENTS, BOOLEANS, ScriptError, Tokens
from btlang.engine.script.values import COMPARISONS
from btlang.support.record import Record

NUMBER, TEXT = "number", "text"
SETS = (":=", "=")
CHANGES = ("+=", "-=", "*=", "/=")
_ASKS = frozenset((*COMPARISONS, "&&", "||"))
_KEEPS = frozenset("+()")
"""The signs that texts and numbers can have."""


class Assignment(Record):
    """An assignment of a script: its right side is from `start` to `end`.

    `kind` is NUMBER or TEXT, "" if only a run shows it. `constant` is the number or text that is alone on the right
    side, None for another value. `copied` is the key that is alone there, and `names` are all keys there.
    """

    key: str
    sign: str
    kind: str
    constant: str | None
    copied: str
    names: tuple[str, ...]
    is_text: bool
    start: int
    end: int

    @property
    def number(self) -> str:
        """The constant number that is assigned, "" for another value."""
        return (self.constant or "") if self.kind == NUMBER else ""


def assignments(code: str) -> Iterator[Assignment]:
    """List the assignments of a script, one for each statement that is one; none of what can't be read."""
    try:
        tokens = Tokens(code)
        found: list[tuple[str, str, int]] = []
        while True:
            if tokens.kind == "end" or tokens.sign == ";":
                if len(found) > 2 and found[0][0] == "name" and found[1][1] in SETS + CHANGES:
                    yield _assignment(found)
                found = []
                if tokens.kind == "end":
                    return
            else:
                found.append((tokens.kind, tokens.text, tokens.position))
            tokens.advance()
    except ScriptError:
        return


def _assignment(tokens: list[tuple[str, str, int]]) -> Assignment:
    (_, key, _), (_, sign, _), *right = tokens
    sort, text, start = right[0]
    is_text = any(sort == "text" or text in ("..", "?") for sort, text, _ in right)
    names = tuple(text for sort, text, _ in right if sort == "name")
    copied = text if sort == "name" and len(right) == 1 else ""
    end = right[-1][2] + len(right[-1][1])
    return Assignment(key, sign, _kind(right), _constant(right), copied, names, is_text, start, end)


def _constant(right: Sequence[tuple[str, str, int]]) -> str | None:
    sort, text, _ = right[0]
    if len(right) == 2 and text == "-" and right[1][0] == "number":
        return text + right[1][1]
    if len(right) > 1 or sort not in ("number", "text"):
        return None
    return text[1:-1] if sort == "text" else text


def _kind(right: Sequence[tuple[str, str, int]]) -> str:
    """Return the kind of a value: comparisons make numbers, `..` and texts make a text, and other signs a number."""
    signs = {text for sort, text, _ in right if sort == "sign"}
    if "?" in signs or not signs.isdisjoint(ASSIGNMENTS):
        return ""
    if not signs.isdisjoint(_ASKS):
        return NUMBER
    if ".." in signs or any(sort == "text" for sort, _, _ in right):
        return TEXT
    is_number = any(sort == "number" or text in BOOLEANS for sort, text, _ in right)
    return NUMBER if is_number or not signs <= _KEEPS else ""
