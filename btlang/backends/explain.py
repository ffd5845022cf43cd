"""Explanations of a mission: each statement as written, in English whose brackets show the reading, and as a tree."""

from __future__ import annotations

import math
import textwrap
from bisect import bisect_right
from collections.abc import Callable, Iterator

from btlang.printer.fragments import is_longer
from btlang.printer.mission import lines_of, printer_of
from btlang.printer.printer import Printer
from btlang.printer.sentence import statements
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import END_OF_STATEMENT, Words, split
from btlang.tree import ast
from btlang.tree.catalogue import SEQUENCE
from btlang.tree.dump import outline
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon

INDENT = "  "
_READ_AS = f"{INDENT}read as: "
_BRANCH = "├── "
_MORE = "\N{HORIZONTAL ELLIPSIS}"
LEAST_WIDTH = 40
_NO_LIMIT = 10_000


class Statement(Record):
    """A sentence and what it became: its place in the text, its nodes, and what they were lowered to."""

    at: int
    items: tuple[ast.Ast, ...]
    node: Node | None = None  # a fact and an include have none
    joined: str = ""  # the operator of the chain that all statements make


class Understood(Record):
    """A sentence as it was understood: its number, and English whose brackets show it."""

    number: int
    english: str


def understood(mission: ast.Program, tree: Tree, vocabulary: Lexicon, sentences: Sentences) -> list[Understood]:
    """Return every statement and definition, in the order of the text; `sentences` are those of the text as written."""
    printer = printer_of(mission, vocabulary, "all")
    return [
        Understood(each.at, "\n".join(_read_sentence(each, printer, _NO_LIMIT)).removeprefix(_READ_AS))
        for each in _all_statements(mission, tree, sentences)
    ]


