"""Trees as text: `plain` for programs and diffs, `Outline` for people."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from btlang.support.record import Record
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.text import Text
    from rich.tree import Tree as RichTree

_DEEPEST = 100  # levels; below it the level is a number, since the text would grow with the square of the depth
_LABEL_WIDTH = 20  # columns that a label has at least beside the branches that rich draws
_ESCAPES = str.maketrans({"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"})


def plain(tree: Tree) -> str:
    """Return one line a node, `Id port=value`, indented by two spaces a level; named subtrees follow, sorted by
    name.

    Nothing in it depends on how the mission was spelled or laid out.
    """
    lines = [f"BehaviorTree ID={_value(tree.name)} main=true"] if tree.name else []
    lines += [f"{_indent(depth)}{describe_node(node)}" for depth, node in _nodes(tree.root)]
    for name, root in sorted(tree.subtrees):
        lines.append(f"BehaviorTree ID={_value(name)}")
        lines += [f"{_indent(depth + 1)}{describe_node(node)}" for depth, node in _nodes(root)]
    return "\n".join(lines)


def describe_node(node: Node) -> str:
    """Return `Id port=value`, a value in double quotes unless it is one plain word; an instance name comes first."""
    name = f" name={_value(node.name)}" if node.name else ""
    return node.id + name + "".join(f" {key}={_value(text)}" for key, text in sorted(node.ports))


class Outline(Record):
    """Trees with their branches drawn, each under its name, which is "" for the main tree.

    `str` draws them itself, since rich fits lines to a width and a text has none; on a terminal rich does.
    """

    trees: tuple[tuple[str, Node], ...]
    label: Callable[[Node], str]

    def __str__(self) -> str:
        return "\n\n".join(
            "\n".join([*([f"{name}:"] if name else []), *_branches(root, self.label)]) for name, root in self.trees
        )

    @property
    def height(self) -> int:
        """How many lines it has, where none is folded."""
        names = sum(1 for name, _ in self.trees if name)
        return sum(1 for _, root in self.trees for _ in _nodes(root)) + names + len(self.trees) - 1

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[RenderableType]:
        from rich.text import Text

        deepest = min(_DEEPEST, (options.max_width - _LABEL_WIDTH) // 4)
        if any(depth > deepest for _, root in self.trees for depth, _ in _nodes(root)):
            yield Text(str(self), no_wrap=True, overflow="ignore")
            return
        for at, (name, root) in enumerate(self.trees):
            if name:
                yield Text("\n" * bool(at) + f"{name}:")
            yield _rich_tree(root, self.label)


def outline(tree: Tree, label: Callable[[Node], str] = describe_node) -> str:
    """Draw the main tree with branches, then each named subtree under its name."""
    return str(Outline((("", tree.root), *tree.subtrees), label))


def _rich_tree(root: Node, label: Callable[[Node], str]) -> RichTree:
    from rich.tree import Tree as RichTree

    trunk = RichTree(_Label(root, label), guide_style="dim")
    stack = [(root, trunk)]
    while stack:
        node, branch = stack.pop()
        stack += [(child, branch.add(_Label(child, label))) for child in node.children]
    return trunk


class _Label(Record):
    """A label that is worded when it is drawn: the prompt draws only as many as there is room for."""

    node: Node
    label: Callable[[Node], str]

    def __rich__(self) -> Text:
        from rich.text import Text

        text = Text(self.label(self.node), overflow="fold")
        text.highlight_regex(r"^\w+", "bold")
        return text


def _nodes(root: Node) -> Iterator[tuple[int, Node]]:
    stack = [(0, root)]
    while stack:
        depth, node = stack.pop()
        yield depth, node
        stack.extend((depth + 1, child) for child in reversed(node.children))


def _indent(depth: int) -> str:
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
