"""Nodes that no phrase says, by their ids: `do "OpenGripper" called "first" with width 0.05`, `do recovery node:`.

What is said is read back as it stands, by btlang/frontends/mission/symbols/nodes.py.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from btlang.printer.pieces import COLON, Pieces, mark
from btlang.printer.printer import WHOLE, Doc, Printer
from btlang.tree import ast
from btlang.tree.catalogue import SUBTREE
from btlang.vocabulary.lexicon import Lexicon

_BARE = re.compile(r"-?\d+(\.\d+)?|\{[A-Za-z_][A-Za-z0-9_]*\}")
_WORDS = re.compile(r"[a-z][a-z0-9]*(_[a-z][a-z0-9]*)*")
# A text as pieces: what double quotes can hold, marks that would end it, and what no quotes can hold.
_PIECE = re.compile(r'(?P<plain>[^"“”„«»\x00-\x1f\x7f\ufeff]+)|(?P<marks>["“”„«»]+)|(?P<odd>.)', re.DOTALL)


def exact(node: ast.Exact, _parts: list[Doc], printer: Printer) -> Doc:
    """A node without children is a command; one with children needs lines."""
    head = mark(node_head(node, printer.vocabulary))
    if not node.items:
        return Doc((head,), WHOLE)
    return Doc((head, mark(COLON)), WHOLE, in_lines=True)


def exact_block(node: ast.Exact, printer: Printer) -> Iterator[tuple[Pieces, Iterator[tuple[ast.Ast, str]]]]:
    """Its words, and its children as the lines below it."""
    if node.items:
        yield (mark(node_head(node, printer.vocabulary)),), ((item, "children") for item in node.items)


def node_head(node: ast.Exact, vocabulary: Lexicon) -> str:
    """The node with its name and its ports, without its children."""
    ports = list(node.ports)
    parts = [vocabulary.word("test" if node.is_condition else "do")]
    words, subtree = vocabulary.nodes.get(node.id), dict(ports).get("ID")
    if words is None or (node.id == SUBTREE and subtree is None):
        parts.append(quoted(node.id, vocabulary))
    else:
        parts.append(words)
        if node.id == SUBTREE and subtree is not None:
            parts.append(quoted(subtree, vocabulary))
            ports.remove(("ID", subtree))
    if node.name:
        parts += [vocabulary.word("called"), quoted(node.name, vocabulary)]
    for name, text in ports:
        key = name.replace("_", " ") if _is_words(name, vocabulary) else quoted(name, vocabulary)
        value = text if _BARE.fullmatch(text) else quoted(text, vocabulary)
        parts += [vocabulary.word("with"), key, value]
    return " ".join(parts)


def quoted(text: str, vocabulary: Lexicon) -> str:
    """A text as pieces in quotes, `newline` and `character 9`."""
    return " ".join(_pieces(text, vocabulary)) or '""'


def is_one_piece(text: str) -> bool:
    """Whether one pair of quotes can hold a text, as those around names of subtrees and of ports must."""
    return len(list(_PIECE.finditer(text))) == 1 and _PIECE.match(text).lastgroup != "odd"  # type: ignore[union-attr]


def _pieces(text: str, vocabulary: Lexicon) -> Iterator[str]:
    for piece in _PIECE.finditer(text):
        if piece.lastgroup == "plain":
            yield f'"{piece.group()}"'
        elif piece.lastgroup == "marks":
            yield f"'{piece.group()}'"
        elif piece.group() == "\n":
            yield vocabulary.word("newline")
        else:
            yield f"{vocabulary.word('character')} {ord(piece.group())}"


def _is_words(name: str, vocabulary: Lexicon) -> bool:
    """Whether its words are read back as this name."""
    if not _WORDS.fullmatch(name):
        return False
    others = {phrase.split()[0] for role in ("newline", "character") for phrase in vocabulary.roles[role]}
    return not any(word in others or word in vocabulary.articles for word in name.split("_"))
