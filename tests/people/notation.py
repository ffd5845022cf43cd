"""Sentences as people write them, each with the tree that it means, and the notation of those trees.

A sample is the text of a mission, its tree behind `= `, and no blank line:

    Go to the kitchen. Then bring the tea to Alice.
    = S(GoTo place=kitchen, Bring object=tea person=Alice)

A tree is `Id port=value(child, child)`, ports sorted, with S, F, P and RS for the four usual nodes. Lines that two blanks
indent continue it, a line `name := tree` adds a named subtree. `= refused` stands for a mission that must be refused,
with messages that offer the sentences behind `> `. `! warning` follows the tree of a mission that needs a warning, `# `
a remark.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from btlang.record import Record
from btlang.tree.node import Node, Tree

FOLDER = Path(__file__).parent
SHORT = {"Sequence": "S", "Fallback": "F", "Parallel": "P", "ReactiveSequence": "RS"}
_ESCAPES = str.maketrans({"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"})


class Sample(Record):
    """A mission and what it means. `line` is where it begins in its file; `tree` is as `written` gives it, "" if refused."""

    file: str
    line: int
    text: str
    tree: str
    refused: bool
    proposals: tuple[str, ...]
    warned: bool


def written(tree: Tree) -> str:
    """The main tree on one line, then a line `name := tree` for each named subtree, sorted by name."""
    return "\n".join([_node(tree.root), *(f"{name} := {_node(root)}" for name, root in sorted(tree.subtrees))])


def samples() -> list[Sample]:
    """Those of all files, in their order. ValueError names a sample without a tree, or a line that is none of its parts."""
    return [sample for path in sorted(FOLDER.glob("*.txt")) for sample in _samples(path)]


def _node(node: Node) -> str:
    ports = [("name", node.name)] * bool(node.name) + sorted(node.ports)
    children = f"({', '.join(_node(child) for child in node.children)})" if node.children else ""
    return SHORT.get(node.id, node.id) + "".join(f" {key}={_value(text)}" for key, text in ports) + children


def _value(text: str) -> str:
    return text if re.fullmatch(r'[^\s"=\\(),]+', text) else '"' + text.translate(_ESCAPES) + '"'


def _samples(path: Path) -> Iterator[Sample]:
    text = path.read_text(encoding="utf-8")
    for match in re.finditer(r"(?:.+\n)+", text):
        line = text.count("\n", 0, match.start()) + 1
        mission, found, parts = match[0].partition("\n= ")
        if not found:
            raise ValueError(f"{path.name}:{line}: no tree")
        yield _sample(path.name, line, mission, parts.splitlines())


def _sample(file: str, line: int, text: str, parts: list[str]) -> Sample:
    trees = parts[:1]
    proposals = []
    for part in parts[1:]:
        if part.startswith("  "):
            trees[-1] += " " + part.strip()
        elif part.startswith("> "):
            proposals.append(part[2:])
        elif " := " in part:
            trees.append(part)
        elif part != "! warning" and not part.startswith("# "):
            raise ValueError(f"{file}:{line}: {part!r} is no part of a sample")
    refused = trees == ["refused"]
    return Sample(
        file, line, text, "" if refused else "\n".join(trees), refused, tuple(proposals), "! warning" in parts
    )
