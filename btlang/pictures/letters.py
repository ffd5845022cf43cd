"""Text in pictures: what the font can show, how wide it is, and where a long one is broken."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from matplotlib.font_manager import FontProperties

    Measure: TypeAlias = Callable[[str, float, bool], float]
    """Width in points of a line of text of a size in points, bold or not."""

FAMILY = "DejaVu Sans"  # comes with matplotlib
_UNKNOWN = "\N{REPLACEMENT CHARACTER}"
_LONGEST = 400  # characters of a text that are looked at: no picture shows more


@cache
def font(size: float, bold: bool) -> FontProperties:
    """The one font of all pictures."""
    from matplotlib.font_manager import FontProperties

    return FontProperties(family=FAMILY, size=size, weight="bold" if bold else "normal")


@cache
def _known() -> frozenset[str]:
    from matplotlib.font_manager import findfont, get_font

    return frozenset(map(chr, get_font(findfont(font(10, False))).get_charmap()))


def shown(text: str) -> str:
    """The text in one line, with a mark for each character that the font does not have."""
    known = _known()
    return "".join(c if c in known and c.isprintable() else _UNKNOWN for c in " ".join(text[:_LONGEST].split()))


@cache
def width(text: str, size: float, bold: bool = False) -> float:
    """Points, of a text that `shown` made."""
    from matplotlib.textpath import text_to_path

    return float(text_to_path.get_text_width_height_descent(text, font(size, bold), ismath=False)[0])


def wrapped(text: str, room: float, most: int, size: float, bold: bool, measure: Measure) -> list[str]:
    """At most so many lines, none wider than `room`; what does not fit ends in an ellipsis."""
    lines: list[str] = []
    words = text.split()
    while words:
        line, words = _first_line(words, room, size, bold, measure)
        lines.append(line)
        if len(lines) == most and words:
            lines[-1] = clipped(f"{line} {' '.join(words)}", room, size, bold, measure)
            break
    return lines or [""]


def clipped(text: str, room: float, size: float, bold: bool, measure: Measure) -> str:
    """The text, or as much of it as fits with an ellipsis."""
    if measure(text, size, bold) <= room:
        return text
    count = _fitting(text, room - measure("…", size, bold), size, bold, measure)
    return text[:count].rstrip() + "…"


def _first_line(words: list[str], room: float, size: float, bold: bool, measure: Measure) -> tuple[str, list[str]]:
    count = 0
    while count < len(words) and measure(" ".join(words[: count + 1]), size, bold) <= room:
        count += 1
    if count:
        return " ".join(words[:count]), words[count:]
    cut = max(1, _fitting(words[0], room, size, bold, measure))  # a word that is wider than a line
    return words[0][:cut], [words[0][cut:], *words[1:]]


def _fitting(text: str, room: float, size: float, bold: bool, measure: Measure) -> int:
    low, high = 0, len(text)
    while low < high:
        middle = (low + high + 1) // 2
        if measure(text[:middle], size, bold) <= room:
            low = middle
        else:
            high = middle - 1
    return low
