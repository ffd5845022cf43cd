"""Nodes that neither a model nor btlang knows (BT231), and what nothing reads or uses (BT235, BT236)."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Container, Iterable, Iterator, Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.engine.instance import blackboard_key
from btlang.engine.script.tokens import READS, SETS, find_name_uses
from btlang.frontends.btcpp.dialect import ONLY_IN_3
from btlang.frontends.btcpp.project import XmlProject
from btlang.frontends.btcpp.spelling import AUTOREMAP, TRUE
from btlang.projects.ports import attribute_value, id_place, suggest_name
from btlang.text.spelling import misspelt
from btlang.tree.catalogue import KEY, SCRIPT, SUBTREE, port_content
from btlang.tree.node import Node, Tree
from btlang.tree.visit import subtree_names, used_subtrees

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    OutputsOf: TypeAlias = Callable[[Node], Container[str]]


_WORD = re.compile(r"[^\W\d]\w*")
_FOR_NAVIGATOR = ("error_code_id", "error_msg")  # what these ports name, Nav2's navigator reads for its result
_BY_NAV2 = frozenset((
    "node", "tf_buffer", "bt_loop_duration", "server_timeout", "wait_for_service_timeout", "initial_pose_received",
    "number_recoveries", "odom_smoother",
))  # fmt: skip
"""Entries that Nav2's nodes, and those that are derived from them, use without a port."""


def keys_read(nodes: Iterable[Node], outputs_of: OutputsOf) -> frozenset[str]:
    """Return every key that a port, a script or a SubTree may read, in whatever tree: a key has other names in other
    trees.
    """
    read: set[str] = set()
    for node in nodes:
        outputs = outputs_of(node)
        for name, text in node.ports:
            if port_content(node.id, name) == SCRIPT:
                read.update(name.lstrip("@") for name, uses in find_name_uses(text).items() if READS in uses)
            elif name not in outputs and port_content(node.id, name) != KEY:
                key = blackboard_key(name, text)
                read.update((key.lstrip("@"),) if key is not None else _WORD.findall(text))
            if node.id == SUBTREE:
                read.add(name)
    return frozenset(read)


def unread_values(nodes: Iterable[Node], outputs_of: OutputsOf, read: frozenset[str]) -> Iterator[Diagnostic]:
    """Report BT235 for the keys that only output ports name, and that scripts only assign to; `_` says so itself."""
    for node in nodes:
        outputs = outputs_of(node)
        for name, text in node.ports:
            for key in _keys_set(node.id, name, text, outputs):
                if key not in read and key[:1] != "@" and key.strip("_") and name not in _FOR_NAVIGATOR:
                    yield diagnostic("BT235", attribute_value(node, name), key=key, port=name, id=node.id)


def _keys_set(node_id: str, port: str, text: str, outputs: Container[str]) -> Iterable[str]:
    holds = port_content(node_id, port)
    if holds == SCRIPT:
        return [name for name, uses in find_name_uses(text).items() if SETS in uses]
    key = blackboard_key(port, text) if port in outputs or holds == KEY else None
    return (key,) if key is not None else (text,) if holds == KEY and _WORD.fullmatch(text) else ()


def unread_subtree_ports(nodes: Iterable[Node], trees: Mapping[str, Node]) -> Iterator[Diagnostic]:
    """Report BT235 for values that a tree is given and doesn't name anywhere."""
    named: dict[str, set[str]] = {}
    for node in nodes:
        used = node.port("ID")
        if node.id != SUBTREE or used not in trees:
            continue
        if used not in named:
            named[used] = _find_names(trees[used], trees)
        for name, _ in node.ports:
            is_named = name == "ID" or name in named[used] or name in _BY_NAV2
            if name[:1] != "_" and _WORD.fullmatch(name) and not is_named:
                yield diagnostic(
                    "BT235", attribute_value(node, name), key=name, port=name, id=attribute_value(node, "ID").text
                )


def _find_names(root: Node, trees: Mapping[str, Node]) -> set[str]:
    """Return all words of a tree that may be keys, and of those that see its keys by their own names."""
    words: set[str] = set()
    waiting, done = [root], set[str]()
    while waiting:
        for node in Tree(waiting.pop()).walk():
            for _, text in node.ports:
                words.update(_WORD.findall(text))
            name = node.port("ID")
            if node.id == SUBTREE and node.port(AUTOREMAP) in TRUE and name in trees and name not in done:
                done.add(name)
                waiting.append(trees[name])
    return words


def unused_trees(project: XmlProject) -> Iterator[Diagnostic]:
    """Report BT236 for trees that no main tree reaches, where a main tree uses others, in the files of what it
    reaches.
    """
    trees = project.trees
    mains = [trees[name] for name in project.mains]
    if not any(name in trees for root in mains for name in subtree_names(root)):
        return
    reached = {name for name, _ in used_subtrees(Tree(mains[0], tuple(trees.items())), project.mains)}
    files = {project.heads[name].span.source.name for name in reached}
    for name, head in project.heads.items():
        if name in trees and name not in reached and head.span.source.name in files:
            yield diagnostic("BT236", head.span, name=head.written or name)


def unknown_nodes(
    nodes: Iterable[Node], described: Collection[str], words: Collection[str], dialects: Mapping[str, int]
) -> Iterator[Diagnostic]:
    """Report BT231 at the first node of each unknown id, with how often it is used.

    `described` are the ids that the project can mean, `words` those of btlang's leaves; `dialects` are those of files.
    """
    uses: dict[str, list[Node]] = {}
    for node in nodes:
        if node.id and node.id not in described and node.id not in words and node.span is not None:
            uses.setdefault(node.id, []).append(node)
    for node_id, found in uses.items():
        first = found[0]
        place = id_place(first)
        if node_id in ONLY_IN_3 and dialects.get(place.source.name) == 3:
            continue
        near, words_near = misspelt(node_id, described), misspelt(node_id, words)
        # a tag with an end tag can't be changed alone
        fix = None if first.children and place.text == node_id else suggest_name(place, near)
        help = f"Similar: {', '.join(near or words_near)}" if near or words_near else ""
        yield diagnostic("BT231", place, (), fix, id=node_id, times=count_times(len(found)), help=help)


def count_times(number: int) -> str:
    """Say how often something is done."""
    return {1: "once", 2: "twice"}.get(number, f"{number} times")
