"""What stands between two parts of a chain: whether it lets both sides be read in another way."""

from __future__ import annotations

import re
from collections.abc import Sequence

from btlang.text.source import Span
from btlang.tree.ast import Ast
from btlang.vocabulary.lexicon import Lexicon

_LINE_END = re.compile(r"[\n;]|[.!?](?!\w)")
_WORD = re.compile(r"\w")
_QUOTED = re.compile(r'"[^"\n]*"')


class Gaps:
    """The gaps of one chain, whose parts are given in the order of the text."""

    def __init__(self, items: Sequence[Ast], vocabulary: Lexicon) -> None:
        self.items = items
        self._clauses = vocabulary.roles["otherwise"]
        self._openers = tuple(f" {word}" for role in ("either", "both") for word in vocabulary.roles[role])

    def text(self, at: int) -> str:
        """What stands between a part and the one behind it."""
        left, right = self.items[at].span, self.items[at + 1].span
        return left.source.text[left.end : right.start]

    def is_open(self, at: int) -> bool:
        """Whether nothing but a connective stands there: no comma, line end, or word that begins a clause or list."""
        gap = self.text(at)
        return "," not in gap and not self._ends(gap) and not gap.rstrip().lower().endswith(self._openers)

    def is_alone(self, at: int) -> bool:
        """Whether a part is a statement of its own."""
        before, behind = (
            at == 0 or self._ends(self.text(at - 1)),
            at == len(self.items) - 1 or self._ends(self.text(at)),
        )
        return before and behind

    def run(self, at: int) -> tuple[int, int]:
        """The first and the last part of what hangs together around a gap; a comma in a list does not part it."""
        first, last = at, at + 1
        while first > 0 and not self._parts(first - 1):
            first -= 1
        while last + 1 < len(self.items) and not self._parts(last):
            last += 1
        return first, last

    def comma(self, at: int) -> Span:
        """The place, without any character, for a comma before the connective."""
        gap, left = self.text(at), self.items[at].span
        word = _WORD.search(gap)
        place = left.end + len(gap[: word.start() if word else None].rstrip())
        return Span(left.source, place, place)

    def _ends(self, gap: str) -> bool:
        words = " ".join(gap.strip(" ,()").lower().split())
        return bool(_LINE_END.search(gap)) or any(
            words == clause or words.startswith(clause + " ") for clause in self._clauses
        )

    def _parts(self, at: int) -> bool:
        """A comma beside a connective parts; not the last comma of a list: `A, B, and C`."""
        gap = self.text(at)
        if self._ends(gap) or "," not in gap or not _WORD.search(gap):
            return self._ends(gap)
        return at == 0 or "," not in self.text(at - 1) or bool(_WORD.search(self.text(at - 1)))


def balanced(span: Span) -> Span:
    """The span with the brackets around its ends that are opened or closed in it."""
    text, start, end = span.source.text, span.start, span.end
    depth = lowest = 0
    for bracket in re.findall(r"[()]", _QUOTED.sub("", text[start:end])):
        depth += 1 if bracket == "(" else -1
        lowest = min(lowest, depth)
    for _ in range(-lowest):
        start = text.rindex("(", 0, start)
    for _ in range(depth - lowest):
        end = text.index(")", end) + 1
    return Span(span.source, start, end)
