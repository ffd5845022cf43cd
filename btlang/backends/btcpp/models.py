"""TreeNodesModel and IDs of trees: what editors such as Groot2 need to know.

They need models of nodes that BehaviorTree.CPP doesn't have itself. BehaviorTree.CPP 4.10 and Groot2 refuse some IDs of
trees that a mission may use, such as those with spaces.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from btlang.frontends.btcpp.models import nav2_models
from btlang.frontends.btcpp.origin import Element
from btlang.frontends.btcpp.spelling import AUTOREMAP, IN_3, IN_NO_ID, KINDS, MAIN_TREE, MODEL, TRUE
from btlang.tree.catalogue import BEHAVIOR_TREE_CPP, CATALOGUE, SUBTREE
from btlang.tree.node import Node, NodeModel, PortModel, Tree
from btlang.vocabulary.entry import COMPARISONS, MEASURED, Entry
from btlang.vocabulary.lexicon import Lexicon

_BUILT_IN = frozenset(kind.id for kind in CATALOGUE.values() if kind.origin == BEHAVIOR_TREE_CPP)
_REFUSED = re.compile(f"[{IN_NO_ID}{{}}]+")
"""Also braces, which they take; but a name in braces looks like a reference."""
_RESERVED = frozenset(("", "Root", "root", *KINDS, *CATALOGUE))


class Uses:
    """The nodes of a tree that need a model, with their kinds and models."""

    def __init__(self, tree: Tree, vocabulary: Lexicon, dialect: int) -> None:
        self._vocabulary = vocabulary
        self._known = {model.id: model for model in tree.models}
        self._own = IN_3 | {SUBTREE} if dialect == 3 else _BUILT_IN
        self._ports: dict[str, dict[str, None]] = {}  # those in use, by the id of a node
        self._most: dict[str, int] = {}  # children
        self._given: dict[str, set[str]] = {}  # ports that all SubTree nodes of a tree have, by its name
        self.misnamed: list[Node] = []
        """Nodes with a port whose name XML has another use for."""
        for node in tree.walk():
            if node.id not in self._own:
                self._add(node)
            elif node.id == SUBTREE and dialect == 4:
                self._add_use(node)
            for key, _ in node.ports:
                if key == "name":
                    self.misnamed.append(node)
        strange = [
            node_id for node_id in self._ports if not vocabulary.entry(node_id) and not self._is_described(node_id)
        ]
        for model in nav2_models(strange).values() if strange else ():
            if self._known.get(model.id, model).kind == model.kind:
                self._known[model.id] = model
        self._trees = {name for name, _ in tree.subtrees} | {tree.name}
        self._kinds: dict[str, str] = {}
        self._types: dict[str, dict[str, str]] = {}

    @property
    def ids(self) -> list[str]:
        """The ids of those nodes."""
        return list(self._ports)

    def _is_described(self, node_id: str) -> bool:
        """Whether more is known of a node than a mission shows: its kind and its outputs."""
        model = self._known.get(node_id)
        return model is not None and (bool(model.text) or any(port.type or port.text for port in model.ports))

    def _add(self, node: Node) -> None:
        ports = self._ports.setdefault(node.id, {})
        for key, _ in node.ports:
            if key[:1] != "_" and key != "ID":
                ports[key] = None
        self._most[node.id] = max(self._most.get(node.id, 0), len(node.children))

    def _add_use(self, node: Node) -> None:
        if node.port(AUTOREMAP) not in TRUE:
            name, ports = node.port("ID"), {key for key, _ in node.ports}
            self._given[name] = self._given.get(name, ports) & ports

    def kind(self, node_id: str) -> str:
        """Return Action, Condition, Control or Decorator: as declared, else as it is used."""
        found = self._kinds.get(node_id)
        if found is None:
            found = self._kinds[node_id] = self._kind(node_id)
        return found

    def _kind(self, node_id: str) -> str:
        model = self._known.get(node_id)
        if model is not None and model.kind in KINDS:
            return model.kind
        built_in = CATALOGUE.get(node_id)
        if built_in is not None:
            return built_in.kind
        entry = self._vocabulary.entry(node_id)
        if entry is not None:
            return entry.sort.capitalize()
        return ("Action", "Decorator", "Control")[min(self._most.get(node_id, 0), 2)]

    def models(self) -> list[NodeModel]:
        """Return a model for each node, in an order that doesn't change with the tree: by kind, then by id."""
        found = [self._model(node_id) for node_id in self._ports]
        subtrees = [self._subtree(m) for m in self._known.values() if m.kind == SUBTREE and m.id in self._trees]
        return sorted(found, key=lambda m: (KINDS.index(m.kind), m.id)) + sorted(subtrees, key=lambda m: m.id)

    def _subtree(self, model: NodeModel) -> NodeModel:
        """Return the model without ports that a node leaves out: BehaviorTree.CPP would set their defaults, or refuse
        the node.
        """
        given = self._given.get(model.id)
        return model if given is None else model.replace(ports=tuple(p for p in model.ports if p.name in given))

    def port_types(self, node_id: str) -> dict[str, str]:
        """Return the C++ types of the ports of such a node; none for any other."""
        found = self._types.get(node_id)
        if found is None:
            ports = self._model(node_id).ports if node_id in self._ports else ()
            found = self._types[node_id] = {port.name: port.type for port in ports}
        return found

    def _model(self, node_id: str) -> NodeModel:
        model = self._known.get(node_id)
        if model is None or model.kind not in KINDS or not self._is_described(node_id):
            outputs = model.ports if model is not None and model.kind in KINDS else ()
            entries = self._vocabulary.entries.get(node_id, [])
            ports = [*outputs, *(port for entry in entries for port in self._entry_ports(entry))]
            built_in = CATALOGUE.get(node_id)
            text = entries[0].help if entries else built_in.text if built_in is not None else ""
            model = NodeModel(self.kind(node_id), node_id, tuple({port.name: port for port in ports}.values()), text)
        named = {port.name for port in model.ports}
        used = tuple(PortModel(name) for name in self._ports[node_id] if name not in named)
        return model.replace(ports=model.ports + used) if used else model

    def _entry_ports(self, entry: Entry) -> Iterator[PortModel]:
        """Give the ports of an entry. Those that its words may leave out have an empty default."""
        needed = entry.needed_slots
        for slot in entry.slots:
            direction = "output" if slot.name in entry.outputs else "input"
            may_lack = slot.default is None and direction == "input" and slot.name not in needed
            yield PortModel(slot.name, direction, self._type(slot.type), "" if may_lack else slot.default)
        if entry.measures:
            kind = self._type(entry.measures)
            yield from (PortModel(name, "input", kind, "") for name in COMPARISONS)
            yield PortModel(MEASURED, "output", kind)

    def _type(self, name: str) -> str:
        """Return the type in C++; what isn't a number is a text."""
        kind = self._vocabulary.types.get(name)
        if kind is None or kind.kind not in ("quantity", "number"):
            return "std::string"
        return "int" if kind.whole else "double"


