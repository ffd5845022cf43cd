"""Which version of BehaviorTree.CPP a file is for: if it doesn't declare one, its nodes and ports decide."""

from __future__ import annotations

from btlang.frontends.btcpp.scan import Document
from btlang.frontends.btcpp.spelling import AUTOREMAP, AUTOREMAP_3, PORTS_TO_4, SHARED, TO_4, without_dollar
from btlang.tree.catalogue import BEHAVIOR_TREE_CPP, CATALOGUE, POST_CONDITIONS, PRE_CONDITIONS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Shape: TypeAlias = tuple[str, ...]
    """A tag and the names of its attributes."""

ONLY_IN_3 = frozenset((
    "BlackboardCheckBool", "BlackboardCheckDouble", "BlackboardCheckInt", "BlackboardCheckString", "ManualSelector",
))  # fmt: skip
"""Nodes of BehaviorTree.CPP that format 4 doesn't have, under any name."""
_NODES = {
    3: TO_4.keys() | ONLY_IN_3 - {"ManualSelector"},
    4: frozenset(
        kind.id
        for kind in CATALOGUE.values()
        if kind.id not in kind.tags_3 and kind.origin == BEHAVIOR_TREE_CPP and not kind.is_common_name
    ),
}
"""Tags that only one version has. Kind tags decide nothing: `<Action ID="Script"/>` may be somebody's own node."""
_KEYS = {
    3: frozenset((SHARED, AUTOREMAP_3)),
    4: frozenset((AUTOREMAP, *PRE_CONDITIONS, *POST_CONDITIONS)),
}
_PORTS: dict[int, dict[str, frozenset[str]]] = {
    3: {node_id: frozenset((*names, "threshold")) for node_id, names in PORTS_TO_4.items()},
    4: {node_id: frozenset(names.values()) for node_id, names in PORTS_TO_4.items()}
    | {kind.id: frozenset(kind.ports) for kind in CATALOGUE.values() if kind.is_common_name},
}
_NONE: frozenset[str] = frozenset()


def dialect_of(document: Document, within: int = 3) -> int:
    """3 or 4: by BTCPP_format, else by the nodes, else `within`, the version of the file that includes it."""
    declared = document.attributes(0).get("BTCPP_format")
    if declared is not None:
        return 3 if declared.strip().startswith("3") else 4
    elements = document.elements
    if "${" in document.text and any(without_dollar(text) != text for _, flat, _, _ in elements for text in flat[1::2]):
        return 3
    return dialect_of_shapes({(tag, *flat[::2]) for tag, flat, _, _ in elements}) or within


def dialect_of_shapes(shapes: set[Shape]) -> int:
    """3 where something is only in version 3, else 4 where something is only in version 4, else 0."""
    return next((version for version in (3, 4) if any(_is_only_in(version, *shape) for shape in shapes)), 0)


def _is_only_in(version: int, tag: str, *keys: str) -> bool:
    if tag in _NODES[version] or not _KEYS[version].isdisjoint(keys):
        return True
    return not _PORTS[version].get(tag, _NONE).isdisjoint(keys)
