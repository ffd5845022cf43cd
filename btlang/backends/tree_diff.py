"""Differences of two trees, in words: `new step 'wave' behind 'dock'`, `attempts of 'go to lab': 6 to 3`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from difflib import SequenceMatcher

from btlang.tree.alignment import SubtreeNumbers
from btlang.tree.catalogue import CATALOGUE, ON_FAILURE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Say: TypeAlias = Callable[[Node], str]
    """The words of a node with all that is below it, in one line."""


def find_differences(old: Tree, new: Tree, say_old: Say, say_new: Say) -> Iterator[str]:
    """Yield a line for each, in the order of the new tree; none if the trees are equal but for comments and layout."""
    before, after = dict(old.subtrees), dict(new.subtrees)
    for name in before:
        if name not in after:
            yield f"the definition '{name}' is gone"
    diff = _Diff(say_old, say_new)
    yield from diff.lines(old.root, new.root, "")
    for name, root in after.items():
        if name in before:
            yield from diff.lines(before[name], root, f" in '{name}'")
        else:
            yield f"new definition '{name}': {say_new(root)}"


class _Diff:
    def __init__(self, say_old: Say, say_new: Say) -> None:
        self._say_old, self._say_new = say_old, say_new
        self._numbers = SubtreeNumbers(lambda node: node.ports)

    def lines(self, old: Node, new: Node, place: str) -> Iterator[str]:
        """Yield the differences of two trees of nodes; `place` says where they are."""
        self._numbers.add((*children_first(old), *children_first(new)))
        pending = [(old, new)]
        while pending:
            one, other = pending.pop()
            if self._numbers.are_equal(one, other):
                continue
            pairs: list[tuple[Node, Node]] = []
            for line in self._compare(one, other, pairs):
                yield line + place
            pending += reversed(pairs)

    def _compare(self, one: Node, other: Node, pairs: list[tuple[Node, Node]]) -> Iterator[str]:
        """Yield the lines about two nodes themselves; what is below them and may differ goes into `pairs`."""
        if one.id == other.id and bool(one.children) == bool(other.children):
            yield from self._ports(one, other)
            yield from self._children(one, other, pairs)
        elif len(other.children) == 1 and self._alike(one, other.children[0]):
            yield f"new around '{self._say_new(other.children[0])}': {_head(other)}"
            pairs.append((one, other.children[0]))
        elif len(one.children) == 1 and self._alike(one.children[0], other):
            yield f"no longer around '{self._say_new(other)}': {_head(one)}"
            pairs.append((one.children[0], other))
        else:
            yield f"'{self._say_old(one)}' is now '{self._say_new(other)}'"

    def _alike(self, one: Node, other: Node) -> bool:
        """Whether one has probably become the other."""
        if self._numbers.are_equal(one, other) or self._is_around(one, other) or self._is_around(other, one):
            return True
        if one.id != other.id or not (one.children or one.ports == other.ports or set(one.ports) & set(other.ports)):
            return False
        kept = self._numbers.of(one.children)
        return not kept or not set(kept).isdisjoint(self._numbers.of(other.children))

    def _is_around(self, inner: Node, outer: Node) -> bool:
        return len(outer.children) == 1 and self._numbers.are_equal(inner, outer.children[0])

    def _ports(self, one: Node, other: Node) -> Iterator[str]:
        if one.ports == other.ports and one.name == other.name:
            return
        if not other.children:
            yield f"'{self._say_old(one)}' is now '{self._say_new(other)}'"
            return
        before, after = dict(one.ports), dict(other.ports)
        words = f"'{self._say_new(other.children[0])}'"
        for port in dict.fromkeys((*before, *after)):
            if before.get(port) != after.get(port):
                texts = [_value(other, port, ports.get(port, "none")) for ports in (before, after)]
                yield f"{_port_label(other, port)} of {words}: {texts[0]} to {texts[1]}"
        if one.name != other.name:
            yield f"the name of {words}: '{one.name}' to '{other.name}'"

    def _children(self, one: Node, other: Node, pairs: list[tuple[Node, Node]]) -> Iterator[str]:
        old, new = one.children, other.children
        matcher = SequenceMatcher(a=self._numbers.of(old), b=self._numbers.of(new), autojunk=False)
        for tag, first, last, begin, end in matcher.get_opcodes():
            if tag == "equal":
                continue
            at = begin
            for gone in old[first:last]:
                match = next((place for place in range(at, end) if self._alike(gone, new[place])), None)
                if match is None and last - first == end - begin == 1:
                    match = begin
                if match is None:
                    yield f"the step '{self._say_old(gone)}' is gone"
                    continue
                yield from (self._new(new, place) for place in range(at, match))
                pairs.append((gone, new[match]))
                at = match + 1
            yield from (self._new(new, place) for place in range(at, end))

    def _new(self, children: Sequence[Node], at: int) -> str:
        where = ""
        if at:
            where = f" behind '{self._say_new(children[at - 1])}'"
        elif len(children) > 1:
            where = f" before '{self._say_new(children[1])}'"
        return f"new step '{self._say_new(children[at])}'{where}"


def _port_label(node: Node, port: str) -> str:
    """Return what a port is called: that of the rounds by what they are."""
    kind = CATALOGUE.get(node.id)
    if kind is not None and port == kind.rounds:
        return "attempts" if kind.again == ON_FAILURE else "rounds"
    if kind is not None and port in kind.ports and kind.ports[port].unit == "ms":
        return node.id
    return f"{port} of {node.id}" if node.id != SUBTREE else port


def _value(node: Node, port: str, text: str) -> str:
    kind = CATALOGUE.get(node.id)
    known = kind.ports.get(port) if kind is not None else None
    if known is not None and known.unit == "ms" and text.isdigit():
        return f"{int(text) / 1000:g} s"
    return "no limit" if known is not None and known.unit == "rounds" and text == "-1" else text


def _head(node: Node) -> str:
    ports = ", ".join(
        f"{_port_label(node, port).partition(' of ')[0]} {_value(node, port, text)}" for port, text in node.ports
    )
    return f"{node.id} ({ports})" if ports else node.id
