"""Trees as a Python module that builds them with py_trees, and needs nothing else where that is possible."""

from __future__ import annotations

import ast
import keyword
import pkgutil
import re
from collections.abc import Iterable, Mapping
from functools import cache

from btlang.backends.py_trees.plan import Part, Plan, Variable, plan_of
from btlang.backends.python_module import SourceLines, Statements, format_call, format_literal
from btlang.tree.node import Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon

# Their text is copied: imports would make a module some 200 lines shorter, but it would need btlang to run.
_MODULES = ("node", "sequences", "control_nodes", "decorators")
_HEAD = '''"""A behavior tree for py_trees 2.6; needs {needs}.

`create_root` makes the tree. Its leaves are made by a function that you give: leaf(name, id, ports) returns a
behaviour; without one they print what they would do, and succeed. python FILE [TICKS] shows the tree and ticks it.
A node that is skipped has the status INVALID.
{zones}"""

from __future__ import annotations

import sys
import time
{imports}
'''
_IMPORTS = {
    "abc": ("abstractmethod",),
    "collections.abc": ("Callable", "Generator", "Iterator", "Sequence"),
    "typing": ("Any", "ClassVar", "Protocol"),
    "py_trees": ("behaviour", "behaviours", "common", "composites", "decorators", "display"),
}
_VALUES = """
from btlang.backends.py_trees.values import engine_leaf, values_of
from btlang.engine.blackboard import Blackboard
"""
_LEAF = '''

class PrintingLeaf(behaviour.Behaviour):
    """Stands for a leaf: prints what it would do, and succeeds."""

    def __init__(self, name: str, id: str, ports: dict[str, str]) -> None:
        super().__init__(name)

    def update(self) -> common.Status:
        print(self.name)
        return common.Status.SUCCESS
'''
_ABOUT_ZONES = """
The nodes KeepOut and KeepIn use `zones`, an object of yours (RestrictableZones below). They fail if `begin` raises an
exception. Without such an object, what holds is printed.
"""
_ZONES = '''

class PrintingRestriction:
    """Stands for zones that hold: prints when they begin and end."""

    def __init__(self, text: str) -> None:
        self.text = text

    def begin(self) -> None:
        print(self.text)

    def end(self) -> None:
        print(f"{self.text}: over")


class PrintingZones:
    """Stands for the zones of a robot."""

    def keep_out(self, *names: str) -> PrintingRestriction:
        return PrintingRestriction(f"keep out of {', '.join(names)}")

    def keep_in(self, *names: str) -> PrintingRestriction:
        return PrintingRestriction(f"stay in {', '.join(names)}")
'''
_DECORATOR = '''

class {name}(decorators.PassThrough):
    """Stands for {id}, a node of another program: has the status of its child until you write what it does."""

    def __init__(self, name: str, child: behaviour.Behaviour, ports: dict[str, str]) -> None:
        super().__init__(name, child)
        self.ports = ports
'''
_COMPOSITE = '''

class {name}(composites.Sequence):
    """Stands for {id}, a node of another program: a sequence until you write what it does."""

    def __init__(self, name: str, children: list[behaviour.Behaviour], ports: dict[str, str]) -> None:
        super().__init__(name, memory=True, children=children)
        self.ports = ports
'''
_CREATE = '''

def create_root(
    leaf: Callable[[str, str, dict[str, str]], behaviour.Behaviour] = PrintingLeaf,
    now: Callable[[], float] = time.monotonic,
{zones}) -> behaviour.Behaviour:
    """The root of the tree; `now` is the time in seconds."""
'''
_FOOT = """

if __name__ == "__main__":
    root = create_root()
    print(display.unicode_tree(root))
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 10):
        root.tick_once()
        print(root.status.value)
        if root.status != common.Status.RUNNING:
            break
        time.sleep(0.1)
"""
_INDENT = "    "


def to_module(tree: Tree, vocabulary: Lexicon) -> str:
    """Return the text of the module; errors as for `plan_of`. It has the statuses that to_py_trees has (build.py)."""
    plan = plan_of(tree, vocabulary, with_parents=True)
    parents = _parents(plan)
    with_values = "engine_leaf" in plan.uses
    body = "\n".join([_INDENT + line for line in _body(plan, with_values, parents)])
    with_zones = not plan.uses.isdisjoint(("KeepOut", "KeepIn"))
    create = _CREATE.format(zones=f"{_INDENT}zones: RestrictableZones = PrintingZones(),\n" if with_zones else "")
    stands_for = "".join(map(_class_of, parents.items()))
    made = _LEAF + stands_for + (_ZONES if with_zones else "") + create + body + "\n" + _FOOT
    rest = (_VALUES if with_values else "") + _definitions(plan.uses) + made
    needs = "py_trees, and btlang for the values of the mission" if with_values else "only py_trees"
    imports = []
    for module, names in _IMPORTS.items():
        used = [name for name in names if re.search(rf"\b{name}\b", rest)]
        if used:
            space = "\n" if module == "py_trees" else ""
            imports.append(f"{space}from {module} import {', '.join(used)}")
    zones = _ABOUT_ZONES if with_zones else ""
    return _HEAD.format(needs=needs, imports="\n".join(imports), zones=zones) + rest


