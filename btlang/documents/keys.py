"""Which keys of the blackboard a tree reads and sets."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.engine.instance import blackboard_key
from btlang.engine.script.names import READS, SETS, uses_of_names
from btlang.frontends.btcpp.models import nav2_models
from btlang.tree.catalogue import CATALOGUE, KEY, SCRIPT, SUBTREE, held
from btlang.tree.model import NodeModel
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon


class KeyReader:
    """Knows the directions of ports by the models of a project and by the words."""

    def __init__(self, models: Mapping[str, NodeModel], vocabulary: Lexicon) -> None:
        self._models, self._vocabulary = models, vocabulary

    def keys(self, root: Node) -> dict[str, set[str]]:
        """`READS` and `SETS` by key, in the order of the tree."""
        found: dict[str, set[str]] = {}
        for node in Tree(root).walk():
            for port, text in node.ports:
                for key, uses in self._of_port(node, port, text):
                    found.setdefault(key, set()).update(uses)
        return found

    def _of_port(self, node: Node, port: str, text: str) -> list[tuple[str, set[str]]]:
        holds = held(node.id, port)
        if holds == SCRIPT:
            return list(uses_of_names(text).items())
        if holds == KEY:
            return [(text.strip("{} "), {SETS})]
        key = blackboard_key(port, text)
        if key is None or port[:1] == "_":
            return []
        return [(key, {"output": {SETS}, "inout": {READS, SETS}}.get(self._direction(node, port), {READS}))]

    def _direction(self, node: Node, port: str) -> str:
        """Of a SubTree by the model of its tree."""
        id = node.port("ID") if node.id == SUBTREE else node.id
        kind = CATALOGUE.get(id)
        if kind is not None and port in kind.ports:
            return kind.ports[port].direction
        model = self._models.get(id) or nav2_models([id]).get(id)
        declared = next((each.direction for each in model.ports if each.name == port), "") if model is not None else ""
        if declared:
            return declared
        return "output" if any(port in entry.outputs for entry in self._vocabulary.entries.get(id, ())) else "input"