def explain_mission(
    mission: ast.Program, tree: Tree, vocabulary: Lexicon, label: Callable[[Node], str], width: int = 100
) -> str:
    """Explain every statement and definition in the order of the text, at most `width` columns wide.

    `tree` is what the mission was compiled to; a line of it that is wider is cut, and its words stand above it.
    """
    width = max(width, LEAST_WIDTH)
    sentences = Sentences(mission.span.source, vocabulary)
    printer = printer_of(mission, vocabulary, "all")
    blocks = []
    for statement in _all_statements(mission, tree, sentences):
        number, written = sentences.written(statement.at)
        lines = textwrap.wrap(f"line {number}: {written}", width, subsequent_indent=INDENT * 2)
        lines += _read_sentence(statement, printer, width)
        if statement.node is not None:
            lines.append("")
            shown = outline(Tree(_prune(statement.node, width // len(_BRANCH))), label)
            lines += [_cut(INDENT + line, width) for line in shown.splitlines()]
        blocks.append("\n".join(lines))
    return "\n\n".join(blocks)


def _all_statements(mission: ast.Program, tree: Tree, sentences: Sentences) -> list[Statement]:
    facts = [Statement(sentences.number(part.span.start), (part,)) for part in (*mission.includes, *mission.facts)]
    found = [*facts, *_definitions(mission, tree, sentences), *_commands(mission.body, tree.root, sentences)]
    return sorted(found, key=lambda statement: statement.at)


def _definitions(mission: ast.Program, tree: Tree, sentences: Sentences) -> Iterator[Statement]:
    roots = dict(tree.subtrees)
    for definition in mission.definitions:
        yield Statement(sentences.number(definition.name_span.start), (definition,), roots[definition.name])


def _commands(body: ast.Ast | None, root: Node, sentences: Sentences) -> Iterator[Statement]:
    """Yield the commands of a mission by the sentence in which they stand."""
    if body is None:
        return
    items, joined = [item for item, _ in statements(body)], next(statements(body))[1]
    nodes = {}
    for item in items:
        if isinstance(item, ast.Whenever):  # each rule is around those below it, and all are around the other commands
            nodes[id(item)], root = Node(root.id, root.children[:2]), root.children[2]
    others = [item for item in items if id(item) not in nodes]
    nodes |= zip(map(id, others), root.children if len(others) > 1 else [root], strict=False)
    together: dict[int, list[tuple[ast.Ast, Node]]] = {}
    for item in items:
        together.setdefault(sentences.number(item.span.start), []).append((item, nodes[id(item)]))
    for number, pairs in together.items():
        inner = tuple(node for _, node in pairs)
        node = inner[0] if len(inner) == 1 else Node(SEQUENCE, inner)
        yield Statement(number, tuple(item for item, _ in pairs), node, joined)


def _read_sentence(statement: Statement, printer: Printer, width: int) -> Iterator[str]:
    """Return `read as:` and the sentence behind it, or its lines below it."""
    items, joined = statement.items, statement.joined
    whole = items[0] if len(items) == 1 else ast.Chain(joined, items, False, items[0].span)
    said = printer.say(whole)
    room = width - len(_READ_AS)
    if not said.in_lines and not is_longer(said.fragments, room):
        line = printer.line(whole, said, joined if len(items) == 1 else "")
        if len(line) <= room:
            yield _READ_AS + line
            return
    yield _READ_AS.rstrip()
    for item in items:
        for part in lines_of(item, printer, width - 2 * len(INDENT), joined):
            text = part.lstrip(" ")
            indent = INDENT * 2 + " " * (len(part) - len(text))
            yield from textwrap.wrap(
                text, width, initial_indent=indent, subsequent_indent=indent + INDENT * 2, break_on_hyphens=False
            )


def _prune(root: Node, most: int) -> Node:
    """Return the tree without what is deeper than any line can show: drawing that costs the square of its depth."""

    def parts(item: tuple[Node, int]) -> list[tuple[Node, int]]:
        node, depth = item
        return [(child, depth + 1) for child in node.children] if depth < most else []

    def combine(item: tuple[Node, int], done: list[Node]) -> Node:
        node, depth = item
        if depth < most:
            return Node(node.id, tuple(done), node.ports, node.name, node.span)
        return Node(_MORE) if node.children else node

    return fold((root, 0), parts, combine)


def _cut(line: str, width: int) -> str:
    return line if len(line) <= width else line[: width - 1] + _MORE


class Sentences:
    """The sentences of a text: what is between line ends, `;` and full stops outside brackets and blocks."""

    def __init__(self, source: Source, vocabulary: Lexicon) -> None:
        self._words: Words = split(source, vocabulary.orthography)
        self._sentences: list[tuple[int, int, int]] = []  # first character, first word, the word at which it ends
        words = self._words
        for line in words.lines:
            if line.indent == words.lines[0].indent:
                self._add(line.first, line.last)

    def _add(self, first: int, last: int) -> None:
        """Add the sentences of a line; of one with a block, its first line."""
        words, depth = self._words, 0
        for at in range(first, last + 1):
            word = words.words[at]
            depth += (word == "(") - (word == ")")
            if at == last or (word == END_OF_STATEMENT and depth <= 0):
                if at > first:
                    self._sentences.append((words.starts[first], first, at))
                first = at + 1

    def __len__(self) -> int:
        return len(self._sentences)

    def number(self, offset: int) -> int:
        """Return the sentence that a character belongs to, counted from 0."""
        return bisect_right(self._sentences, (offset, math.inf, 0)) - 1

    def reach(self, number: int) -> tuple[int, int]:
        """Return the characters of a sentence, with the block below it."""
        text = self._words.source.text
        end = self._sentences[number + 1][0] if number + 1 < len(self._sentences) else len(text)
        return self._words.begin(self._sentences[number][1]), end

    def written(self, number: int) -> tuple[int, str]:
        """Return the line (from 1) and the text of a sentence."""
        words, (_, first, last) = self._words, self._sentences[number]
        start = words.begin(first)
        end = words.ends[last if words.words[last] == END_OF_STATEMENT else last - 1]
        return words.source.position(start)[0], words.source.text[start:end]
