"""What of a tree has a name that can be said: its subtrees, their parameters, loops and values."""

from __future__ import annotations

from collections.abc import Set

from btlang.backends.english.loops import Loop, find_loops
from btlang.backends.english.type_inference import Around, TypeInference, parameters
from btlang.frontends.mission.symbols.definitions import find_definitions
from btlang.frontends.mission.symbols.phrases import Phrases
from btlang.record import Record
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.node import Tree
from btlang.vocabulary.lexicon import Lexicon


class Refused(Record):
    """What turned out not to be said naturally: names of subtrees, and keys of values of the whole mission."""

    names: Set[str] = frozenset()
    keys: Set[str] = frozenset()


class Names:
    """`names` are the subtrees that are said as phrases, `loops` those that are bodies of `for each`.

    With `values` False there are no loops and no parameters, and no value has a name. With `sure` no name has a
    parameter whose type hangs on where it is used first.
    """

    def __init__(self, tree: Tree, vocabulary: Lexicon, refused: Refused, *, values: bool, sure: bool = False) -> None:
        self._values = values
        named = [name for name, _ in tree.subtrees if name not in refused.names and is_phrase(name, vocabulary)]
        self.names = frozenset(name for name in named if values or not parameters(name))
        self.loops: dict[int, Loop] = find_loops(tree, refused.names | self.names) if values else {}
        self._kinds = TypeInference(vocabulary, self.names, self.loops, refused.keys)
        bodies = {loop.name for loop in self.loops.values()}
        if values:
            for name, root in (("", tree.root), *tree.subtrees):
                if name not in bodies:
                    self._kinds.read(root, self._owners(name))
        else:
            self._nothing = Around({}, {}, vocabulary)
        self._unsayable = {
            name for name in self.names if any(not self._has_type(name, key, sure) for key in parameters(name))
        }

    def _owners(self, name: str) -> dict[str, str]:
        return dict.fromkeys(parameters(name), name) if name in self.names else {}

    def _has_type(self, owner: str, key: str, sure: bool) -> bool:
        kind = self._kinds.kind((owner, key))
        return kind is not None and not (sure and self._kinds.is_doubtful((owner, key)))

    def kind(self, owner: str, key: str) -> str | None:
        """The type of a parameter."""
        return self._kinds.kind((owner, key))

    def parameters(self, name: str) -> tuple[tuple[str, str], ...]:
        """The parameters of a subtree with their types."""
        return tuple((key, self.kind(name, key) or "text") for key in self._owners(name))

    def around(self, name: str) -> Around:
        """What is known in the tree of a name, "" for the main tree."""
        return self._kinds.around(self._owners(name)) if self._values else self._nothing

    def inside(self, around: Around, loop: Loop) -> Around:
        """What is known in the body of a loop."""
        return self._kinds.around({**around.owners, loop.key: loop.name})

    def refused_by(self, mission: ast.Program, before: Refused, loops: Set[str]) -> Refused:
        """`before` with what in this mission could not be read: `loops`, and values with which something is wrong."""
        given: set[str] = set()
        used: set[str] = set()
        chosen: set[str] = set()
        local = {loop.key for loop in self.loops.values()} | {key for name in self.names for key in parameters(name)}
        stack: list[tuple[ast.Ast, frozenset[str]]] = [(mission, frozenset())]
        while stack:
            item, bound = stack.pop()
            if isinstance(item, ast.Remember) or (isinstance(item, ast.Assign) and item.operation == "set"):
                given.add(item.key)
            chosen.update(ast.chosen_keys(item))
            used.update(key for key in ast.keys_of(item) if key not in bound)
            if isinstance(item, ast.ForEach):
                bound |= {item.key}
            elif isinstance(item, ast.Definition):
                bound |= dict(item.parameters).keys()
            stack += [(part, bound) for part in ast.parts(item)]
        wrong = (used - given - chosen) | (given & local)
        return Refused(before.names | loops | self._unsayable, before.keys | wrong)


def is_phrase(name: str, vocabulary: Lexicon) -> bool:
    """Whether words define just this name."""
    words = [word for word in name.split(" ") if not (word[:1] == "{" and word[-1:] == "}")]
    keys = parameters(name)
    own = (key.replace("_", "x") for key in keys)
    if not all(word.isalnum() for word in (*words, *own)) or name != name.lower() or len(keys) > len(set(keys)):
        return False
    text = split(
        Source(f"{name} {vocabulary.word('define_strong')} {vocabulary.word('nothing')}"), vocabulary.orthography
    )
    found = find_definitions(Phrases(text, vocabulary))
    return not found.problems and [header.name for header in found.headers.values()] == [name]
