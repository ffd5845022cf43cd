"""What tinyxml2 reads and strict XML does not, changed to strict XML of the same length.

BehaviorTree.CPP reads its files with tinyxml2, which takes `<` and `&` in attribute values and `--` in comments as they
are, and keeps the line ends and tabs of values. Here such characters give way to others that the text does not hold;
after the parse, `restored` brings them back. The length stays, so that places in the one text are places in the other.
Where no blank stands between two attributes, only `spaced`, the text for the parser, has one.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise

_ODD_VALUE = re.compile(r"""=\s*(?:"[^">\n\r\t]*|'[^'>\n\r\t]*)[>\n\r\t]""")
"""What a strict parser would change in a value, and `>`, which would look like the end of its tag."""
_PARTS = re.compile(
    r"""
    <!--(?P<comment>.*?)-->
    | <!\[CDATA\[.*?\]\]>
    | <\?.*?\?>
    | <!.*?>
    | <(?P<tag>/?[^\s/>"'=<]+ (?:\s++ | /(?!>) | [^\s"'=<>/]++\s*+=\s*+(?:"[^"]*+"|'[^']*+')) *+ ) /?>
    | (?P<text>[^<]+)
    """,
    re.VERBOSE | re.DOTALL,
)
_VALUE = re.compile(r""""[^"]*"|'[^']*'""")
_BEHIND = " \t\r\n/?>"  # what may follow the value of an attribute
_REFERENCE = re.compile(r"&(?!(?:amp|lt|gt|quot|apos|#\d{1,7}|#x[0-9a-fA-F]{1,6});)")
_SWAPPED = "<>&-\n\t\r"
_DECLARED_LATE = re.compile(r"\s+<\?xml\b.*?\?>", re.DOTALL)


class Repaired:
    """A text that an XML parser is given in place of another, and the way back for what it gives."""

    def __init__(self, text: str, swaps: dict[str, str] | None = None, gaps: Sequence[int] = ()) -> None:
        self.text = text
        self.gaps = gaps
        """Places of attributes that stand right behind another one."""
        self._blanks = [place + number for number, place in enumerate(gaps)]
        self._back = str.maketrans({there: here for here, there in (swaps or {}).items()})
        self._line_end = ""
        if swaps:
            self._line_end = swaps["\r"] + swaps["\n"]
            self._back[ord(swaps["\r"])] = "\n"

    @property
    def spaced(self) -> str:
        """The text with a blank in each gap."""
        bounds = (0, *self.gaps, len(self.text))
        return " ".join(self.text[start:end] for start, end in pairwise(bounds))

    def place(self, spaced: int) -> int:
        """The place in the text of one in `spaced`."""
        return spaced - bisect_left(self._blanks, spaced)

    def restored(self, value: str) -> str:
        """A value or comment as it stands in the file; a line end is a newline, as tinyxml2 has it."""
        if not self._line_end:
            return value
        return value.replace(self._line_end, "\n").translate(self._back)


def is_odd(text: str) -> bool:
    """Whether a strict parser could read a value of the text in another way than tinyxml2."""
    if "'" in text:
        return _ODD_VALUE.search(text) is not None
    values = "".join(text.split('"')[1::2])  # where a quote stands elsewhere, parts of tags as well, which have a `>`
    return any(letter in values for letter in ">\n\t\r")


def repaired(text: str) -> Repaired:
    """The text with all repairs; what is beyond repair is left for the parser to complain of."""
    swaps = dict(zip(_SWAPPED, _unused(text), strict=False))
    in_values = str.maketrans({here: there for here, there in swaps.items() if here not in "&-"})
    pieces: list[str] = []
    gaps: list[int] = []
    late = _DECLARED_LATE.match(text)
    done = late.end() if late is not None else 0
    if done:
        pieces.append(re.sub(r"\S", " ", text[:done]))  # strict XML has its declaration first or not at all
    while done < len(text):
        match = _PARTS.match(text, done)
        if match is None:  # the parser will complain of this place
            pieces.append(text[done:])
            break
        piece = match[0]
        comment = match["comment"]
        if match["tag"] is not None or piece.startswith("<?xml"):
            gaps += [done + value.end() for value in _VALUE.finditer(piece) if piece[value.end()] not in _BEHIND]
        if comment is not None and ("--" in comment or comment.endswith("-")):
            piece = f"<!--{comment.replace('-', swaps['-'])}-->"
        elif match["tag"] is not None:
            piece = _VALUE.sub(lambda value: _REFERENCE.sub(swaps["&"], value[0]).translate(in_values), piece)
        elif match["text"] is not None:
            piece = _REFERENCE.sub(swaps["&"], piece)
        pieces.append(piece)
        done = match.end()
    return Repaired("".join(pieces), swaps, gaps)


def _unused(text: str) -> list[str]:
    """Characters for private use that the text does not hold."""
    used = frozenset(text)
    return [letter for letter in map(chr, range(0xE000, 0xF8FF)) if letter not in used][: len(_SWAPPED)]