def _parents(plan: Plan) -> dict[tuple[str, bool], str]:
    """Return the names of the classes for unknown nodes with children, by the id and whether they have several."""
    found: dict[tuple[str, bool], str] = {}
    taken = {*keyword.kwlist, *(name for names in _IMPORTS.values() for name in names)}
    own = ((pkgutil.get_data(__package__, f"{module}.py") or b"").decode() for module in _MODULES)
    for text in (*own, _LEAF, _ZONES, _CREATE, _VALUES):
        taken.update(re.findall(r"[^\W\d]\w*", text))
    for part in _parts(plan.root):
        if part.make == "parent":
            key = _parent_key(part)
            name = re.sub(r"\W", "_", key[0], flags=re.ASCII)
            name = name if name[:1].isalpha() else f"Node{name}"
            while key not in found and name in taken:
                name += "_"
            taken.add(found.setdefault(key, name))
    return found


def _parent_key(part: Part) -> tuple[str, bool]:
    return dict(part.arguments)["id"], len(part.children) > 1


def _class_of(parent: tuple[tuple[str, bool], str]) -> str:
    (node_id, has_several), name = parent
    shown = re.sub(r"[^\w .-]", "_", node_id)  # no quotes or backslashes in a docstring
    return (_COMPOSITE if has_several else _DECORATOR).format(name=name, id=shown)


def _body(plan: Plan, with_values: bool, parents: Mapping[tuple[str, bool], str]) -> list[str]:
    """Return the lines of `create_root`."""
    lines = []
    if any(argument == Variable("interrupts") for part in _parts(plan.root) for _, argument in part.arguments) or (
        "interrupting" in plan.uses
    ):
        lines.append("interrupts: list[Callable[[], None]] = []")
    if with_values:
        lines.append("values = Blackboard()")
        lines += [f"{s.name} = values_of({_literal(dict(s.ports))}, {s.around})" for s in plan.scopes]
    statements = Statements()

    def combine(part: Part, children: list[SourceLines]) -> SourceLines:
        return statements.named_if_deep(_call(part, children, parents))

    root = fold(plan.root, lambda part: part.children, combine)
    return [*lines, *statements.lines, f"return {root.lines[0]}", *root.lines[1:]]


def _call(part: Part, children: list[SourceLines], parents: Mapping[tuple[str, bool], str]) -> SourceLines:
    if part.make == "parent":
        ports = _literal(dict(part.arguments)["ports"])
        below = format_call("", children, "[]") if len(children) > 1 else children[0]
        return format_call(parents[_parent_key(part)], [format_literal(part.name), below, ports])
    if part.make == "leaf":
        values = dict(part.arguments)
        made = format_call("leaf", [format_literal(part.name), format_literal(values["id"]), _literal(values["ports"])])
    else:
        arguments: list[str | SourceLines] = [format_literal(part.name)]
        if part.make.startswith("decorators."):
            arguments += children
        elif children:
            listed = format_call("", children, "[]")
            arguments.append(SourceLines((f"children={listed.lines[0]}", *listed.lines[1:]), listed.depth))
        made = format_call(part.make, [*arguments, *(f"{key}={_literal(value)}" for key, value in part.arguments)])
    return format_call("interrupting", [made, "interrupts"]) if part.starts else made


def _literal(value: object) -> str:
    if isinstance(value, Variable):
        return value.text
    if isinstance(value, dict):
        return "{" + ", ".join(f"{format_literal(key)}: {format_literal(text)}" for key, text in value.items()) + "}"
    return format_literal(value)


def _parts(root: Part) -> Iterable[Part]:
    waiting = [root]
    while waiting:
        part = waiting.pop()
        yield part
        waiting += reversed(part.children)


def _definitions(used: Iterable[str]) -> str:
    """Return the text of our classes and functions of these names, and of what they use; "" if none is ours."""
    constants, texts, needs = _own_code()
    wanted: set[str] = set()
    waiting = [name for name in used if name in texts]
    while waiting:
        name = waiting.pop()
        if name not in wanted:
            wanted.add(name)
            waiting += [needed for needed in needs[name] if needed in texts]
    if not wanted:
        return ""
    copied = [text for name, text in texts.items() if name in wanted]
    return "\n" + "\n".join(constants) + "\n\n\n" + "\n\n\n".join(copied) + "\n"


@cache
def _own_code() -> tuple[list[str], dict[str, str], dict[str, set[str]]]:
    """Return the texts of our constants, those of our classes and functions by name, and the names that each uses."""
    constants: list[str] = []
    texts: dict[str, str] = {}
    needs: dict[str, set[str]] = {}
    for module in _MODULES:
        data = pkgutil.get_data(__package__, f"{module}.py") or b""
        lines = data.split(b"\n")  # ast.get_source_segment splits them again for each item
        for item in ast.parse(data).body:
            *above, last = lines[item.lineno - 1 : item.end_lineno]
            source = b"\n".join([*above, last[: item.end_col_offset]]).decode()
            if isinstance(item, ast.ClassDef | ast.FunctionDef):
                texts[item.name] = source
                needs[item.name] = {name.id for name in ast.walk(item) if isinstance(name, ast.Name)}
            elif isinstance(item, ast.Assign):
                constants.append(source)
    return constants, texts, needs
