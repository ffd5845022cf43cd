"""Trees as JSON. `tree.schema.json` beside this module defines the form; docs/targets.md describes it for users.

The nodes of a tree are a list, in which a node names its children by their numbers: programs that read JSON do not
have to nest as deep as a tree does.
"""

from __future__ import annotations

import os
import re

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.frontends.json.reader import FORMAT, PORT_KEYS
from btlang.printer.phrase import phrase_of
from btlang.text.source import NOWHERE
from btlang.tree.node import Node, NodeModel, Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SCHEMA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "tree.schema.json")
"""The file of the JSON Schema."""

_LONGEST = 200  # characters of a sentence: that of the root is the whole mission
_UNFIT_WRITTEN = re.compile(r"(?<!\\)(?:\\\\)*\\u0000|[\ud800-\udfff]")


def to_json(tree: Tree, vocabulary: Lexicon) -> str:
    """Return one document, one line a node. `read_json` makes an equal tree; spans are written, but not read back.

    Raises MissionError (BT134) for a text with NUL or a lone surrogate, which `read_json` would refuse.
    """
    import json

    def line(value: object) -> str:
        written = json.dumps(value, ensure_ascii=False)
        if _UNFIT_WRITTEN.search(written):
            reason = "one of its texts contains a NUL or a lone surrogate"
            problem = diagnostic("BT134", tree.root.span or NOWHERE, id=tree.root.id, target="JSON", reason=reason)
            raise MissionError([problem])
        return written

    trees = []
    for name, root in ((tree.name, tree.root), *tree.subtrees):
        nodes = ",\n".join(f"      {line(item)}" for item in _items(root, vocabulary))
        trees.append(f'    {{"name": {line(name)}, "nodes": [\n{nodes}\n    ]}}')
    models = ",\n".join(f"    {line(_model(model))}" for model in tree.models)
    listed = f"[\n{models}\n  ]" if models else "[]"
    all_trees = ",\n".join(trees)
    return f'{{\n  "format": {FORMAT},\n  "trees": [\n{all_trees}\n  ],\n  "models": {listed}\n}}\n'


def _items(root: Node, vocabulary: Lexicon) -> list[dict[str, Any]]:
    """List the nodes in preorder; what is empty is left out, but for the id."""
    items: list[dict[str, Any]] = []
    stack: list[tuple[Node, int]] = [(root, -1)]
    while stack:
        node, above = stack.pop()
        if above >= 0:
            items[above]["children"].append(len(items))
        item: dict[str, Any] = {"id": node.id}
        if node.name:
            item["name"] = node.name
        if node.ports:
            item["ports"] = dict(node.ports)
        if not node.children and node.id in vocabulary.entries:
            item["phrase"] = phrase_of(node, vocabulary)
        if node.span is not None:
            start, end = node.span.start, node.span.end
            item["sentence"] = node.span.source.text[start : min(end, start + _LONGEST)]
            line, column = node.span.source.position(node.span.start)
            item["place"] = {"file": node.span.source.name, "line": line, "column": column}
        if node.children:
            item["children"] = []
            stack += [(child, len(items)) for child in reversed(node.children)]
        items.append(item)
    return items


def _model(model: NodeModel) -> dict[str, Any]:
    ports = []
    for port in model.ports:
        fields = {key: getattr(port, key) for key in PORT_KEYS}
        ports.append({key: value for key, value in fields.items() if value or key == "name"})
        if port.default == "":
            ports[-1]["default"] = ""
    return {"kind": model.kind, "id": model.id, "ports": ports, **({"text": model.text} if model.text else {})}
