"""Names: which definition uses which, in an order in which each comes after those that it uses."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree.ast import Ast, Definition, Exact, Name, all_definitions
from btlang.tree.catalogue import SUBTREE
from btlang.tree.visit import in_order_of_use


def order_names(compilation: Compilation) -> list[Diagnostic]:
    """Puts the definitions in order, used ones before their users. BT040 for a name that reaches itself."""
    definitions = {definition.name: definition for definition in all_definitions(compilation.mission)}
    uses = {name: names_in(compilation.syntax(definition.body)) for name, definition in definitions.items()}
    ordered, circles = in_order_of_use(uses)
    compilation.ordered = [definitions[name] for name in ordered]
    return [_circle(circle, definitions) for circle in circles]


def _subtree(item: Exact) -> str:
    return dict(item.ports).get("ID", "")


def names_in(nodes: Iterable[Ast]) -> list[str]:
    """The defined names that these nodes use, each once, in the order they stand."""
    found: dict[str, None] = {}
    for item in nodes:
        if isinstance(item, Name):
            found[item.name] = None
        elif isinstance(item, Exact) and item.id == SUBTREE:
            found[_subtree(item)] = None
    return list(found)


def _circle(names: list[str], definitions: dict[str, Definition]) -> Diagnostic:
    first = min(names, key=lambda name: definitions[name].span.start)
    turned = names[names.index(first) :] + names[: names.index(first)]
    circle = " uses ".join(f"'{name}'" for name in [*turned, first])
    return diagnostic("BT040", definitions[first].name_span, name=first, circle=circle)
