"""What lowering the parts of a mission shares: names, and the values of the mission that each part needs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from btlang.tree import ast
from btlang.tree.node import Node
from btlang.vocabulary.value_type import ValueType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.passes.compilation import Origins


class Scope:
    """State of lowering one mission, whose defined names and types of values are given.

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
        """A key on the blackboard that no mission can name: its names start with a letter."""
        self.made += 1
        return f"_{self.made}"

    def new_name(self, key: str) -> str:
        """A name for the body of a loop over values."""
        number = 1
        while (name := f"each_{key}" + (f"_{number}" if number > 1 else "")) in self._names:
            number += 1
        self._names.add(name)
        return name

    def define(self, definition: ast.Definition, can_skip: bool, endless: bool) -> None:
        """Its name may be used from now on."""
        self.parameters[definition.name] = dict(definition.parameters)
        self.free[definition.name] = self.needs(definition.body, dict(definition.parameters))
        if can_skip:
            self.skipping.add(definition.name)
        if endless:
            self.endless.add(definition.name)

    def needs(self, root: ast.Ast, own: Iterable[str] = ()) -> tuple[str, ...]:
        """The keys of values that a part needs from outside, each once, without its own."""
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
