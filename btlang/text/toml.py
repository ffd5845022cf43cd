"""TOML: reading it with one exception for all faults, finding where each key is, and writing values.

tomllib gives values without positions, and doesn't write.
"""

from __future__ import annotations

import json
import re
import tomllib
from contextlib import suppress

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_MOST_PARTS = 16  # of a key such as a.b.c: the time that tomllib takes grows with their square
_QUOTED = re.compile(
    r'"""(?:\\.|[^\\])*?(?:"{3,5}|\Z)|"(?:\\.|[^"\\\n])*"?' r"|'''.*?(?:'{3,5}|\Z)|'[^'\n]*'?|#[^\n]*", re.DOTALL
)  # fmt: skip
_LONG_KEY = re.compile(rf"(?<![\w-])[\w-]+(?:[ \t]*\.[ \t]*[\w-]+){{{_MOST_PARTS}}}")
Path = tuple[str | int, ...]
"""Keys and indexes from the top: ("places", 2, "name")."""
_BLANK = re.compile(r"(?:\s|#[^\n]*)*")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}' r"|'''.*?'{3,5}" r'|"(?:\\.|[^"\\\n])*"' r"|'[^'\n]*'", re.DOTALL
)  # fmt: skip
_KEY = re.compile(r"[A-Za-z0-9_-]+")
_OTHER = re.compile(r"[^,\]}#\n]+")  # numbers, dates, true and false


def parse_toml(text: str) -> dict[str, Any]:
    """Parse a text. Raises tomllib.TOMLDecodeError, also for what is nested too deep or too long a number."""
    if _LONG_KEY.search(_QUOTED.sub(lambda quoted: "" if quoted[0][0] == "#" else "s", text)):
        raise tomllib.TOMLDecodeError(f"a key has more than {_MOST_PARTS} parts")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise tomllib.TOMLDecodeError("it is nested too deep") from None
    except ValueError:
        raise tomllib.TOMLDecodeError("a number is too long") from None


def line_of(error: tomllib.TOMLDecodeError) -> int | None:
    """Return the line that the error names: "... (at line 3, column 5)"."""
    place = re.search(r"\(at line (\d+), column \d+\)$", str(error))
    return int(place[1]) if place else None


def find_positions(text: str) -> dict[Path, int]:
    """Return the offset of each table, key and item of a text that tomllib reads; of a table its header."""
    scan = _Scan(text)
    with suppress(RecursionError, ValueError, AssertionError):  # too deep, or no TOML: until there
        scan.document()
    return scan.found


def nearest_position(found: dict[Path, int], path: Path) -> int | None:
    """Return the offset of a path, or of its nearest container if it is missing; None if there is none."""
    while path and path not in found:
        path = path[:-1]
    return found[path] if path else None


class _Scan:
    def __init__(self, text: str) -> None:
        self.text = text.replace("\r\n", "\n\n")  # offsets stay
        self.at = 0
        self.found: dict[Path, int] = {}
        self._count: dict[Path, int] = {}  # tables of each list so far

    def document(self) -> None:
        table: Path = ()
        while self._skip() < len(self.text):
            start = self.at
            if self.text.startswith("[[", start):
                self.at += 2
                table = self._inside(self._keys())
                self._count[table] = self._count.get(table, -1) + 1
                self.found.setdefault(table, start)
                table = (*table, self._count[table])
                self.found[table] = start
                self.at = self.text.index("]]", self.at) + 2
            elif self.text[start] == "[":
                self.at += 1
                table = self._inside(self._keys())
                self._note(table, start)
                self.at = self.text.index("]", self.at) + 1
            else:
                self._pair(table)

    def _inside(self, keys: list[str]) -> Path:
        """Return the path of a header, in the latest table of each list on the way."""
        path: Path = ()
        for key in keys:
            if path in self._count:
                path = (*path, self._count[path])
            path = (*path, key)
        return path

    def _pair(self, table: Path) -> None:
        start = self.at
        path = (*table, *self._keys())
        self._note(path, start)
        self.at = self.text.index("=", self.at) + 1
        self._value(path)

    def _note(self, path: Path, start: int) -> None:
        while path and path not in self.found:
            self.found[path] = start
            path = path[:-1]

    def _keys(self) -> list[str]:
        keys = []
        while True:
            self._skip()
            quoted = _STRING.match(self.text, self.at)
            match = quoted or _KEY.match(self.text, self.at)
            assert match is not None
            keys.append(match[0][1:-1] if quoted else match[0])
            self.at = match.end()
            if self._skip() >= len(self.text) or self.text[self.at] != ".":
                return keys
            self.at += 1

    def _value(self, path: Path) -> None:
        self._skip()
        opening = self.text[self.at : self.at + 1]
        if opening not in ("[", "{"):
            match = _STRING.match(self.text, self.at) or _OTHER.match(self.text, self.at)
            self.at = match.end() if match is not None else len(self.text)
            return
        self.at += 1
        index = 0
        while self._skip() < len(self.text) and self.text[self.at] not in "]}":
            if self.text[self.at] == ",":
                self.at += 1
            elif opening == "{":
                self._pair(path)
            else:
                self.found[(*path, index)] = self.at
                self._value((*path, index))
                index += 1
        self.at += 1

    def _skip(self) -> int:
        match = _BLANK.match(self.text, self.at)
        assert match is not None
        self.at = match.end()
        return self.at


def toml_value(value: Any) -> str:
    """Format a number, a flag, a text, or a list or table of them, on one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        short = f"{value:.12g}"
        return short if float(short) == value else repr(value)
    if isinstance(value, str):
        return _quote(value)
    if isinstance(value, list):
        return f"[{', '.join(map(toml_value, value))}]"
    return f"{{ {', '.join(f'{toml_key(key)} = {toml_value(each)}' for key, each in value.items())} }}"


def toml_key(key: str) -> str:
    """Format a key, in quotes if it has to be."""
    return key if key.isidentifier() and key.isascii() else _quote(key)


def _quote(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
