"""Control characters in texts from outside, shown as text: they must not clear a terminal or forge its lines."""

from __future__ import annotations

RED, YELLOW, CYAN, PLAIN = "\x1b[1;31m", "\x1b[1;33m", "\x1b[36m", "\x1b[0m"
"""The only escape sequences that `printable` lets through."""
_COLOURS = (RED, YELLOW, CYAN, PLAIN)
_JOINERS = "\u200c\u200d"  # without which some scripts and emoji fall apart


def printable(text: str) -> str:
    """The text with `\\x1b` and the like in place of control characters, but for line ends, tabs and own colours."""
    return "\n".join(line if line.isprintable() else _printable(line) for line in text.split("\n"))


def _printable(text: str) -> str:
    parts = []
    at = 0
    while at < len(text):
        colour = next((colour for colour in _COLOURS if text.startswith(colour, at)), "") if text[at] == "\x1b" else ""
        parts.append(colour or _shown(text[at], "\t"))
        at += len(colour) or 1
    return "".join(parts)


def one_line(text: str) -> str:
    """The text on one line: line ends, tabs and escape sequences are shown, too."""
    return text if text.isprintable() else "".join(_shown(c, "") for c in text)


def _shown(character: str, kept: str) -> str:
    """Escapes what could move the cursor, turn the direction of reading or begin a line; blanks of any width stay."""
    blank = character > "\x9f" and character.isspace() and character not in "\u2028\u2029"
    if character.isprintable() or blank or character in kept or character in _JOINERS:
        return character
    return character.encode("unicode_escape").decode("ascii")
