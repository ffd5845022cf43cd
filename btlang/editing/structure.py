"""The structure of a text as editors show it: lines that fold, brackets of its reading, the tree of a statement."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.editing.reading import TextReading
from btlang.support.record import Record
from btlang.tree import ast
from btlang.tree.node import Node, Tree

_MOST_LINES = 40  # of a tree beside a place


class Bracket(Record):
    """A bracket that the text could have before a character, which shows how it is read."""

    at: int
    text: str


def folds(text: str) -> list[tuple[int, int]]:
    """Return the first and the last line, from 0, of each block that is indented under a line, and of comments."""
    found: list[tuple[int, int]] = []
    open_blocks: list[tuple[int, int]] = []  # margin and line
    comments: list[int] = []  # lines in a row
    last = -1
    for number, line in enumerate([*text.split("\n"), "."]):
        words = line.strip()
        if words[:1] == "#":  # in a block, wherever it begins
            comments.append(number)
            continue
        if len(comments) > 1:
            found.append((comments[0], comments[-1]))
        comments = []
        if not words:
            continue
        margin = len(line) - len(line.lstrip())
        while open_blocks and open_blocks[-1][0] >= margin:
            _, first = open_blocks.pop()
            if last > first:
                found.append((first, last))
        open_blocks.append((margin, number))
        last = number
    return sorted(found)


def reading_brackets(read: TextReading) -> list[Bracket]:
    """Return brackets round the commands and conditions that belong together in a line although nothing says so but the
    rules for `and`, `or`, `then`, lists, and forms behind a command.
    """
    program = read.mission.syntax if read.mission is not None else None
    if program is None:
        return []
    found: list[tuple[int, int, int, str]] = []
    for start, end in sorted(set(_joined(program, read))):
        size = end - start
        found += [(start, 1, -size, "("), (end, 0, size, ")")]
    return [Bracket(at, text) for at, _, _, text in sorted(found)]


def _joined(program: ast.Program, read: TextReading) -> Iterator[tuple[int, int]]:
    """Yield the characters of chains in other nodes, and of forms in chains, that have no brackets."""
    text, source = read.source.text, read.source
    for body in ast.bodies(program):
        for node in ast.parents_first(body):
            for part in ast.parts(node):
                spans = [item.span for item in ast.parts(part)]
                if not spans or any(span.source is not source for span in (part.span, *spans)):
                    continue
                start, end = min(span.start for span in spans), max(span.end for span in spans)
                if not isinstance(part, ast.Chain):
                    if not isinstance(node, ast.Chain) or part.span.start < start or part.span.end <= end:
                        continue
                    end = part.span.end
                if "\n" not in text[start:end] and not _is_apart(text, start, end):
                    yield start, end


def _is_apart(text: str, start: int, end: int) -> bool:
    """Return whether brackets, or the ends of a line, are round the characters already."""
    before, behind = text[:start].rstrip(" \t")[-1:], text[end:].lstrip(" \t")[:1]
    return (before == "(" and behind == ")") or (before in ("", "\n") and behind in ("", "\n"))


def statement_tree(read: TextReading, at: int) -> str:
    """Draw the tree of the statement at a character of a mission or a tree, "" where there is none."""
    mission = read.mission
    if mission is None:
        return ""
    best: Node | None = None
    for root in (mission.tree.root, *(node for _, node in mission.tree.subtrees)):
        stack = [root]
        while stack:
            node = stack.pop()
            span = node.span
            if span is None or span.source is not read.source or not span.start <= at <= span.end:
                stack += node.children if span is None or span.source is not read.source else ()
                continue
            if "\n" in span.text.strip() and node.children:
                inner = [each for each in node.children if each.span is not None and each.span.source is read.source]
                under = [each for each in inner if each.span is not None and each.span.start <= at <= each.span.end]
                if under:
                    stack += under
                    continue
            best = node if best is None or _size(node) < _size(best) else best
    if best is None:
        return ""
    lines = str(mission.replace(tree=Tree(best)).__rich__()).split("\n")
    return "\n".join([*lines[:_MOST_LINES], "…"] if len(lines) > _MOST_LINES else lines)


def _size(node: Node) -> int:
    return node.span.end - node.span.start if node.span is not None else 0
