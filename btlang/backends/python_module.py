"""Trees as a Python module that runs them with btlang, as `btc run` would."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.backends.python_source import Source, Statements, called, literal
from btlang.text.source import Source as WorldText
from btlang.tree.ast import Fact
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.shipped import keyword_files, languages, shipped, shown_name

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


def to_python(
    tree: Tree, vocabulary: Lexicon, *, world: str | WorldText | None = None, facts: Sequence[Fact] = ()
) -> str:
    """The text of a module with a name `mission`, a Mission with the keyword files of its leaves.

    Words that are Python objects (`btlang.action`) can't be written: such a leaf is unknown there. The places in the
    text of the mission are lost, too: failures name the leaf, but not its line.
    """
    lines = [_HEAD]
    if facts:
        lines = [_HEAD.replace(_TREE, f"\nfrom btlang.robots.worlds.world import Place{_TREE}")]
    if isinstance(world, WorldText):
        lines = [lines[0].replace(_TREE, f"\nfrom btlang.text.source import Source{_TREE}")]
    used: list[str] = []
    for name, root in tree.subtrees:
        lines += _assigned(f"subtree_{len(used) + 1}", root)
        used.append(f"({literal(name)}, subtree_{len(used) + 1})")
    lines += _assigned("root", tree.root)
    arguments: list[str | Source] = ["root"]
    if used:
        arguments.append(called("", used))
    lines += called("TREE = Tree", [*arguments, *([f"name={literal(tree.name)}"] if tree.name else [])]).lines
    lines.append(f"KEYWORDS = {literal(_files(tree, vocabulary))}")
    text = f"Source({literal(world.text)}, {literal(world.name)})" if isinstance(world, WorldText) else literal(world)
    lines.append(f"WORLD = {text}")
    arguments = ["TREE", "world_vocabulary(KEYWORDS, WORLD)", "WORLD"]
    if facts:
        places = [
            f"Place({literal(fact.name)}, {literal(fact.x)}, {literal(fact.y)}, {literal(fact.facing)})"
            for fact in facts
        ]
        made = called("", places)
        lines += [f"PLACES = {made.lines[0]}", *made.lines[1:]]
        arguments.append("facts=PLACES")
    lines.append(f"mission = Mission({', '.join(map(str, arguments))})")
    return "\n".join([*lines, _FOOT])


def _assigned(name: str, root: Node) -> list[str]:
    """Statements that end with one that gives a tree the name."""
    before = Statements(f"{name}_part_")
    made = before.expression(root, _node)
    return [*before.lines, f"{name} = {made.lines[0]}", *made.lines[1:]]


def _node(node: Node, children: list[Source]) -> Source:
    arguments: list[str | Source] = [literal(node.id)]
    if children:
        arguments.append(called("", children))
    if node.ports:
        arguments.append(f"ports={literal(node.ports)}")
    if node.name:
        arguments.append(f"name={literal(node.name)}")
    return called("Node", arguments)


def _files(tree: Tree, vocabulary: Lexicon) -> list[str]:
    """The keyword files of the leaves, without those that ship."""
    ours = {shown_name(path) for name in languages() for path in keyword_files(shipped("keywords", name))}
    entries = (entry for node in tree.walk() for entry in vocabulary.entries.get(node.id, ()))
    return sorted({entry.file for entry in entries if isinstance(entry.call, str)} - ours)
