"""The target English: what is written is read again, and returned only if it means the same tree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.backends.btcpp.markup import Markers
from btlang.backends.english.comments import Comments, comments_of
from btlang.backends.english.lift import Lifter
from btlang.backends.english.names import Refused, SpokenNames, find_given_keys
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.frontends.btcpp.kept import marked, parts_of
from btlang.frontends.btcpp.origin import XmlOrigin
from btlang.frontends.btcpp.spelling import is_editors
from btlang.frontends.mission.reader import read_mission
from btlang.passes import lower_mission
from btlang.passes.compilation import sort_by_use
from btlang.printer.exact import is_one_piece
from btlang.printer.mission import mission_lines
from btlang.printer.printer import Printer
from btlang.text.source import NOWHERE, Source
from btlang.tree.ast import Fact, Program, exact_nodes
from btlang.tree.dump import plain
from btlang.tree.node import Node, NodeModel, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon

_LEVELS = ("values", "sure values", "given values", "words", "ids")
"""How natural a mission is, most first: with values and parameters, with those alone that are read in one way only,
with those that it is given, without any, all nodes by their ids."""
_MOST_TRIES = 20
WIDTH = 100
"""Columns; what would be a longer line becomes a block where it can."""


def to_english(
    tree: Tree, vocabulary: Lexicon, *, facts: Sequence[Fact] = (), needs: tuple[tuple[str, str], ...] = ()
) -> str:
    """Write a mission that compiles to an equal tree: natural words if the language has them, else nodes by their
    ids.

    Attributes of editors are left out. It begins with what it `needs` and the `facts`, whose places it may name. Raises
    MissionError (BT142) for a tree that no text can say, such as one with a line end in the name of a subtree.
    """
    tree = remove_editor_attributes(tree)
    names = [name for name, _ in tree.subtrees] + [name for node in tree.walk() for name, _ in node.ports]
    odd = next((name for name in names if not is_one_piece(name)), None)
    if odd is not None:
        raise _unsayable(tree, f"quotes can't hold the name {odd!r}")
    wanted, reason = plain(tree), "it would be read as another tree"
    words = vocabulary.with_places(tuple(fact.name for fact in facts)) if facts else vocabulary
    comments, refused = comments_of(tree), Refused()
    for level in _LEVELS:
        mission, printer = _mission(tree, words, level, refused, comments)
        said = _lines(mission.replace(facts=tuple(facts), needs=needs), printer, comments)
        text = "".join(f"{line}\n" for line in (*said, *_keep_rest(tree)))
        try:
            again = lower_mission(read_mission(Source(text), vocabulary).mission, vocabulary)
        except MissionError as error:
            reason = error.diagnostics[0].message.rstrip(".")
            continue
        if plain(again) == wanted:
            both = _say_both_ways(mission, words)
            if both:
                tested = tuple(NodeModel("Condition", node_id) for node_id in both)
                return to_english(tree.replace(models=(*tree.models, *tested)), vocabulary, facts=facts, needs=needs)
            return text
        refused = Refused(frozenset(_find_differing(tree, again)))
    raise _unsayable(tree, reason)


def _say_both_ways(mission: Program, vocabulary: Lexicon) -> list[str]:
    """Find kinds of leaves that are conditions in one place and done in another: read again, they are conditions in
    all.
    """
    leaves = [node for node in exact_nodes(mission) if not node.items and node.id not in vocabulary.nodes]
    done = {node.id for node in leaves if not node.is_condition}
    return sorted({node.id for node in leaves if node.is_condition} & done)


def _unsayable(tree: Tree, reason: str) -> MissionError:
    return MissionError([diagnostic("BT142", tree.root.span or NOWHERE, reason=reason)])


def _find_differing(tree: Tree, again: Tree) -> Iterator[str]:
    """Yield the subtrees that were read as others, or not at all."""
    bodies = dict(again.subtrees)
    for name, root in tree.subtrees:
        if name not in bodies or plain(Tree(root)) != plain(Tree(bodies[name])):
            yield name


def _lines(mission: Program, printer: Printer, comments: Comments) -> Iterator[str]:
    yield from (f"# {line}" for line in comments.head)
    yield from mission_lines(mission, printer, WIDTH)
    yield from (f"# {line}" for line in comments.foot)


def _keep_rest(tree: Tree) -> Iterator[str]:
    """Return comments with what English doesn't say of an XML file."""
    if isinstance(tree.origin, XmlOrigin):
        markers = Markers()
        yield from marked(line for part in parts_of(tree.origin) for line in markers.part(part, 0))


def _mission(
    tree: Tree, vocabulary: Lexicon, level: str, refused: Refused, comments: Comments
) -> tuple[Program, Printer]:
    """Write the mission. What is refused, and whatever else turns out not to be read back, is said in another way."""
    values = level in ("values", "sure values")
    for _ in range(_MOST_TRIES if values else 1):
        known = SpokenNames(
            tree, vocabulary, refused, values=values, given="values" in level, sure=level == "sure values"
        )
        raiser = Lifter(tree, vocabulary, known, comments, natural=level != "ids")
        bodies = {loop.name for loop in known.loops.values()}
        named = [(name, root) for name, root in sort_by_use(tree)[:-1] if name not in bodies]
        definitions = tuple(raiser.definition(name, root) for name, root in named)
        mission = Program(raiser.main(tree.root), definitions, NOWHERE, name=tree.name)
        before, refused = refused, known.find_refused(mission, refused, raiser.refused)
        if refused == before:
            break
    return mission.replace(given=find_given_keys(mission)), raiser.printer


def remove_editor_attributes(tree: Tree) -> Tree:
    """Return the tree without attributes of editors, such as `_uid`; the same one if it has none."""
    if not any(is_editors(name) for node in tree.walk() for name, _ in node.ports):
        return tree
    subtrees = tuple((name, _without(root)) for name, root in tree.subtrees)
    bare: Tree = tree.replace(root=_without(tree.root), subtrees=subtrees)
    return bare


def _without(root: Node) -> Node:
    def bare(node: Node, children: list[Node]) -> Node:
        ports = tuple(port for port in node.ports if not is_editors(port[0]))
        made: Node = node.replace(children=tuple(children), ports=ports)
        return made

    return fold(root, lambda node: node.children, bare)