def model_part(models: list[NodeModel], ids: dict[str, str]) -> Element | None:
    """Return TreeNodesModel, None if there are no models."""
    if not models:
        return None
    return Element(MODEL, (), tuple(_element(model, ids) for model in models))


def _element(model: NodeModel, ids: dict[str, str]) -> Element:
    inner = [_port(port) for port in model.ports]
    if model.text:
        inner.append(Element("MetadataFields", (), (Element("Metadata", (("description", model.text),)),)))
    node_id = ids.get(model.id, model.id) if model.kind == SUBTREE else model.id
    return Element(model.kind, (("ID", node_id),), tuple(inner))


def _port(port: PortModel) -> Element:
    pairs = (("name", port.name), ("type", port.type or None), ("default", port.default))
    attributes = tuple((key, text) for key, text in pairs if text is not None)
    return Element(f"{port.direction}_port", attributes, (port.text,) if port.text else ())


def tree_ids(tree: Tree, leaves: Iterable[str], dialect: int) -> dict[str, str]:
    """Return the ID of each tree by its name, "" being the name of a main tree without one.

    No two are the same, none is the id of a node, and in format 4 each keeps to the rules.
    """
    ids = {tree.name: tree.name or MAIN_TREE}
    taken = {*_RESERVED, *leaves}
    wanted = [tree.name or MAIN_TREE, *(name for name, _ in tree.subtrees)]
    for at, name in enumerate(wanted):
        # an ID that needs no change keeps its underscores at the ends
        plain = _REFUSED.sub("_", name).strip("_") if dialect == 4 and _REFUSED.search(name) else name
        made = plain or "tree"
        number = 2
        while made in taken:
            made = f"{plain or 'tree'}_{number}"
            number += 1
        taken.add(made)
        ids[tree.name if at == 0 else name] = made
    return ids
