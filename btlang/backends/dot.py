"""Trees as graphs for Graphviz."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.printer.phrase import phrase_of
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.dump import describe_node
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon

_LOOKS = {
    "control": 'shape=box, style=filled, fillcolor="#dfe8f3"',
    "decorator": 'shape=hexagon, style=filled, fillcolor="#e8e1f2"',
    "subtree": 'shape=box, peripheries=2, style=filled, fillcolor="#edf2ee"',
    "action": 'shape=box, style="rounded,filled", fillcolor=white',
    "condition": 'shape=ellipse, style=filled, fillcolor="#f4f1e4"',
}
_LONGEST = 60  # characters of a line in a box


def to_dot(tree: Tree, vocabulary: Lexicon) -> str:
    """Return a digraph. Each named subtree is a cluster, to which a dashed edge leads from each SubTree node that uses
    it.

    Nodes are `n0`, `n1` and so on, in the order of Tree.walk.
    """
    trees = ((tree.name, tree.root), *tree.subtrees)
    kinds = {model.id: model.kind.lower() for model in tree.models}
    font = "fontname=Helvetica, fontsize=11"
    lines = ["digraph tree {", f"  graph [ordering=out, compound=true, {font}];", f"  node [{font}];"]
    roots: dict[str, int] = {}
    uses: list[tuple[int, str]] = []
    number = 0
    for at, (name, root) in enumerate(trees):
        roots.setdefault(name, number)
        indent = "  " if at == 0 else "    "
        if at:
            lines += [f"  subgraph cluster_{at} {{", f"    label={_quote(name)};"]
        for index, node, above in _number(root, number):
            kind = _kind(node, vocabulary, kinds)
            lines.append(f"{indent}n{index} [label={_label(node, vocabulary)}, {_LOOKS[kind]}];")
            if above >= 0:
                lines.append(f"{indent}n{above} -> n{index};")
            if node.id == SUBTREE:
                uses.append((index, node.port("ID")))
            number = index + 1
        if at:
            lines.append("  }")
    names = [name for name, _ in trees]
    for index, name in uses:
        if name in names[1:]:
            lines.append(f"  n{index} -> n{roots[name]} [style=dashed, lhead=cluster_{names.index(name, 1)}];")
    return "\n".join([*lines, "}"]) + "\n"


def _number(root: Node, first: int) -> Iterator[tuple[int, Node, int]]:
    """Yield number, node and the number of its parent (-1 for the root), in preorder."""
    stack = [(root, -1)]
    number = first
    while stack:
        node, above = stack.pop()
        yield number, node, above
        stack += [(child, number) for child in reversed(node.children)]
        number += 1


def _kind(node: Node, vocabulary: Lexicon, kinds: dict[str, str]) -> str:
    if node.id == SUBTREE:
        return "subtree"
    known = CATALOGUE.get(node.id)
    if node.children:
        declared = kinds.get(node.id, "")
        decorates = declared == "decorator" if known is None and declared else len(node.children) == 1
        return "decorator" if (known.most == 1 if known is not None else decorates) else "control"
    entry = vocabulary.entry(node.id)
    asks = entry.sort == "condition" if entry is not None else kinds.get(node.id) == "condition"
    return "condition" if asks or (known is not None and known.kind == "Condition") else "action"


def _label(node: Node, vocabulary: Lexicon) -> str:
    plain = not node.children and not any(port.startswith("_") for port, _ in node.ports)
    words = phrase_of(node, vocabulary) if plain else describe_node(node)
    return _quote(words if len(words) <= _LONGEST else words[: _LONGEST - 1] + "\N{HORIZONTAL ELLIPSIS}")


def _quote(text: str) -> str:
    """Return a string of the language: only the quote is escaped there, and a backslash begins an escape of labels."""
    shown = "".join(c if c.isprintable() else " " for c in text)
    return '"' + shown.replace("\\", "\\\\").replace('"', '\\"') + '"'
