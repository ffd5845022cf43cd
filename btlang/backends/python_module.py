"""Trees as a Python module that runs them with btlang, as `btc run` would.

Its expressions are ones that no parser of Python finds too deep.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.support.record import Record
from btlang.text.source import NOWHERE
from btlang.text.source import Source as WorldText
from btlang.tree.ast import Fact
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.shipped import keyword_files, languages, shipped, shown_name

_WIDEST = 110  # columns
_DEEPEST = 20  # calls in each other; what is deeper becomes statements of its own
_INDENT = "    "
_HEAD = '''"""A behavior tree that runs on the simulated robot: python FILE [--speed max]. Needs btlang.

The leaves do what the `call` of their keyword entry names. `mission` can be run and watched from other programs; see
btlang.Mission and btlang.Session.
"""

from btlang import Mission, Session
from btlang.api import world_vocabulary
from btlang.tree.node import Node, Tree
'''
_TREE = "\nfrom btlang.tree"
_FOOT = """
if __name__ == "__main__":
    import sys

    from btlang.run.module import run_module

    sys.exit(run_module(mission, lambda: Session(world=WORLD)))
"""


class SourceLines(Record):
    """An expression as lines, and how many calls stand in each other in it."""

    lines: tuple[str, ...]
    depth: int


class Statements:
    """The statements that must stand before an expression: `part_1 = ...`."""

    def __init__(self, prefix: str = "part_") -> None:
        self.lines: list[str] = []
        self._prefix = prefix
        self._count = 0

    def expression(self, root: Node, call: Callable[[Node, list[SourceLines]], SourceLines]) -> SourceLines:
        """Return the expression of a tree; `call` makes that of a node from those of its children."""

        def combine(node: Node, children: list[SourceLines]) -> SourceLines:
            return self.named_if_deep(call(node, children))

        return fold(root, lambda node: node.children, combine)

    def named_if_deep(self, made: SourceLines) -> SourceLines:
        """Return the expression, or the name that a statement gives it."""
        if made.depth < _DEEPEST:
            return made
        self._count += 1
        name = f"{self._prefix}{self._count}"
        self.lines += [f"{name} = {made.lines[0]}", *made.lines[1:]]
        return SourceLines((name,), 0)


def format_call(function: str, arguments: Sequence[str | SourceLines], brackets: str = "()") -> SourceLines:
    """Format a call, or with an empty `function` a tuple or list: on one line if it fits, else an argument a line."""
    depth = 1 + max((argument.depth for argument in arguments if isinstance(argument, SourceLines)), default=0)
    texts = [(argument,) if isinstance(argument, str) else argument.lines for argument in arguments]
    comma = "," if not function and len(texts) == 1 and brackets == "()" else ""
    line = f"{function}{brackets[0]}{', '.join(text[0] for text in texts)}{comma}{brackets[1]}"
    if all(len(text) == 1 for text in texts) and len(line) + depth * len(_INDENT) <= _WIDEST:
        return SourceLines((line,), depth)
    lines = [f"{function}{brackets[0]}"]
    for text in texts:
        lines += [_INDENT + part for part in text]
        lines[-1] += ","
    return SourceLines((*lines, brackets[1]), depth)


def format_literal(value: object) -> str:
    """Format a text, number, None, or list or tuple of them, with texts in double quotes."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)  # Python knows all escapes of JSON
    if isinstance(value, list):
        return f"[{', '.join(map(format_literal, value))}]"
    if isinstance(value, tuple):
        return f"({', '.join(map(format_literal, value))}{',' if len(value) == 1 else ''})"
    return repr(value)


