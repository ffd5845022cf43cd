"""The back end `english`: what is written is read again, and given out only where it means the same tree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.backends.english.comments import comments_of
from btlang.backends.english.raised import NOWHERE
from btlang.backends.english.raising import Raiser
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.english.exact import is_one_piece
from btlang.english.sentence import mission_lines
from btlang.frontends.definitions import find_definitions
from btlang.frontends.mission import read_mission
from btlang.passes import lower_mission
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree.ast import Fact, Mission
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from btlang.vocabulary.vocabulary import Vocabulary

WIDTH = 100
"""Columns; what would be a longer line becomes a block where it can."""


def to_english(tree: Tree, vocabulary: Vocabulary, *, facts: Sequence[Fact] = ()) -> str:
    """A mission that compiles to an equal tree: natural words where the language has them, else nodes by their ids.

    It begins with the `facts`, whose places it may name. Raises MissionError (BT142) for a tree that no text can say,
    such as one with a line end in the name of a subtree.
    """
    names = [name for name, _ in tree.subtrees] + [name for node in tree.walk() for name, _ in node.ports]
    odd = next((name for name in names if not is_one_piece(name)), None)
    if odd is not None:
        raise _unsayable(tree, f"no quotes can hold the name {odd!r}")
    wanted, reason = plain(tree), "it would be read as another one"
    for natural in (True, False):
        text = "".join(f"{line}\n" for line in _lines(tree, vocabulary, natural, tuple(facts)))
        try:
            mission = read_mission(Source(text), vocabulary, suggest=False).mission
            if plain(lower_mission(mission, vocabulary)) == wanted:
                return text
        except MissionError as error:
            reason = error.diagnostics[0].message.rstrip(".")
    raise _unsayable(tree, reason)


def _unsayable(tree: Tree, reason: str) -> MissionError:
    return MissionError([diagnostic("BT142", tree.root.span or NOWHERE, reason=reason)])


def _lines(tree: Tree, vocabulary: Vocabulary, natural: bool, facts: tuple[Fact, ...]) -> Iterator[str]:
    if facts:
        vocabulary = vocabulary.with_places(tuple(fact.name for fact in facts))
    names = [name for name, _ in tree.subtrees if natural and _is_phrase(name, vocabulary)]
    raiser = Raiser(tree, vocabulary, names, natural=natural)
    definitions = tuple(raiser.definition(name, root) for name, root in _used_first(tree))
    mission = Mission(raiser.main(tree.root), definitions, NOWHERE, facts, name=tree.name)
    comments = comments_of(tree)
    yield from (f"# {line}" for line in comments.head)
    yield from mission_lines(mission, raiser.speaker, WIDTH)
    yield from (f"# {line}" for line in comments.foot)


def _is_phrase(name: str, vocabulary: Vocabulary) -> bool:
    """Whether words define just this name."""
    if not all(word.isalnum() for word in name.split(" ")) or name != name.lower():
        return False
    text = split(Source(f"{name} {vocabulary.word('define_strong')} {vocabulary.word('nothing')}"), vocabulary.articles)
    found = find_definitions(text, vocabulary)
    return not found.problems and [header.name for header in found.headers.values()] == [name]


def _used_first(tree: Tree) -> Iterator[tuple[str, Node]]:
    """The subtrees, used ones before their users; of some in a circle one is used before it stands."""
    roots = dict(tree.subtrees)
    done: set[str] = set()
    for start in roots:
        stack = [(start, False)]
        while stack:
            name, left = stack.pop()
            if left:
                yield name, roots[name]
            elif name not in done:
                done.add(name)
                stack.append((name, True))
                stack += [(used, False) for used in reversed(_used_by(roots[name])) if used in roots]


def _used_by(root: Node) -> list[str]:
    return [node.port("ID") for node in Tree(root).walk() if node.id == "SubTree"]
