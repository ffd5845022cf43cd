"""Comments of an XML file as those of a mission: before the statement in which their node is said."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.frontends.btcpp.origin import Markup, TreeOrigin, XmlOrigin
from btlang.support.record import Record
from btlang.tree.node import Node, Tree

_OPEN, _CLOSE = "<!--", "-->"


class Comments(Record):
    """Comments as lines without marks: by node (its `id()`), by the name of a subtree, and around all of them."""

    nodes: dict[int, tuple[str, ...]]
    trees: dict[str, tuple[str, ...]]
    head: tuple[str, ...] = ()
    foot: tuple[str, ...] = ()


def comments_of(tree: Tree) -> Comments:
    """Return the comments of the file that a tree was read from; none if it comes from elsewhere."""
    origin = tree.origin
    if not isinstance(origin, XmlOrigin):
        return Comments({}, {})
    roots = {**dict(tree.subtrees), "": tree.root}
    nodes: dict[int, tuple[str, ...]] = {}
    trees: dict[str, tuple[str, ...]] = {}
    waiting: list[str] = []
    for item in origin.items:
        if isinstance(item, Markup):
            waiting += lines_of((item.text,))
        elif isinstance(item, str) and item in origin.trees:
            name = item if item in roots else ""
            trees[name] = (*waiting, *lines_of(origin.trees[item].after))
            waiting = []
            nodes |= _of_tree(roots[name], origin.trees[item])
    return Comments(nodes, trees, tuple(lines_of(origin.head)), (*waiting, *lines_of(origin.foot)))


def _of_tree(root: Node, origin: TreeOrigin) -> dict[int, tuple[str, ...]]:
    """Return the comments of a tree. All that belongs to a node is before it here."""
    places = origin.before, origin.heading, origin.behind, origin.inside
    if not any(places):
        return {}
    found: dict[int, tuple[str, ...]] = {}
    for number, node in enumerate(Tree(root).walk()):
        lines = tuple(lines_of(text for place in places for text in place.get(number, ())))
        if lines:
            found[id(node)] = lines
    return found


def lines_of(texts: Iterable[str]) -> Iterator[str]:
    """Yield the lines of comments that English keeps: all but rulers, which have no letter."""
    for text in texts:
        if text.startswith(_OPEN):
            lines = text.removeprefix(_OPEN).removesuffix(_CLOSE).split("\n")
            yield from (" ".join(line.split()) for line in lines if any(map(str.isalnum, line)))
