"""Typed trees: in BehaviorTree.CPP an entry of the blackboard keeps its type, so each value gets one.

An entry has the type of the constant that a SubTree gives it, else of the first port that names it; a port of another
type is refused when the tree is made ("initially created with type [int] and, later type [double]"). A script that
makes an entry with a whole number can give it no fraction later. So what is ever a decimal is written as one, a text
that looks like a number is set by a Script before, and a port of another type gets a key of its own.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from btlang.engine.instance import blackboard_key
from btlang.engine.script.assignments import CHANGES, SETS, Assignment, assignments
from btlang.engine.script.values import literal
from btlang.passes.scripts import make_script
from btlang.tree.catalogue import CATALOGUE, SEQUENCE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first, fold

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Value: TypeAlias = tuple[str, str]
    """The name of a tree and a key in it."""
    PortTypes: TypeAlias = Callable[[str], Mapping[str, str]]
    """The C++ types of the ports of a node, by its id."""

_DECIMALS = ("double", "float")
_TEXT = "std::string"
_INTEGER = re.compile(r"u?int(8|16|32|64)?(_t)?|(unsigned|long|short)( .*)?|size_t|int")
_OWN_KEY = re.compile(r"_([0-9]{1,15})")


_BUILT_IN = {
    kind.id: {name: port.type for name, port in kind.ports.items()}
    for kind in CATALOGUE.values()
    if any(port.type for port in kind.ports.values())
}


class _Facts:
    """The known facts about one value, or about several that are one entry."""

    def __init__(self) -> None:
        self.ports: list[str] = []
        self.given: set[type[int | float | str]] = set()  # the types of the constants that SubTrees have for it
        self.is_decimal = False
        self.is_number = False  # scripts work with it as one
        self.is_set = False  # a script gives it a number
        self.is_said = False  # a script puts it into a text
        self.from_values: set[Value] = set()  # what its number is computed of

    def add(self, other: _Facts) -> None:
        self.ports += other.ports
        self.given |= other.given
        self.is_decimal |= other.is_decimal
        self.is_number |= other.is_number
        self.is_set |= other.is_set
        self.is_said |= other.is_said
        self.from_values |= other.from_values


def give_types(tree: Tree, port_types: PortTypes) -> Tree:
    """Return a well-typed tree; the same tree if it is well typed already."""
    return _Typing(tree, lambda node_id: _BUILT_IN.get(node_id) or port_types(node_id)).tree()


class _Typing:
    def __init__(self, tree: Tree, port_types: PortTypes) -> None:
        self._tree = tree
        self._port_types = port_types
        self._facts: dict[Value, _Facts] = {}
        self._joined: dict[Value, Value] = {}
        self._made = 0
        for name, root in ((tree.name, tree.root), *tree.subtrees):
            for node in children_first(root):
                self._read(name, node)
        self._find_decimals()

    def tree(self) -> Tree:
        root = self._write_node(self._tree.name, self._tree.root)
        subtrees = tuple((name, self._write_node(name, node)) for name, node in self._tree.subtrees)
        return Tree(root, subtrees, self._tree.name, self._tree.models)

    # -- reading

    def _read(self, name: str, node: Node) -> None:
        for text in (text for port, text in node.ports if port == "code" or port[:1] == "_"):
            for made in assignments(text):
                self._note(name, made)
        types = {} if node.id == SUBTREE else self._port_types(node.id)
        for port, text in node.ports:
            key = blackboard_key(port, text)
            if node.id == SUBTREE and port != "ID" and port[:1] != "_":
                inner = self._value((node.port("ID"), port))
                if key is None:
                    self._facts[inner].given.add(type(literal(text)))
                else:
                    self._join(inner, self._value((name, key)))
            elif key is not None and types.get(port):
                self._facts[self._value((name, key))].ports.append(types[port])
            if key is not None and (own := _OWN_KEY.fullmatch(key)):
                self._made = max(self._made, int(own[1]))

    def _note(self, name: str, made: Assignment) -> None:
        value = self._value((name, made.key))
        if own := _OWN_KEY.fullmatch(made.key):
            self._made = max(self._made, int(own[1]))
        if made.is_text:
            for key in made.names:
                self._facts[self._value((name, key))].is_said = True
            return
        facts = self._facts[value]
        facts.is_number |= bool(made.number) or made.sign in CHANGES
        facts.is_set |= bool(made.number) and made.sign in SETS
        facts.is_decimal |= made.sign == "/=" or isinstance(literal(made.number), float)
        if made.copied and made.sign in SETS:
            self._join(value, self._value((name, made.copied)))
            return
        for other in [self._value((name, key)) for key in made.names]:
            self._facts[other].is_number = True
            facts.from_values.add(other)

    def _value(self, value: Value) -> Value:
        """Return the value that represents an entry."""
        if value[1][:1] == "@":
            value = self._tree.name, value[1][1:]
        while value in self._joined:
            value = self._joined[value]
        self._facts.setdefault(value, _Facts())
        return value

    def _join(self, one: Value, other: Value) -> None:
        one, other = self._value(one), self._value(other)
        if one != other:
            self._joined[one] = other
            self._facts[other].add(self._facts.pop(one))

    def _find_decimals(self) -> None:
        for facts in self._facts.values():
            numbers = any(kind != _TEXT for kind in facts.ports) or facts.is_number
            facts.is_decimal |= any(kind in _DECIMALS for kind in facts.ports)
            facts.is_decimal |= numbers and float in facts.given
        before = -1
        while before < (before := sum(facts.is_decimal for facts in self._facts.values())):
            for facts in self._facts.values():
                facts.is_decimal |= any(self._facts[self._value(value)].is_decimal for value in facts.from_values)

    # -- writing

    def _type(self, facts: _Facts) -> str:
        """Return the type of an entry, "" if nothing shows it."""
        is_given = not facts.given.isdisjoint((int, float))
        if facts.is_decimal and (is_given or facts.is_set or any(kind in _DECIMALS for kind in facts.ports)):
            return "double"
        integers = [kind for kind in facts.ports if _INTEGER.fullmatch(kind)]
        if is_given and (integers or facts.is_number):
            return "int"
        return (integers or facts.ports or [""])[0]

    def _write_node(self, name: str, root: Node) -> Node:
        return fold(root, lambda node: node.children, lambda node, children: self._node(name, node, children))

    def _node(self, name: str, node: Node, children: list[Node]) -> Node:
        scripts: list[Node] = []
        ports = tuple((port, self._port(name, node, port, text, scripts)) for port, text in node.ports)
        below = tuple(children)
        if ports != node.ports or any(one is not other for one, other in zip(below, node.children, strict=True)):
            node = node.replace(ports=ports, children=below)
        if not scripts:
            return node
        own = tuple(port for port in node.ports if port[0][:1] == "_" and port[0] != "_autoremap")
        node = node.replace(ports=tuple(port for port in node.ports if port not in own))
        return Node(SEQUENCE, (*scripts, node), own, span=node.span)

    def _port(self, name: str, node: Node, port: str, text: str, scripts: list[Node]) -> str:
        if port == "code" or (port[:1] == "_" and port != "_autoremap"):
            return self._code(name, text)
        key = blackboard_key(port, text)
        if node.id == SUBTREE:
            if port == "ID" or port[:1] == "_" or key is not None or isinstance(literal(text), str):
                return text
            facts = self._facts[self._value((node.port("ID"), port))]
            kind = self._type(facts)
            if kind == "double" and isinstance(literal(text), int):
                return f"{text}.0"
            is_text = bool(kind) and kind != "double" and not _INTEGER.fullmatch(kind)
            if is_text or (not kind and facts.is_said and isinstance(literal(text), float)):
                return self._own_key(f"'{text}'", scripts)
            return text
        wanted = self._port_types(node.id).get(port, "") if key is not None else ""
        kind = self._type(self._facts[self._value((name, key))]) if key is not None and wanted else ""
        if not kind or kind == wanted:
            return text
        if wanted == _TEXT:
            return self._own_key(f"'' .. {key}", scripts)
        numbers = wanted in _DECIMALS or _INTEGER.fullmatch(wanted), kind in _DECIMALS or _INTEGER.fullmatch(kind)
        return self._own_key(str(key), scripts) if all(numbers) else text

    def _own_key(self, code: str, scripts: list[Node]) -> str:
        self._made += 1
        scripts.append(make_script(f"_{self._made} := {code}"))
        return f"{{_{self._made}}}"

    def _code(self, name: str, code: str) -> str:
        for made in reversed(list(assignments(code))):
            if made.sign in SETS and isinstance(literal(made.number), int):
                if self._type(self._facts[self._value((name, made.key))]) in _DECIMALS:
                    code = f"{code[: made.start]}{made.number}.0{code[made.end :]}"
        return code
