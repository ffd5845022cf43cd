"""What lowering the parts of a mission shares: names in order of use, values that each part needs, and new nodes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.ast import Ast, Definition, Exact, Name, all_definitions
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node
from btlang.tree.visit import in_order_of_use
from btlang.vocabulary.value_type import ValueType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.passes.compilation import Origins


class LoweringScope:
    """The state of lowering one mission, whose defined names and types of values are given.

    `skipping` are the names whose trees can end SKIPPED, `endless` those whose trees run until they fail, `free` the
    keys of the mission's values that the tree of a name needs from outside, in their order, `parameters` the types of
    its parameters. `bodies` are the subtrees, used ones before their users. `made` is how many new keys it has
    made. `origins` are the nodes by their identities with the syntax that they were made of, if anybody asks for it.
    """

    def __init__(self, names: Iterable[str], types: Mapping[str, ValueType], origins: Origins | None = None) -> None:
        self.origins = origins
        self._types = types
        self.skipping: set[str] = set()
        self.endless: set[str] = set()
        self.free: dict[str, tuple[str, ...]] = {}
        self.parameters: dict[str, dict[str, str]] = {}
        self.bodies: list[tuple[str, Node]] = []
        self._names = set(names)
        self.made = 0

    def is_number(self, kind: str) -> bool:
        """Whether values of a type are numbers."""
        return self._types[kind].kind in ("quantity", "number")

    def new_key(self) -> str:
        """Make a key on the blackboard that no mission can name: its names start with a letter."""
        self.made += 1
        return f"_{self.made}"

    def new_name(self, key: str) -> str:
        """Make a name for the body of a loop over values."""
        number = 1
        while (name := f"each_{key}" + (f"_{number}" if number > 1 else "")) in self._names:
            number += 1
        self._names.add(name)
        return name

    def define(self, definition: ast.Definition, can_skip: bool, endless: bool) -> None:
        """Define a name, which may be used from now on."""
        self.parameters[definition.name] = dict(definition.parameters)
        self.free[definition.name] = self.needs(definition.body, dict(definition.parameters))
        if can_skip:
            self.skipping.add(definition.name)
        if endless:
            self.endless.add(definition.name)

    def needs(self, root: ast.Ast, own: Iterable[str] = ()) -> tuple[str, ...]:
        """Return the keys of values that a part needs from outside, each once, without its own."""
        hidden = frozenset(own)
        return tuple(dict.fromkeys(key for key in self._keys_in(root) if key not in hidden))

    def _keys_in(self, root: ast.Ast) -> Iterator[str]:
        stack: list[tuple[ast.Ast, frozenset[str]]] = [(root, frozenset())]
        while stack:
            item, bound = stack.pop()
            yield from (key for key in ast.keys_of(item) if key not in bound)
            if isinstance(item, ast.Name):
                yield from (key for key in self.free.get(item.name, ()) if key not in bound)
            if isinstance(item, ast.ForEach):
                bound |= {item.key}
            stack += [(part, bound) for part in reversed(ast.parts(item))]


def order_names(compilation: Compilation) -> list[Diagnostic]:
    """Put the definitions in order, used ones before their users. BT040 for a name that reaches itself."""
    definitions = {definition.name: definition for definition in all_definitions(compilation.mission)}
    uses = {name: find_names(compilation.syntax(definition.body)) for name, definition in definitions.items()}
    ordered, circles = in_order_of_use(uses)
    compilation.ordered = [definitions[name] for name in ordered]
    return [_circle(circle, definitions) for circle in circles]


def _subtree(item: Exact) -> str:
    return dict(item.ports).get("ID", "")


def find_names(nodes: Iterable[Ast]) -> list[str]:
    """Find the defined names that these nodes use, each once, in the order they stand."""
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


class Lowered(Record):
    """A node, whether it can end SKIPPED, and whether it is `endless`: it runs until it fails or is stopped."""

    node: Node
    can_skip: bool = False
    endless: bool = False


def new_node(node_id: str, children: Sequence[Node], span: Span, **ports: str) -> Node:
    """Make a node with its ports."""
    return Node(node_id, tuple(children), tuple(ports.items()), span=span)


def new_round(body: Lowered) -> Node:
    """Make a round: one that is skipped counts as a round."""
    if not body.can_skip:
        return body.node
    span = body.node.span
    assert span is not None
    return new_node("Sequence", (body.node, new_node("AlwaysSuccess", (), span)), span)
