"""Tokens of scripts, as script_tokenizer.cpp of BehaviorTree.CPP 4.10 makes them, and the names that scripts use."""

from __future__ import annotations

import re

_TOKEN = re.compile(
    r"""(?P<number>(?:0[xX][0-9A-Fa-f]+|[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)(?![A-Za-z0-9_@]|\.(?!\.)))
    |(?P<text>'[^']*'|"[^"]*")
    |(?P<name>[A-Za-z_@][A-Za-z0-9_]*)
    |(?P<sign>:=|==|!=|<=|>=|&&|\|\||\.\.|[-+*/]=|[-+*/&|^~!<>=?:();])""",
    re.VERBOSE,
)
QUOTES = ("'", '"')
"""The marks around a text; versions before 4.10 took double quotes, too."""
BOOLEANS = {"true": 1.0, "false": 0.0}
ASSIGNMENTS = (":=", "=", "+=", "-=", "*=", "/=")
_SPACE = re.compile(r"(?:[ \t\r\n]|\\\r?\n)*")  # versions before 4.9 took a backslash at the end of a line
_LIKE_A_NUMBER = re.compile(r"[0-9][A-Za-z0-9_.]*")
READS, SETS = "reads", "sets"
_WORD = re.compile(r"[^\W\d]\w*")


class ScriptError(ValueError):
    """An error because the code is no script; `position` is the index of the character at fault."""

    def __init__(self, message: str, position: int) -> None:
        super().__init__(f"{message}, at character {position + 1}")
        self.message = message
        self.position = position


class Tokens:
    """A reader of tokens: the present token of a script, and `advance` to the next one.

    `kind` is "number", "text", "name", "sign" or "end"; `sign` is its text where it is a sign, else "".
    """

    __slots__ = ("kind", "position", "sign", "source", "text")

    def __init__(self, source: str) -> None:
        self.source = source
        self.position = 0
        self.text = ""
        self.advance()

    def advance(self) -> None:
        """Go to the next token. Raises ScriptError if no token follows."""
        start = self.position + len(self.text)
        space = _SPACE.match(self.source, start)
        self.position = start if space is None else space.end()
        found = _TOKEN.match(self.source, self.position)
        if found is not None:
            self.kind = found.lastgroup or ""
            self.text = found[0]
        elif self.position == len(self.source):
            self.kind, self.text = "end", ""
        else:
            raise self._unknown()
        self.sign = self.text if self.kind == "sign" else ""

    def _unknown(self) -> ScriptError:
        rest = self.source[self.position]
        if rest in QUOTES:
            return ScriptError("this quote is not closed", self.position)
        number = _LIKE_A_NUMBER.match(self.source, self.position)
        if number is not None:
            return ScriptError(f"{number[0]} isn't a number", self.position)
        return ScriptError(f"{rest!r} isn't valid in a script", self.position)

    def described(self) -> str:
        """Describe the place before the present token."""
        return f"before {self.text}" if self.text else "at the end"

    def number(self) -> float:
        """Return the present token as a double; a whole number must fit 64 bits."""
        text = self.text
        if text[:2] in ("0x", "0X"):
            whole = int(text, 16)
        elif text.isdigit():
            whole = int(text) if len(text) < 30 else 2**63
        else:
            return float(text)
        if whole >= 2**63:
            raise ScriptError("this number is too large", self.position)
        return float(whole)


def find_name_uses(code: str) -> dict[str, set[str]]:
    """Return READS, SETS or both by name, enums too, in the order of the code. In what is no script each word is
    read.
    """
    try:
        return find_script_names(code)
    except ScriptError:
        return {word: {READS} for word in _WORD.findall(code)}


def find_script_names(code: str) -> dict[str, set[str]]:
    """Return READS, SETS or both by name, enums too, in the order of the code. Raises ScriptError for other texts."""
    found: dict[str, set[str]] = {}
    tokens = Tokens(code)
    while tokens.kind != "end":
        name = tokens.text if tokens.kind == "name" and tokens.text not in BOOLEANS else ""
        tokens.advance()
        if name:
            found.setdefault(name, set()).update(_uses(tokens.sign))
    return found


def _uses(sign: str) -> tuple[str, ...]:
    if sign not in ASSIGNMENTS:
        return (READS,)
    return (SETS,) if sign in (":=", "=") else (READS, SETS)
