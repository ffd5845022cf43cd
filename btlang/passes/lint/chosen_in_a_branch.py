"""Lint BT069: commands about something that is chosen in one branch only: `if C, bring a cup. Put it in the hall`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.endings import FAILURE, find_ends
from btlang.support.record import Record
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node

_BRANCHES = ("if", "then", "else")


class Keys(Record):
    """What a part of a tree does with the keys of the blackboard.

    `surely`: it sets these. `perhaps`: it sets these in one branch only, each with the condition of that branch.
    `asked`: it reads these before it sets them, each with the first node that does.
    """

    surely: frozenset[str]
    perhaps: Mapping[str, Node]
    asked: Mapping[str, Node]


def find_chosen_in_a_branch(compilation: Compilation) -> list[Diagnostic]:
    """Report what reads a key that is chosen only if a condition holds: otherwise it fails."""
    entries = compilation.vocabulary.entries
    known = {id: entries[id][0] for id in compilation.ids if id in entries}
    choosing = {id: entry.outputs for id, entry in known.items() if entry.outputs and not entry.phrases}
    found: list[Diagnostic] = []

    def combine(node: Node, children: Sequence[Keys], _: dict[str, Keys]) -> Keys:
        if not children:
            return _leaf(node, choosing.get(node.id, ()))
        kind = CATALOGUE.get(node.id)
        if kind is None or kind.roles != _BRANCHES or len(children) != len(_BRANCHES):
            return _in_order(children, found)
        ways = [_in_order((children[0], branch), found) for branch in children[1:]]
        going_on = [keys for keys, child in zip(ways, node.children[1:], strict=True) if not _always_fails(child)]
        surely = frozenset.intersection(*(keys.surely for keys in going_on or ways))
        perhaps = {key: node.children[0] for keys in going_on for key in keys.surely - surely}
        for keys in ways:
            perhaps |= {key: asked for key, asked in keys.perhaps.items() if key not in surely}
        return Keys(surely, perhaps, {**ways[1].asked, **ways[0].asked})

    if choosing:
        compilation.fold(combine)
    return found


def _always_fails(node: Node) -> bool:
    return not node.children and find_ends(node, (), {}) == FAILURE


def _leaf(node: Node, outputs: Sequence[str]) -> Keys:
    ports = [(name, text[1:-1]) for name, text in node.ports if text[:1] == "{" and text[-1:] == "}"]
    asked = {key: node for name, key in ports if name not in outputs}
    return Keys(frozenset(key for name, key in ports if name in outputs), {}, asked)


def _in_order(parts: Sequence[Keys], found: list[Diagnostic]) -> Keys:
    """Join parts that are done one after the other. What else a node does with its children, it does with all."""
    surely, perhaps, asked = frozenset[str](), dict[str, Node](), dict[str, Node]()
    for keys in parts:
        for key, reader in keys.asked.items():
            condition = perhaps.get(key)
            if key in surely:
                continue
            if condition is None:
                asked.setdefault(key, reader)
            elif reader.span is not None and condition.span is not None:
                words, said = reader.span.text, condition.span.text
                found.append(diagnostic("BT069", reader.span, words=words, condition=said))
        surely |= keys.surely
        perhaps = {key: node for key, node in {**perhaps, **keys.perhaps}.items() if key not in surely}
    return Keys(surely, perhaps, asked)
