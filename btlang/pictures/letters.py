"""Text in pictures: what can be shown of it, how wide it is, and where a long one is broken."""

from __future__ import annotations

from functools import cache
from unicodedata import category, normalize

FAMILY = "DejaVu Sans"  # comes with matplotlib, and few common families are wider
CAP_HEIGHT = 0.73  # as a share of the size
UNKNOWN = "\N{REPLACEMENT CHARACTER}"
_JOINERS = "\u200c\u200d"  # without which some scripts and emoji fall apart
_LONGEST = 10_000  # characters of a text that a picture holds: a value may be much longer
_BROKEN = 400  # of these, so many are broken into lines

_NORMAL = {
    0x20: "32 40 46 84 64 95 78 27 39 39 50 84 32 36 32 34 64 64 64 64 64 64 64 64 64 64 34 34 84 84 84 53 100 68 "
    "69 70 77 63 58 77 75 29 29 66 56 86 75 79 60 79 69 63 61 73 68 99 69 61 69 39 34 39 84 50 50 61 63 55 63 "
    "62 35 63 63 28 28 58 28 97 63 61 63 63 41 52 39 63 59 82 59 59 52 64 34 64 84",
    0x391: "68 69 56 68 63 69 75 79 29 66 68 86 75 63 79 75 60 0 63 61 61 79 69 79 76 29 61 66 54 63 34 58 66 64 59 "
    "61 54 54 63 61 34 59 59 64 56 56 61 60 63 59 63 60 58 66 58 66 84",
    0x410: "68 69 69 61 78 63 108 64 75 75 71 75 86 75 79 75 60 70 61 61 86 69 78 69 107 109 83 88 69 70 108 69 61 "
    "62 59 53 69 62 90 53 65 65 60 64 75 65 61 65 63 55 58 59 85 59 68 59 92 94 71 79 59 55 84 60",
}
_BOLD = {
    0x20: "35 46 52 84 70 100 87 31 46 46 52 84 38 42 38 37 70 70 70 70 70 70 70 70 70 70 40 40 84 84 84 58 100 77 "
    "76 73 83 68 68 82 84 37 37 77 64 100 84 85 73 85 77 72 68 81 77 110 77 72 73 46 37 46 84 50 50 67 72 59 "
    "72 68 44 72 71 34 34 67 34 104 71 69 72 72 49 60 48 71 65 92 65 65 58 71 37 71 84",
    0x391: "77 76 64 77 68 73 84 85 37 77 77 100 84 63 85 84 73 0 68 68 72 85 77 85 85 37 72 69 56 71 39 68 69 72 68 "
    "69 56 59 71 69 39 71 63 74 68 59 69 79 72 59 78 64 68 78 65 79 87",
    0x410: "77 76 76 64 89 68 122 71 84 84 82 83 100 84 85 84 73 73 68 77 99 77 93 81 124 133 94 104 76 73 117 77 67 "
    "70 63 52 81 68 100 58 70 70 68 73 82 69 69 69 72 59 58 65 99 65 74 69 106 111 75 90 63 59 97 64",
}
"""The advances of the family in hundredths of the size, for each of the characters from a first one on."""
_BY_CATEGORY = {"Mn": 0, "Me": 0, "Cf": 0, "Ll": 70, "Lu": 80, "So": 130}  # of other characters; "So" has emoji
_FULL_WIDTH = 103  # of the rest: a Chinese character, or the mark for one that a font does not have


def make_printable(text: str) -> str:
    """Return the text in one line, with a mark for each character that cannot be printed."""
    return "".join(c if c.isprintable() or c in _JOINERS else UNKNOWN for c in " ".join(text[:_LONGEST].split()))


def width(text: str, size: float, bold: bool = False) -> float:
    """Return the width in points of a text that `make_printable` made: exact for English, Greek and Russian, elsewhere
    rather too much.
    """
    return sum(_advance(c, bold) for c in text) * size / 100


@cache
def _advance(character: str, bold: bool) -> int:
    plain = normalize("NFD", character)[0]  # accents take no room
    for first, advances in (_BOLD if bold else _NORMAL).items():
        known = advances.split()
        if 0 <= ord(plain) - first < len(known):
            return int(known[ord(plain) - first])
    return _BY_CATEGORY.get(category(plain), _FULL_WIDTH)


def wrap_text(text: str, room: float, most: int, size: float, bold: bool) -> list[str]:
    """Return at most so many lines, none wider than `room`; what does not fit ends in an ellipsis."""
    lines: list[str] = []
    words = text[:_BROKEN].split()
    while words:
        line, words = _first_line(words, room, size, bold)
        lines.append(line)
        if len(lines) == most and words:
            lines[-1] = clip_text(f"{line} {' '.join(words)}", room, size, bold)
            break
    return lines or [""]


def clip_text(text: str, room: float, size: float, bold: bool = False) -> str:
    """Return the text, or as much of it as fits with an ellipsis."""
    if width(text, size, bold) <= room:
        return text
    count = _fit(text, room - width("…", size, bold), size, bold)
    return text[:count].rstrip() + "…"


def _first_line(words: list[str], room: float, size: float, bold: bool) -> tuple[str, list[str]]:
    count = 0
    while count < len(words) and width(" ".join(words[: count + 1]), size, bold) <= room:
        count += 1
    if count:
        return " ".join(words[:count]), words[count:]
    cut = max(1, _fit(words[0], room, size, bold))  # a word that is wider than a line
    return words[0][:cut], [words[0][cut:], *words[1:]]


def _fit(text: str, room: float, size: float, bold: bool) -> int:
    """Return how many characters from the start fit."""
    used = 0
    for count, character in enumerate(text):
        used += _advance(character, bold)
        if used * size / 100 > room:
            return count
    return len(text)
