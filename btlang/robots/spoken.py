"""What a mission asks about the answers that it gets: the choices that those who answer have."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.tree.node import Tree
    from btlang.vocabulary.lexicon import Lexicon

_ASKS = "btlang.actions.conversation:answer_is"


def choices(tree: Tree, vocabulary: Lexicon) -> tuple[str, ...]:
    """The texts that answers are compared with, each once; but for those that are only known during the run."""
    found: dict[str, None] = {}
    for node in tree.walk():
        if any(entry.call == _ASKS for entry in vocabulary.entries.get(node.id, ())):
            found.update((value, None) for name, value in node.ports if name == "text" and "{" not in value)
    return tuple(found)
