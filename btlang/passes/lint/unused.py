"""BT051: definitions that no command reaches, parameters and values that nothing uses."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.names import names_in
from btlang.text.source import Span
from btlang.tree.ast import Assign, Ast, Program, Remember, all_definitions, keys_of, parts


def unused_names(compilation: Compilation) -> Iterator[Diagnostic]:
    """Not of a text that only defines names or grows, nor of the names of another file: those are for others."""
    mission = compilation.mission
    if mission.body is None or compilation.grows:
        return
    yield from _values(mission)
    if not mission.definitions:
        return
    bodies = {definition.name: definition.body for definition in mission.definitions}
    reached: set[str] = set()
    waiting = names_in(mission.body)
    while waiting:
        name = waiting.pop()
        if name not in reached and name in bodies:
            reached.add(name)
            waiting += names_in(bodies[name])
    for definition in mission.definitions:
        if definition.name not in reached and definition.span.source is mission.span.source:
            yield diagnostic("BT051", definition.name_span, name=definition.name)


def _values(mission: Program) -> Iterator[Diagnostic]:
    """Values that are given and never asked for, and parameters that stand nowhere in their body."""
    asked: set[str] = set()
    given: dict[str, Span] = {}
    for definition in all_definitions(mission):
        own = _asked(definition.body, given)
        asked |= own
        for key, _ in definition.parameters:
            if key not in own and definition.span.source is mission.span.source:
                yield diagnostic("BT051", definition.name_span, name=f"{{{key}}}")
    if mission.body is not None:
        asked |= _asked(mission.body, given)
    for key, span in given.items():
        if key not in asked and span.source is mission.span.source:
            yield diagnostic("BT051", span, name=key.replace("_", " ").strip())


def _asked(root: Ast, given: dict[str, Span]) -> set[str]:
    """The keys of values that a tree asks for; adds those that it gives to `given`, with their first place."""
    asked: set[str] = set()
    stack = [root]
    while stack:
        node = stack.pop()
        if node.parts:
            stack.extend(reversed(parts(node)))
        keys = keys_of(node)
        if isinstance(node, (Assign, Remember)):
            given.setdefault(node.key, node.span)
            keys = [key for key in keys if key != node.key]
        if keys:
            asked.update(keys)
    return asked
