"""BT051: definitions that no command reaches, parameters and values that nothing uses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.names import names_in
from btlang.text.source import Span
from btlang.tree.ast import Assign, Ast, Exact, Remember, all_definitions, bodies, keys_of
from btlang.tree.catalogue import SUBTREE
from btlang.tree.comments import KEPT


def unused_names(compilation: Compilation) -> Iterator[Diagnostic]:
    """Not of a text that only defines names or grows, nor of the names of another file: those are for others.

    Nor of the trees of an XML file in English, which other files may use; BT236 is about them.
    """
    mission = compilation.mission
    if mission.body is None or compilation.grows:
        return
    yield from _values(compilation)
    if not mission.definitions or f"\n{KEPT} " in mission.span.source.text:
        return
    own = {definition.name: definition.body for definition in mission.definitions}
    reached: set[str] = set()
    waiting = names_in(compilation.syntax(mission.body))
    while waiting:
        name = waiting.pop()
        if name not in reached and name in own:
            reached.add(name)
            waiting += names_in(compilation.syntax(own[name]))
    for definition in mission.definitions:
        if definition.name not in reached and definition.span.source is mission.span.source:
            yield diagnostic("BT051", definition.name_span, name=definition.name)


def _values(compilation: Compilation) -> Iterator[Diagnostic]:
    """Values that are given and never asked for, and parameters that stand nowhere in their body."""
    mission = compilation.mission
    given: dict[str, Span] = {}
    for body in bodies(mission):
        for node in compilation.syntax(body):
            if isinstance(node, (Assign, Remember)):
                given.setdefault(node.key, node.span)
    definitions = all_definitions(mission)
    if not given and not any(definition.parameters for definition in definitions):
        return
    asked: set[str] = set() if mission.body is None else _asked(compilation.syntax(mission.body))
    for definition in definitions:
        own = _asked(compilation.syntax(definition.body))
        asked |= own
        for key, _ in definition.parameters:
            if key not in own and definition.span.source is mission.span.source:
                yield diagnostic("BT051", definition.name_span, name=f"{{{key}}}")
    for key, span in given.items():
        if key not in asked and span.source is mission.span.source:
            yield diagnostic("BT051", span, name=key.replace("_", " ").strip())


def _asked(nodes: Iterable[Ast]) -> set[str]:
    """The keys of values that nodes ask for, as do subtrees called by their ids: what is set inside goes out there."""
    asked: set[str] = set()
    for node in nodes:
        own = node.key if isinstance(node, (Assign, Remember)) else ""
        asked.update(key for key in keys_of(node) if key != own)
        if isinstance(node, Exact) and node.id == SUBTREE:
            asked.update(port for port, _ in node.ports)
    return asked
