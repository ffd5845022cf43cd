"""Sentences as people write them, each with the tree that it means, and the notation of those trees.

A sample is the text of a mission, its tree behind `= `, and no blank line:

    Go to the kitchen. Then bring the tea to Alice.
    = S(GoTo place=kitchen, Bring object=tea person=Alice)

A tree is `Id port=value(child, child)`, ports sorted, with S, F, P and RS for the four usual nodes. A line indented by
two blanks continues it, and a line `name := tree` adds a named subtree. `= refused` is for a mission without a good
reading. After that, `> ` is a sentence that the error message offers (even where a tree says what people mean),
`! warning` is for a mission that deserves a warning, and `# ` says why people mean this tree. Only the Sequence of a
list (`go to the lab and the lobby`, `for each ...`) stays inside another one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import btlang
from btlang.support.record import Record
from btlang.tree.node import Node, Tree

FOLDER = Path(__file__).parent
PACK, WORLD = str(FOLDER / "people.toml"), str(FOLDER / "world.toml")
SHORT = {"Sequence": "S", "Fallback": "F", "Parallel": "P", "ReactiveSequence": "RS"}
_LONG = {short: id for id, short in SHORT.items()}
_PORT = re.compile(r' (\w+)=("(?:[^"\\]|\\.)*"|[^\s"=\\(),]+)')
_HEAD = re.compile(rf"(\w+)((?:{_PORT.pattern})*)")
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}
_ESCAPED = {escape: character for character, escape in _ESCAPES.items()}


class Sample(Record):
    """A mission and what it means. `line` is its first line in the file; `tree` is in the notation, "" if refused."""

    file: str
    line: int
    text: str
    tree: str
    refused: bool
    proposals: tuple[str, ...]
    warned: bool

    @property
    def place(self) -> str:
        """The file and line."""
        return f"{self.file}:{self.line}"


def compiled(text: str) -> btlang.Mission:
    """A mission in the words, and in the world, of the samples."""
    return btlang.parse_tree(text, keywords=[PACK], world=WORLD)


def written(tree: Tree) -> str:
    """The main tree on one line, then a line `name := tree` for each named subtree, sorted by name."""
    return "\n".join([_node(tree.root), *(f"{name} := {_node(root)}" for name, root in sorted(tree.subtrees))])


def parsed(text: str) -> Tree:
    """The tree that `written` gives as this text. ValueError if the text isn't in the notation."""
    main, *named = text.split("\n")
    pairs = (line.partition(" := ") for line in named)
    return Tree(_root(main), tuple((name, _root(tree)) for name, _, tree in pairs))


def samples() -> list[Sample]:
    """All samples, by file and line. ValueError names a sample without a tree, or an unknown kind of line."""
    return [sample for path in sorted(FOLDER.glob("*.txt")) for sample in _samples(path)]


def _root(text: str) -> Node:
    node, end = _parsed(text, 0)
    if end != len(text):
        raise ValueError(f"{text[end:]!r} follows a whole tree")
    return node


def _parsed(text: str, at: int) -> tuple[Node, int]:
    """The node that begins there, and where it ends."""
    head = _HEAD.match(text, at)
    if not head:
        raise ValueError(f"no node at {text[at:]!r}")
    at = head.end()
    children: list[Node] = []
    while text.startswith(", " if children else "(", at):
        child, at = _parsed(text, at + (2 if children else 1))
        children.append(child)
    if children and not text.startswith(")", at):
        raise ValueError(f"no ')' at {text[at:]!r}")
    ports = tuple((key, _unquoted(value)) for key, value in _PORT.findall(head[2]))
    return Node(_LONG.get(head[1], head[1]), tuple(children), ports), at + bool(children)


def _node(node: Node) -> str:
    ports = [("name", node.name)] * bool(node.name) + sorted(node.ports)
    children = f"({', '.join(_node(child) for child in node.children)})" if node.children else ""
    return SHORT.get(node.id, node.id) + "".join(f" {key}={_value(text)}" for key, text in ports) + children


def _value(text: str) -> str:
    plain = re.fullmatch(r'[^\s"=\\(),]+', text)
    return text if plain else '"' + "".join(_ESCAPES.get(c, c) for c in text) + '"'


def _unquoted(value: str) -> str:
    return re.sub(r"\\.", lambda escape: _ESCAPED[escape[0]], value[1:-1]) if value.startswith('"') else value


def _samples(path: Path) -> Iterator[Sample]:
    text = path.read_text(encoding="utf-8")
    for match in re.finditer(r"(?:.+\n)+", text):
        line = text.count("\n", 0, match.start()) + 1
        mission, found, parts = match[0].partition("\n= ")
        if not found:
            raise ValueError(f"{path.name}:{line}: no tree")
        yield _sample(path.name, line, mission, parts.splitlines())


def _sample(file: str, line: int, text: str, parts: list[str]) -> Sample:
    trees = parts[:1]
    proposals = []
    for part in parts[1:]:
        if part.startswith("  "):
            trees[-1] += " " + part.strip()
        elif part.startswith("> "):
            proposals.append(part[2:])
        elif " := " in part:
            trees.append(part)
        elif part != "! warning" and not part.startswith("# "):
            raise ValueError(f"{file}:{line}: {part!r} is no part of a sample")
    refused = trees == ["refused"]
    return Sample(
        file, line, text, "" if refused else "\n".join(trees), refused, tuple(proposals), "! warning" in parts
    )
