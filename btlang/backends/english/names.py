"""Names in a tree that can be said: its subtrees, their parameters, loops and values."""

from __future__ import annotations

from collections.abc import Set

from btlang.backends.english.code import Loop, find_loops
from btlang.backends.english.type_inference import KnownTypes, TypeInference, parameters
from btlang.frontends.mission.symbols.definitions import find_definitions
from btlang.frontends.mission.symbols.phrases import Phrases
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Tree
from btlang.vocabulary.language_tables import CHANGING
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import keys_set_in


class Refused(Record):
    """What couldn't be said naturally: names of subtrees, and keys of values of the whole mission.

    `unset` are keys that a node sets, but nothing that is said.
    """

    names: Set[str] = frozenset()
    keys: Set[str] = frozenset()
    unset: Set[str] = frozenset()


class SpokenNames:
    """The names of a tree: `names` are the subtrees that are said as phrases, `loops` those that are bodies of `for
    each`.

    With `values` False there are no loops and no parameters, and values are only given to the mission; without `given`
    no value has a name, either. With `sure` no name has a parameter whose type depends on its first use.
    """

    def __init__(
        self, tree: Tree, vocabulary: Lexicon, refused: Refused, *, values: bool, given: bool, sure: bool = False
    ) -> None:
        self._given = given
        named = [name for name, _ in tree.subtrees if name not in refused.names and is_phrase(name, vocabulary)]
        self.names = frozenset(name for name in named if values or not parameters(name))
        self.loops: dict[int, Loop] = find_loops(tree, refused.names | self.names) if values else {}
        unset = refused.unset if values else None
        self._kinds = TypeInference(vocabulary, self.names, self.loops, refused.keys, unset)
        bodies = {loop.name for loop in self.loops.values()}
        if given:
            for name, root in (("", tree.root), *tree.subtrees):
                if name not in bodies:
                    self._kinds.read(root, self._owners(name))
        else:
            self._nothing = KnownTypes({}, {}, vocabulary)
        self._unsayable = {
            name for name in self.names if any(not self._has_type(name, key, sure) for key in parameters(name))
        }

    def _owners(self, name: str) -> dict[str, str]:
        return dict.fromkeys(parameters(name), name) if name in self.names else {}

    def _has_type(self, owner: str, key: str, sure: bool) -> bool:
        kind = self._kinds.kind((owner, key))
        return kind is not None and not (sure and self._kinds.is_doubtful((owner, key)))

    def kind(self, owner: str, key: str) -> str | None:
        """Return the type of a parameter."""
        return self._kinds.kind((owner, key))

    def parameters(self, name: str) -> tuple[tuple[str, str], ...]:
        """Return the parameters of a subtree with their types."""
        return tuple((key, self.kind(name, key) or "text") for key in self._owners(name))

    def around(self, name: str) -> KnownTypes:
        """Return what is known in the tree of a name, "" for the main tree."""
        return self._kinds.around(self._owners(name)) if self._given else self._nothing

    def inside(self, around: KnownTypes, loop: Loop) -> KnownTypes:
        """Return what is known in the body of a loop."""
        return self._kinds.around({**around.owners, loop.key: loop.name})

    def find_refused(self, mission: ast.Program, before: Refused, loops: Set[str]) -> Refused:
        """Add to `before` what in this mission couldn't be read: `loops`, and values with which something is wrong."""
        local = {loop.key for loop in self.loops.values()} | {key for name in self.names for key in parameters(name)}
        said = _MissionKeys(mission)
        unset = said.used.keys() - said.set - said.chosen
        outside = self.around("").outside
        wrong = (said.set | (unset & outside)) & local
        return Refused(
            before.names | loops | self._unsayable, before.keys | wrong, before.unset | (unset - outside - before.keys)
        )


def find_given_keys(mission: ast.Program) -> tuple[str, ...]:
    """Find the keys of the values that a mission uses and nothing in it sets, in the order of their use."""
    said = _MissionKeys(mission)
    known = said.set | said.chosen | said.outputs
    return tuple(
        key
        for key, users in said.used.items()
        if key not in known and not all(key in said.arguments.get(user, ()) for user in users)
    )


class _MissionKeys:
    """The keys of values of the whole mission: those that are `set`, `chosen` or `outputs` of nodes, and those
    `used`.

    `used` has the names of the subtrees in quotes that use a key, "" for anywhere else; `arguments` are what such
    subtrees get.
    """

    def __init__(self, mission: ast.Program) -> None:
        self.set: set[str] = set()
        self.chosen: set[str] = set()
        self.outputs: set[str] = set()
        self.used: dict[str, set[str]] = {}
        self.arguments: dict[str, set[str]] = {}
        stack: list[tuple[ast.Ast, frozenset[str], str]] = [(mission, frozenset(), "")]
        while stack:
            item, bound, user = stack.pop()
            if isinstance(item, ast.Remember) or (isinstance(item, ast.Assign) and item.operation == "set"):
                self.set.add(item.key)
            elif isinstance(item, ast.Exact | ast.Phrase):
                self._node(item)
            self.chosen.update(ast.chosen_keys(item))
            for key in ast.keys_of(item):
                if key not in bound:
                    self.used.setdefault(key, set()).add(user)
            if isinstance(item, ast.ForEach):
                bound |= {item.key}
            elif isinstance(item, ast.Definition):
                bound, user = bound | dict(item.parameters).keys(), item.name if item.is_quoted else ""
            stack += [(part, bound, user) for part in reversed(ast.parts(item))]

    def _node(self, node: ast.Exact | ast.Phrase) -> None:
        ports = dict(node.ports)
        self.outputs.update(key for text in ports.values() for key in keys_set_in(text))
        outputs = [ports[port] for port in node.outputs]
        if isinstance(node, ast.Phrase):
            outputs += [text for slot, text in node.arguments if slot in node.entry.outputs]
        self.outputs.update(text[1:-1] for text in outputs if text[:1] == "{")
        if isinstance(node, ast.Exact) and node.id == SUBTREE:
            self.arguments.setdefault(ports.pop("ID", ""), set()).update(ports)


def is_phrase(name: str, vocabulary: Lexicon) -> bool:
    """Whether words define just this name."""
    words = [word for word in name.split(" ") if not (word[:1] == "{" and word[-1:] == "}")]
    keys = parameters(name)
    own = (key.replace("_", "x") for key in keys)
    if not all(word.isalnum() for word in (*words, *own)) or name != name.lower() or len(keys) > len(set(keys)):
        return False
    if any(word in vocabulary.roles[role] for role in CHANGING for word in words):
        return False
    text = split(
        Source(f"{name} {vocabulary.word('define_strong')} {vocabulary.word('nothing')}"), vocabulary.orthography
    )
    found = find_definitions(Phrases(text, vocabulary))
    return not found.problems and [header.name for header in found.headers.values()] == [name]
