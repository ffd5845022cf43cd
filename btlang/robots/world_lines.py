"""Finds the line of a problem in the text of a world file: tomllib gives values without positions."""

from __future__ import annotations


def line_in_message(message: str) -> int | None:
    """The line that tomllib names: "... (at line 3, column 5)"."""
    words = message.replace(",", " ").split()
    numbers = [words[i + 1] for i in range(len(words) - 1) if words[i] == "line"]
    return int(numbers[-1]) if numbers and numbers[-1].isdigit() else None


def find_line(text: str, section: str, index: int, key: str) -> int | None:
    """The line (from 1) of a key in the n-th entry of a section, else of the entry, else None."""
    lines = [line.strip() for line in text.splitlines()]
    first = _find_entry(lines, section, index)
    if first is None:
        return None
    for number in range(first, len(lines)):
        line = lines[number]
        if number > first and line.startswith("["):
            break
        if key and _assigns(line, key):
            return number + 1
        if number > first and line.startswith("{"):
            break
    return first + 1


def _find_entry(lines: list[str], section: str, index: int) -> int | None:
    headers = [n for n, line in enumerate(lines) if line.startswith((f"[[{section}]]", f"[{section}]"))]
    if headers:
        return headers[min(index, len(headers) - 1)]
    for number, line in enumerate(lines):
        if _assigns(line, section):
            items = [n for n in range(number + 1, len(lines)) if lines[n].startswith(("{", "["))]
            return items[index] if line.endswith("[") and index < len(items) else number
    return None


def _assigns(line: str, key: str) -> bool:
    name, equals, _ = line.partition("=")
    return bool(equals) and name.strip().strip('"') == key
