"""Trees as text: `plain` for programs and diffs, `outline` for people."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from btlang.tree.node import Node, Tree

_DEEPEST = 100  # levels; below it the level is a number, since the text would grow with the square of the depth
_ESCAPES = str.maketrans({"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"})


def plain(tree: Tree) -> str:
    """One line a node, `Id port=value`, indented by two spaces a level; named subtrees follow, sorted by name.

    Nothing in it depends on how the mission was spelled or laid out.
    """
    lines = [f"BehaviorTree ID={_value(tree.name)} main=true"] if tree.name else []
    lines += [f"{_indented(depth)}{described(node)}" for depth, node in _nodes(tree.root)]
    for name, root in sorted(tree.subtrees):
        lines.append(f"BehaviorTree ID={_value(name)}")
        lines += [f"{_indented(depth + 1)}{described(node)}" for depth, node in _nodes(root)]
    return "\n".join(lines)


def described(node: Node) -> str:
    """`Id port=value`, a value in double quotes where it is not one plain word; an instance name comes first."""
    name = f" name={_value(node.name)}" if node.name else ""
    return node.id + name + "".join(f" {key}={_value(text)}" for key, text in sorted(node.ports))


def outline(tree: Tree, label: Callable[[Node], str] = described) -> str:
    """The main tree with branches drawn, then each named subtree under its name.

    Drawn by us: a terminal library fits lines to a width, and a text has none.
    """
    lines = list(_branches(tree.root, label))
    for name, root in tree.subtrees:
        lines += ["", f"{name}:", *_branches(root, label)]
    return "\n".join(lines)


def _nodes(root: Node) -> Iterator[tuple[int, Node]]:
    stack = [(0, root)]
    while stack:
        depth, node = stack.pop()
        yield depth, node
        stack.extend((depth + 1, child) for child in reversed(node.children))


def _indented(depth: int) -> str:
    return "  " * depth if depth <= _DEEPEST else f"{'  ' * _DEEPEST}[level {depth}] "


def _branches(root: Node, label: Callable[[Node], str]) -> Iterator[str]:
    stack = [(root, 0, "", "")]
    while stack:
        node, depth, head, below = stack.pop()
        yield head + label(node)
        last = len(node.children) - 1
        for i in range(last, -1, -1):
            if depth >= _DEEPEST:
                stack.append((node.children[i], depth + 1, f"{below}[level {depth + 1}] ", below))
                continue
            fork, line = ("└── ", "    ") if i == last else ("├── ", "│   ")
            stack.append((node.children[i], depth + 1, below + fork, below + line))


def _value(text: str) -> str:
    if text and not any(c.isspace() or c in '"=\\' or not c.isprintable() for c in text):
        return text
    return '"' + text.translate(_ESCAPES) + '"'
