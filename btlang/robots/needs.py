"""What a mission needs of the body of a robot."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.robots.body import Body
from btlang.text.source import NOWHERE, Span
from btlang.vocabulary.capabilities import POSTURE, part_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon


def needs_of(node: Node, vocabulary: Lexicon) -> tuple[str, ...]:
    """What a leaf needs, by the keyword entry that does its work."""
    entries = vocabulary.entries.get(node.id, ())
    chosen = next((entry for entry in reversed(entries) if entry.replaces), entries[0] if entries else None)
    return chosen.needs if chosen is not None else ()


def needs_of_tree(tree: Tree, vocabulary: Lexicon) -> tuple[str, ...]:
    """What its leaves need of a robot, each capability once, in the order of the alphabet."""
    return tuple(sorted({need for node in tree.walk() for need in needs_of(node, vocabulary)}))


def lacking(body: Body, tree: Tree, vocabulary: Lexicon, but: Collection[str] = ()) -> dict[str, Node]:
    """Each part that the body lacks, with the first leaf that needs it; but for leaves of some ids."""
    found: dict[str, Node] = {}
    for node in tree.walk():
        missing = [] if node.id in but else [need for need in needs_of(node, vocabulary) if not body.has(need)]
        parts = [need for need in missing if not need.startswith(POSTURE)]
        for need in parts or missing:  # without an arm no posture of it is missed
            found.setdefault(part_of(need), node)
    return found


def check_body(body: Body, tree: Tree, vocabulary: Lexicon, but: Collection[str] = ()) -> None:
    """Raises MissionError with all parts that the body lacks, each at the first leaf that needs it (BT072)."""
    by_leaf: dict[int, tuple[Node, list[str]]] = {}
    for part, node in lacking(body, tree, vocabulary, but).items():
        by_leaf.setdefault(id(node), (node, []))[1].append(part)
    if by_leaf:
        raise MissionError([lack(body, parts, node) for node, parts in by_leaf.values()])


def words_of(node: Node) -> str:
    """How the mission says it; the id of a node that has no place in a text."""
    return node.span.text if node.span is not None else node.id


def lack(body: Body, parts: Sequence[str], node: Node, span: Span | None = None, help: str = "") -> Diagnostic:
    """BT072: the body lacks parts, such as "left arm", that a leaf needs; by default at the leaf."""
    said = [part for part in parts if not any(other.endswith(f" {part}") for other in parts)]  # a right hand is a hand
    place, listed = span or node.span or NOWHERE, " and no ".join(said)
    return diagnostic("BT072", place, words=words_of(node), parts=listed, robot=body.name, help=help)
