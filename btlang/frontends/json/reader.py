"""Trees from JSON, in the form of `btlang/backends/tree.schema.json`, which `btlang/backends/json_tree.py` writes."""

from __future__ import annotations

import re

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.text.json_text import NestedTooDeep, load_json
from btlang.text.source import Source, Span
from btlang.tree.node import Node, NodeModel, PortModel, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

FORMAT = 1
PORT_KEYS = ("name", "direction", "type", "default", "text")


def read_json(text: str | Source, main: str = "") -> Tree:
    """The tree of a document, with spans of the ids there; `main` is the ID of one of several.

    Raises MissionError (BT133 where it is no such document, BT126 where no tree has the ID).
    """
    import json

    source = Source(text) if isinstance(text, str) else text
    try:
        tree = _tree(load_json(source.text), _Places(source))
    except json.JSONDecodeError as error:
        at, reason = error.pos, f"it is not JSON: {error.msg}"
    except NestedTooDeep as error:
        at, reason = 0, str(error)
    except ValueError:
        at, reason = 0, "a number is too long"
    except _Wrong as error:
        at, reason = 0, str(error)
    else:
        return _chosen(tree, main, source)
    raise MissionError([diagnostic("BT133", Span(source, at, at), reason=reason)])


def _chosen(tree: Tree, main: str, source: Source) -> Tree:
    """The same trees with this one as the main one; if none is asked for, the first. Nothing can use an
    unnamed one, so it is dropped if another is chosen."""
    if main in ("", tree.name):
        return tree
    trees = dict((*([(tree.name, tree.root)] if tree.name else []), *tree.subtrees))
    if main not in trees:
        from btlang.frontends.btcpp.reader import no_tree

        raise MissionError([no_tree(Span(source, 0, 0), main, trees)])
    others = tuple(named for named in trees.items() if named[0] != main)
    chosen: Tree = tree.replace(root=trees[main], subtrees=others, name=main)
    return chosen


class _Wrong(Exception):
    """The document does not hold a tree; the message says where and why."""


class _Places:
    """Finds where the ids of nodes stand, one after the other: readers of JSON give no places."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._at = 0

    def next(self, id: str) -> Span | None:
        """None where it is spelled with escapes, or the keys stand in an order in which it is not found."""
        found = re.compile(rf'"id"\s*:\s*"{re.escape(id)}"').search(self._source.text, self._at)
        if found is None:
            self._at = len(self._source.text)  # else each node after it would search the rest again
            return None
        self._at = found.end()
        return Span(self._source, found.start(), found.end())


def _tree(document: Any, places: _Places) -> Tree:
    if _of(document, dict, "the document").get("format") != FORMAT:
        raise _Wrong(f'"format" is not {FORMAT}')
    trees = _of(document.get("trees"), list, '"trees"')
    if not trees:
        raise _Wrong('"trees" contains no tree')
    read = [_root(item, f"tree {at}", places) for at, item in enumerate(trees)]
    names: set[str] = set()
    for name, _ in read:
        if name in names:
            raise _Wrong(f"two trees have the name {name!r}")
        names.add(name)
    models = [
        _read_model(item, f"model {at}") for at, item in enumerate(_of(document.get("models", []), list, "models"))
    ]
    return Tree(read[0][1], tuple(read[1:]), read[0][0], tuple(models))


def _root(item: Any, where: str, places: _Places) -> tuple[str, Node]:
    """The name and the root of a tree. Children come after their parents, so that the last node is made first."""
    name = _of(_of(item, dict, where).get("name", ""), str, f"the name of {where}")
    nodes = _of(item.get("nodes"), list, f'"nodes" of {where}')
    ids = [
        _of(_of(node, dict, f"node {at} of {where}").get("id"), str, f"the id of node {at} of {where}")
        for at, node in enumerate(nodes)
    ]
    spans = [places.next(id) for id in ids]
    made: dict[int, Node] = {}
    for at in range(len(nodes) - 1, -1, -1):
        place = f"node {at} of {where}"
        node = nodes[at]
        children = _of(node.get("children", []), list, f"children of {place}")
        below: list[Node] = []
        for child in children:
            if type(child) is not int or not at < child < len(nodes):
                raise _Wrong(f"{place} has the child {child!r}, but children must come after it in the list")
            if child not in made:
                raise _Wrong(f"node {child} of {where} is the child of two nodes")
            below.append(made.pop(child))
        ports = _of(node.get("ports", {}), dict, f"ports of {place}")
        made[at] = Node(
            ids[at],
            tuple(below),
            tuple((port, _of(text, str, f"the port {port} of {place}")) for port, text in ports.items()),
            _of(node.get("name", ""), str, f"the name of {place}"),
            spans[at],
        )
    if len(made) != 1:
        raise _Wrong(f"{where} has {len(made)} roots instead of one")
    return name, made[0]


def _read_model(item: Any, where: str) -> NodeModel:
    _of(item, dict, where)
    kind, id, text = (_of(item.get(key, ""), str, f"{key} of {where}") for key in ("kind", "id", "text"))
    ports = []
    for port in _of(item.get("ports", []), list, f"ports of {where}"):
        known = {key: _of(value, str, key) for key, value in _of(port, dict, where).items() if key in PORT_KEYS}
        ports.append(PortModel(**{"name": "", **known}))
    return NodeModel(kind, id, tuple(ports), text)


def _of(value: Any, kind: type, what: str) -> Any:
    if not isinstance(value, kind):
        raise _Wrong(f"{what} isn't {_KINDS[kind]}")
    if isinstance(value, str) and (unfit := _UNFIT.search(value)) is not None:
        raise _Wrong(f"{what} has an invalid character: {unfit[0]!a}")
    return value


_UNFIT = re.compile("[\0\ud800-\udfff]")  # NUL and lone surrogates, which XML and UTF-8 do not have either


_KINDS: dict[type, str] = {dict: "an object", list: "an array", str: "a text"}