def to_python(
    tree: Tree, vocabulary: Lexicon, *, world: str | WorldText | None = None, facts: Sequence[Fact] = ()
) -> str:
    """Return the text of a module with a name `mission`, a Mission with the keyword files of its leaves.

    Words that are Python functions (`btlang.action`) are imported. The places in the text of the mission are lost:
    failures name the leaf, but not its line. Raises MissionError (BT134) for functions that can't be imported.
    """
    functions = _functions(tree, vocabulary)
    lines = [_HEAD]
    if facts:
        lines = [_HEAD.replace(_TREE, f"\nfrom btlang.robots.worlds.world import Place{_TREE}")]
    if isinstance(world, WorldText):
        lines = [lines[0].replace(_TREE, f"\nfrom btlang.text.source import Source{_TREE}")]
    modules = dict.fromkeys(module for module, _ in functions)
    if modules:
        aliases = {module: f"words_{number}" for number, module in enumerate(modules, 1)}
        lines.append("\n".join([*(f"import {module} as {alias}" for module, alias in aliases.items()), ""]))
    used: list[str] = []
    for name, root in tree.subtrees:
        lines += _assign(f"subtree_{len(used) + 1}", root)
        used.append(f"({format_literal(name)}, subtree_{len(used) + 1})")
    lines += _assign("root", tree.root)
    arguments: list[str | SourceLines] = ["root"]
    if used:
        arguments.append(format_call("", used))
    lines += format_call(
        "TREE = Tree", [*arguments, *([f"name={format_literal(tree.name)}"] if tree.name else [])]
    ).lines
    words = [*map(format_literal, _files(tree, vocabulary)), *(f"{aliases[at]}.{name}" for at, name in functions)]
    made = format_call("", words, "[]")
    lines += [f"KEYWORDS = {made.lines[0]}", *made.lines[1:]]
    text = (
        f"Source({format_literal(world.text)}, {format_literal(world.name)})"
        if isinstance(world, WorldText)
        else format_literal(world)
    )
    lines.append(f"WORLD = {text}")
    arguments = ["TREE", "world_vocabulary(KEYWORDS, WORLD)", "WORLD"]
    if facts:
        places = [
            f"Place({', '.join(format_literal(each) for each in (fact.name, fact.x, fact.y, fact.facing))})"
            for fact in facts
        ]
        made = format_call("", places)
        lines += [f"PLACES = {made.lines[0]}", *made.lines[1:]]
        arguments.append("facts=PLACES")
    lines.append(f"mission = Mission({', '.join(map(str, arguments))})")
    return "\n".join([*lines, _FOOT])


def _assign(name: str, root: Node) -> list[str]:
    """Return statements that end with one that gives a tree the name."""
    before = Statements(f"{name}_part_")
    made = before.expression(root, _node)
    return [*before.lines, f"{name} = {made.lines[0]}", *made.lines[1:]]


def _node(node: Node, children: list[SourceLines]) -> SourceLines:
    arguments: list[str | SourceLines] = [format_literal(node.id)]
    if children:
        arguments.append(format_call("", children))
    if node.ports:
        arguments.append(f"ports={format_literal(node.ports)}")
    if node.name:
        arguments.append(f"name={format_literal(node.name)}")
    return format_call("Node", arguments)


def _files(tree: Tree, vocabulary: Lexicon) -> list[str]:
    """Return the keyword files of the leaves, without those that ship."""
    ours = {shown_name(path) for name in languages() for path in keyword_files(shipped("keywords", name))}
    entries = (entry for node in tree.walk() for entry in vocabulary.entries.get(node.id, ()))
    return sorted({entry.file for entry in entries if isinstance(entry.call, str)} - ours)


def _functions(tree: Tree, vocabulary: Lexicon) -> list[tuple[str, str]]:
    """Return the functions of the leaves: the module of each, and its name there.

    Raises MissionError (BT134) for all that another program can't import.
    """
    found: dict[tuple[str, str], None] = {}
    problems: dict[str, Diagnostic] = {}
    for node in tree.walk():
        for entry in vocabulary.entries.get(node.id, ()) if not node.children else ():
            if isinstance(entry.call, str):
                continue
            module, name = (str(getattr(entry.call, key, "")) for key in ("__module__", "__qualname__"))
            reason = _not_imported(entry.call, module, name)
            if not reason:
                found[module, name] = None
            elif entry.id not in problems:
                span = node.span or entry.span or NOWHERE
                problems[entry.id] = diagnostic("BT134", span, id=entry.id, target="Python", reason=reason)
    if problems:
        raise MissionError(list(problems.values()))
    return list(found)


def _not_imported(call: object, module: str, name: str) -> str:
    """Return why another program can't import a function, "" if it can."""
    what = f"{name.rpartition('.')[2] or call}, its function,"
    if module == "__main__":
        return f"{what} is in the script that runs; move it to a file of its own and import it"
    found: object = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    if found is not call:
        return f"{what} can't be imported from {module or 'a module'}; define it at the top of a file"
    return ""
