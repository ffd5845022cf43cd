"""Lines of a text: which belong to a statement, and where comments are."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Sequence

from btlang.text.source import Source
from btlang.text.words import Orthography, split
from btlang.tree import ast

_MARGIN = re.compile(r"[ \t\r\ufeff]*")
_MARK = re.compile(r"\s*(?:[-*\u2022\u2013\u2014]|\d{1,3}[.)])?\s*")
_OPENS = re.compile(r"[:(]")


class Lines:
    """The lines of one text, counted from 1. `nodes` is the syntax of the text, parents first."""

    def __init__(self, source: Source, nodes: Iterable[ast.Ast], orthography: Orthography) -> None:
        self.source = source
        self.count = source.text.count("\n") + 1
        words = split(source, orthography)
        self.comments = {source.position(span.start)[0]: span for span in words.comments}
        self.blocks = {source.position(words.starts[line.first])[0] for line in words.lines}
        """The lines that have words."""
        self._brackets = [
            (start, word) for word, start in zip(words.words, words.starts, strict=True) if word in ("(", ")")
        ]
        self._first: dict[int, int] = {}
        self._last: dict[int, int] = {}
        for node in nodes:
            if node.span.source is source and not isinstance(node, ast.Program):
                start, end = self.place(node)
                line, _ = source.position(start)
                self._first[line] = min(start, self._first.get(line, start))
                line, _ = source.position(end)
                self._last[line] = max(end, self._last.get(line, end))

    def place(self, node: ast.Ast) -> tuple[int, int]:
        """Return the characters of a node; where it has one bracket of a pair, with the other one: `(A) twice`."""
        start, end = node.span.start, node.span.end
        first, last = bisect_left(self._brackets, (start, "")), bisect_left(self._brackets, (end, ""))
        opened = missing = 0
        for _, word in self._brackets[first:last]:
            opened += 1 if word == "(" else -1
            missing = max(missing, -opened)
        if missing:
            start = self._brackets[max(first - missing, 0)][0]
        if opened + missing > 0:
            end = self._brackets[min(last + opened + missing, len(self._brackets)) - 1][0] + 1
        return start, end

    def text(self, node: ast.Ast) -> str:
        """Return the words of lines."""
        start, end = self.place(node)
        return self.source.text[start:end]

    def margin(self, line: int) -> str:
        """Return the blanks before the words of a line."""
        found = _MARGIN.match(self.source.line(line))
        return found.group() if found is not None else ""

    def own(self, node: ast.Ast, around: ast.Ast) -> range | None:
        """Return the lines that are a statement's own, with the head of its block; None if something else stands there,
        too.

        `around` is what it stands in.
        """
        source, (start, end) = self.source, self.place(node)
        first, last = source.position(start)[0], source.position(end)[0]
        if node.span.source is not source or self._first.get(first) != start or self._last.get(last) != end:
            return None
        before = source.text[source.offset(first) : start]
        is_step = isinstance(around, ast.Chain | ast.Program) and getattr(around, "operator", "sequence") == "sequence"
        if _OPENS.search(before) or not (is_step or _MARK.fullmatch(before)):  # such as `otherwise`
            return None
        head = self._head(node, first, around)
        return None if head is None else range(head, last + 1)

    def with_comments(self, lines: range) -> range:
        """Return lines with the comments right above, but for those at the beginning of the text."""
        first = lines.start
        while first - 1 in self.comments and first - 1 not in self.blocks:
            first -= 1
        return lines if first == 1 else range(first, lines.stop)

    def texts(self, lines: range) -> list[str]:
        """Return lines without the margin of the first one that has words."""
        margin = self.margin(next((line for line in lines if line in self.blocks), lines.start))
        texts = [self.source.line(line) for line in lines]
        return [text[len(margin) :] if text.startswith(margin) else text.lstrip() for text in texts]

    def offsets(self, lines: range) -> tuple[int, int]:
        """Return where lines begin, and where what follows them does."""
        text = self.source.text
        end = text.find("\n", self.source.offset(lines.stop - 1)) if lines else -1
        start = self.source.offset(lines.start) if lines.start <= self.count else len(text)
        return start, start if not lines else len(text) if end < 0 else end + 1

    def _head(self, node: ast.Ast, first: int, around: ast.Ast) -> int | None:
        """Return the line where a statement begins: one above, if it's a block whose head is no part of what was
        read.
        """
        source = self.source
        if not isinstance(node, ast.Chain) or not node.bracketed or source.text.startswith("(", node.span.start):
            return first
        head = next((line for line in range(first - 1, 0, -1) if line in self.blocks), 0)
        inside = head and len(self.margin(head)) < len(self.margin(first))
        if not inside or source.position(around.span.start)[0] == head:
            return first if not inside or not isinstance(around, ast.Chain) else None
        return head


def comments_in(text: str, orthography: Orthography) -> Counter[str]:
    """Return how often a text has each comment."""
    return Counter(span.text.rstrip() for span in split(Source(text), orthography).comments)


def indented(lines: Sequence[str], margin: str) -> str:
    """Return lines behind a margin, each with its end."""
    return "".join(f"{margin}{line}\n" if line else "\n" for line in lines)
