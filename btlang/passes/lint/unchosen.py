"""Check BT150: a pronoun that stands for what nothing chooses. Its command could only fail."""

from __future__ import annotations

import re
from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree.ast import all_definitions
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node
from btlang.vocabulary.entry import MEASURED
from btlang.vocabulary.value_type import WORLD

_KEYS = frozenset(f"{{{kind}}}" for kind in WORLD)
"""The keys that pronouns stand for."""
_WORD = re.compile(r"\w+")


def find_unchosen(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report the first command about each such value that nothing in the mission chooses, sets or is given."""
    nodes = [node for _, nodes in compilation.nodes for node in nodes]
    asked: dict[str, Node] = {}
    for node in nodes:
        outputs = _outputs(node, compilation)
        for name, text in node.ports:
            if text in _KEYS and name not in outputs:
                asked.setdefault(text[1:-1], node)
    if not asked:
        return  # as nearly always
    definitions = all_definitions(compilation.mission)
    chosen = {*compilation.mission.given, *(name for each in definitions for name, _ in each.parameters)}
    for node in nodes:
        outputs = _outputs(node, compilation)
        for name, text in node.ports:
            if node.id in CATALOGUE:
                chosen |= {name, *_WORD.findall(text)}
            elif name in outputs or name[:1] == "_":
                chosen |= set(_WORD.findall(text))
    for key, node in asked.items():
        entry = compilation.vocabulary.entry(node.id)
        if key not in chosen and node.span is not None and entry is not None:
            reason = "nothing before it says what it is about"
            yield diagnostic("BT150", node.span, words=node.span.text, reason=reason, example=entry.example)


def _outputs(node: Node, compilation: Compilation) -> tuple[str, ...]:
    entry = compilation.vocabulary.entry(node.id)
    return () if entry is None else (*entry.outputs, *(MEASURED,) * bool(entry.measures))
