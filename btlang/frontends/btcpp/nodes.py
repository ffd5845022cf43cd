"""Elements to nodes: names and ports of the older dialect become those of format 4."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.btcpp.scan import Document
from btlang.frontends.btcpp.spelling import (
    AUTOREMAP,
    AUTOREMAP_3,
    IN_3,
    KINDS,
    PORTS_TO_4,
    SHARED,
    SPELL,
    TO_3,
    TO_4,
    TRUE,
    without_dollar,
)
from btlang.text.source import Span
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.spelling import Pairs, Spelling

_ODD = frozenset((*KINDS, *TO_4, SUBTREE))
"""Tags that are not the id of their node, or need a second look."""
_PLAIN_3 = IN_3 - TO_3.keys() - PORTS_TO_4.keys()
_KIND = 2  # entries of `ID="..."`
_RENAMED_OR_OWN = IN_3 | TO_4.keys() | {"", SUBTREE}
_ROOM = 64  # levels; more are added where a tree is deeper


class NodeReader:
    """Makes the nodes of one file. `problems` is what is wrong with them.

    `names` are the trees by the ID that they have in the file. `kinds` are the kinds of nodes by id; those that tags
    declare are added to it. `defaults` are ports that a SubTree of format 4 has where they are not written, by the name
    of its tree.
    """

    def __init__(
        self,
        document: Document,
        dialect: int,
        names: Mapping[str, str],
        kinds: dict[str, str],
        defaults: Mapping[str, Pairs],
    ) -> None:
        self.problems: list[Diagnostic] = []
        self.uses: list[Node] = []
        """The SubTree nodes that were read, from the last to the first."""
        self._document = document
        self._dialect = dialect
        self._names = names
        self._written = {name: written for written, name in names.items()}
        self._kinds = kinds
        self._defaults = defaults
        self._usual = self._usual_tags()

    def read(self, first: int, end: int) -> tuple[Node, dict[int, Spelling]]:
        """The node of element `first`, with all inside it up to element `end`; and what is written in an unusual way.

        Backwards through the file, so that children come before their parents, and without recursion.
        """
        document = self._document
        elements, depths, source, find = document.elements, document.depths, document.source, document.text.find
        usual, kinds = self._usual, self._kinds
        settled: dict[str, str] = {}  # ids whose kind tag is the usual one
        unusual: dict[int, Spelling] = {}
        levels: list[list[Node]] = [[] for _ in range(_ROOM)]  # those that wait for their parents, by depth
        deepest = len(levels) - 1
        for index in range(end - 1, first - 1, -1):
            tag, flat, start, _ = elements[index]
            depth = depths[index]
            if depth >= deepest:
                levels += [[] for _ in range(depth)]
                deepest = len(levels) - 1
            below = levels[depth + 1]
            if below:
                children = tuple(below[::-1])
                below.clear()
            else:
                children = ()
            span = Span(source, start, find(">", start) + 1)
            skipped = usual.get(tag, -1)
            node_id, name = tag, ""
            if skipped == _KIND:
                node_id = flat[1] if flat and flat[0] == "ID" else ""
                if settled.get(node_id) != tag:
                    if node_id in _RENAMED_OR_OWN or kinds.setdefault(node_id, tag) != tag:
                        skipped = -1
                    else:
                        settled[node_id] = tag
            if skipped == 0 and "ID" in flat and self._dialect == 3:
                skipped = -1
            if skipped >= 0 and "name" in flat:
                if flat[skipped] == "name" and (name := flat[skipped + 1]) and flat.count("name") == 1:
                    skipped += 2
                else:
                    skipped = -1
            if skipped >= 0:
                turns = iter(flat[skipped:] if skipped else flat)
                node = Node(node_id, children, tuple(zip(turns, turns)), name, span)  # noqa: B905, strict costs time
            else:
                node, spelling = self._unusual(tag, flat, children, span)
                if spelling is not None:
                    unusual[index - first] = spelling
            levels[depth].append(node)
        return levels[depths[first]][0], unusual

    def _usual_tags(self) -> dict[str, int]:
        """Tags that the writer would write as well; how many entries of their attributes describe the node itself."""
        document = self._document
        if self._dialect == 4:
            tags = {element[0] for element in document.elements} - _ODD - self._names.keys()
            return dict.fromkeys(tags, 0)
        if "${" in document.text:
            return {}
        return dict.fromkeys(_PLAIN_3, 0) | dict.fromkeys(KINDS, _KIND)

    def _unusual(
        self, tag: str, flat: list[str], children: tuple[Node, ...], span: Span
    ) -> tuple[Node, Spelling | None]:
        """A node, and how it was written where the writer would write it otherwise."""
        turns = iter(flat)
        pairs = tuple(zip(turns, turns, strict=True))
        attributes = dict(pairs)
        node_id = tag
        is_kind = tag in KINDS
        if is_kind or TO_4.get(tag, tag) == SUBTREE:
            if not attributes.get("ID"):
                self.problems.append(diagnostic("BT123", span, tag=tag, attribute="ID", advice=_ID_ADVICE[is_kind]))
            if is_kind:
                node_id = attributes.pop("ID", "")
        elif tag in self._names and tag not in self._kinds and tag not in IN_3 and tag not in TO_4:
            attributes = {"ID": tag, **attributes}  # the ID of a tree may be a tag
            node_id = SUBTREE
        node_id = TO_4.get(node_id, node_id)
        name = attributes.pop("name", "")
        if self._dialect == 3 and node_id in IN_3:
            attributes.pop("ID", None)  # which says again what node it is
        if node_id == SUBTREE:
            ports = self._subtree(attributes, tag == "SubTreePlus")
        else:
            if is_kind and node_id not in IN_3:
                self._kinds.setdefault(node_id, tag)
            ports = tuple(attributes.items()) if self._dialect == 4 else _ports_3(node_id, attributes, len(children))
        node = Node(node_id, children, ports, name, span)
        if node_id == SUBTREE:
            self.uses.append(node)
        usual = SPELL[self._dialect](node, self._kind, self._written)
        return node, None if usual == (tag, pairs) else (tag, pairs)

    def _kind(self, node_id: str) -> str:
        return self._kinds.get(node_id, "")

    def _subtree(self, attributes: dict[str, str], is_plus: bool) -> tuple[tuple[str, str], ...]:
        name = attributes.pop("ID", None)
        if self._dialect == 4 and attributes.get(AUTOREMAP) not in TRUE:  # else ports have the values around
            for key, text in self._defaults.get(self._names.get(name or "", name or ""), ()):
                attributes.setdefault(key, text)
        if name is not None:
            attributes = {"ID": self._names.get(name, name), **attributes}
        if self._dialect == 4:
            return tuple(attributes.items())
        ports: list[tuple[str, str]] = []
        for key, text in attributes.items():
            if key == SHARED:
                ports += [(AUTOREMAP, "true")] if text in TRUE else []
            elif key == AUTOREMAP_3:
                ports.append((AUTOREMAP, text))
            else:
                value = without_dollar(text)
                bare = not is_plus and key != "ID" and key[:1] != "_" and value and value[:1] != "{"
                ports.append((key, f"{{{value}}}" if bare else value))
        return tuple(ports)


_ID_ADVICE = {
    True: 'Name the node that it stands for: ID="MoveBase"',
    False: 'Name the tree that it stands for: ID="Dock"',
}


def _ports_3(node_id: str, attributes: dict[str, str], children: int) -> tuple[tuple[str, str], ...]:
    names = PORTS_TO_4.get(node_id, {})
    ports = [(names.get(key, key), without_dollar(text)) for key, text in attributes.items()]
    enough = attributes.get("threshold", "")
    if names and enough.isdecimal() and len(enough) < 10:
        # so many successes; the rest may fail, but no more
        counts = (("success_count", enough), ("failure_count", str(max(children - int(enough) + 1, 1))))
        ports = [port for port in ports if port[0] != "threshold"] + list(counts)
    return tuple(ports)
