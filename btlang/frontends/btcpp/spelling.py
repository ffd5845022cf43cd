"""How a node is written: the one place that knows the canonical tags and attributes of both dialects."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from btlang.tree.catalogue import CATALOGUE, POST_CONDITIONS, PRE_CONDITIONS, SUBTREE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Pairs: TypeAlias = tuple[tuple[str, str], ...]
    Spelling: TypeAlias = tuple[str, Pairs]
    """A tag and its attributes."""

KINDS = ("Action", "Condition", "Control", "Decorator")
"""Tags that declare the kind of the node that their attribute ID names; TreeNodesModel has them in this order."""
MAIN_TREE = "MainTree"
"""The ID of the main tree where it has no name of its own."""
MODEL = "TreeNodesModel"

_IN_3 = {kind.id: kind.tags_3 for kind in CATALOGUE.values() if kind.tags_3}
TO_4 = {tag: node_id for node_id, tags in _IN_3.items() for tag in tags if tag != node_id}
"""Names that nodes had before format 4."""
TO_3 = {node_id: tags[0] for node_id, tags in _IN_3.items() if tags[0] != node_id}
"""And back."""
_PORTS = {kind.id: {name: port.name_3 for name, port in kind.ports.items() if port.name_3}
          for kind in CATALOGUE.values()}  # fmt: skip
_PORTS_TO_3 = {node_id: names for node_id, names in _PORTS.items() if names}
PORTS_TO_4 = {node_id: {old: new for new, old in names.items()} for node_id, names in _PORTS_TO_3.items()}
IN_3 = frozenset(_IN_3.keys() - {SUBTREE})
"""The nodes of version 3 that have a tag of their own, under their names of format 4."""
_, _SUBTREE_PLUS = CATALOGUE[SUBTREE].tags_3
SHARED = "__shared_blackboard"
AUTOREMAP_3 = "__autoremap"
AUTOREMAP = "_autoremap"
TRUE = frozenset(("1", "true", "TRUE", "True"))
_OF_NODES = frozenset((AUTOREMAP, AUTOREMAP_3, SHARED, *PRE_CONDITIONS, *POST_CONDITIONS))

IN_NO_ID = r"""\x00-\x20\x7f<>&"'/\\:*?|."""
"""Characters that BehaviorTree.CPP refuses in IDs (its docs/name_validation_rules.md), for a set of a pattern."""
_NAME = re.compile(r"[^\W\d][\w.\-]*")  # of the names that XML allows, those without a colon


def is_xml_name(text: str) -> bool:
    """Whether a text can be a tag or the name of an attribute."""
    return _NAME.fullmatch(text) is not None


def is_editors(attribute: str) -> bool:
    """Whether an attribute is one that editors write for themselves, such as `_uid` or `_collapsed`, and no port."""
    return attribute[:1] == "_" and attribute not in _OF_NODES


def is_reference(text: str) -> bool:
    """Whether the text of a port is one reference `{key}`."""
    return len(text) > 2 and text[0] == "{" and text[-1] == "}" and "{" not in text[1:] and "}" not in text[:-1]


def without_dollar(text: str) -> str:
    """`${key}` is the form of `{key}` before format 4."""
    return text[1:] if text[:2] == "${" and text[-1:] == "}" and len(text) > 3 else text


def spelled_4(node: Node, kind: Callable[[str], str], written: Mapping[str, str]) -> Spelling:
    """A node in format 4. `kind` gives the kind of an id, `written` the IDs of trees whose names cannot be IDs."""
    named = (("name", node.name),) if node.name else ()
    if node.id == SUBTREE:
        return SUBTREE, _subtree(node, named, node.ports, written)
    if node.id in KINDS or not is_xml_name(node.id):
        return kind(node.id), (("ID", node.id), *named, *node.ports)
    return node.id, named + node.ports


def spelled_3(node: Node, kind: Callable[[str], str], written: Mapping[str, str]) -> Spelling:
    """In the dialect of version 3."""
    named = (("name", node.name),) if node.name else ()
    if node.id == SUBTREE:
        return _subtree_3(node, named, written)
    if node.id in IN_3:
        ports = node.ports
        if node.id in _PORTS_TO_3:
            older = _PORTS_TO_3[node.id]
            ports = tuple((older.get(key, key), text) for key, text in ports)
        return TO_3.get(node.id, node.id), named + ports
    if is_xml_name(node.id) and node.id not in KINDS and any(key == "ID" for key, _ in node.ports):
        return node.id, named + node.ports
    return kind(node.id), (("ID", node.id), *named, *node.ports)


def _subtree(node: Node, named: Pairs, ports: Sequence[tuple[str, str]], written: Mapping[str, str]) -> Pairs:
    name = node.port("ID")
    others = tuple(port for port in ports if port[0] != "ID")
    return (("ID", written.get(name, name)), *named, *others)


def _subtree_3(node: Node, named: Pairs, written: Mapping[str, str]) -> Spelling:
    """SubTree where all ports are references, which it writes without braces; SubTreePlus for all else."""
    others = [port for port in node.ports if port[0] != "ID"]
    if all(is_reference(text) and key[:1] != "_" and text != "{=}" for key, text in others):
        return SUBTREE, _subtree(node, named, [(key, text[1:-1]) for key, text in others], written)
    renamed = [(AUTOREMAP_3 if key == AUTOREMAP else key, text) for key, text in others]
    return _SUBTREE_PLUS, _subtree(node, named, renamed, written)


SPELL = {3: spelled_3, 4: spelled_4}
