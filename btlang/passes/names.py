"""Names: which definition uses which, in an order in which each comes after those that it uses."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.tree.ast import Ast, Definition, Exact, Mission, Name, all_definitions, exact_nodes, parts


def order_of_use(mission: Mission) -> tuple[list[Definition], list[Diagnostic]]:
    """The definitions, used ones before their users.

    A name that reaches itself is a problem (BT040), and so is a subtree that is not there (BT140).
    """
    definitions = {definition.name: definition for definition in all_definitions(mission)}
    uses = {name: names_in(definition.body) for name, definition in definitions.items()}
    ordered: list[Definition] = []
    uses_of_trees = [node for node in exact_nodes(mission) if node.id == "SubTree"]
    problems = [_missing(node) for node in uses_of_trees if _subtree(node) not in definitions]
    done: set[str] = set()
    for start in definitions:
        path: list[str] = []  # the names being followed, each used by the one before
        stack = [(start, False)]
        while stack:
            name, left = stack.pop()
            if left:
                path.pop()
                ordered.append(definitions[name])
            elif name in path:
                problems.append(_circle(path[path.index(name) :], definitions))
            elif name not in done:
                done.add(name)
                path.append(name)
                stack.append((name, True))
                stack += [(used, False) for used in reversed(uses[name]) if used in definitions]
    return ordered, problems


def _subtree(item: Exact) -> str:
    return dict(item.ports).get("ID", "")


def _missing(item: Exact) -> Diagnostic:
    return diagnostic("BT140", item.span, name=_subtree(item))


def names_in(node: Ast) -> list[str]:
    """The defined names that are used in a subtree, each once, in the order they stand."""
    found: dict[str, None] = {}
    stack = [node]
    while stack:
        item = stack.pop()
        if item.parts:
            stack += reversed(parts(item))
        if isinstance(item, Name):
            found[item.name] = None
        elif isinstance(item, Exact) and item.id == "SubTree":
            found[_subtree(item)] = None
    return list(found)


def _circle(names: list[str], definitions: dict[str, Definition]) -> Diagnostic:
    first = min(names, key=lambda name: definitions[name].span.start)
    turned = names[names.index(first) :] + names[: names.index(first)]
    circle = " uses ".join(f"'{name}'" for name in [*turned, first])
    return diagnostic("BT040", definitions[first].name_span, name=first, circle=circle)
