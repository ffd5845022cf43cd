"""An XML file of BehaviorTree.CPP, with the files that it includes, to a tree."""

from __future__ import annotations

import os
from collections.abc import Collection

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.btcpp.file import TreeHead, XmlFile
from btlang.frontends.btcpp.files import XmlFiles, repeated
from btlang.frontends.btcpp.kept import digest_of
from btlang.frontends.btcpp.origin import XmlOrigin
from btlang.frontends.btcpp.spelling import MAIN_TREE
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest
from btlang.tree.node import Node, Tree

MAIN = "main_tree_to_execute"
"""The attribute of <root> with the ID of the main tree."""


def read_xml(source: Source, main: str = "") -> Tree:
    """The tree of an XML text, which runs the tree `main`, by default the one that the file names.

    Its nodes have their names of format 4 whatever the dialect, its `origin` is an XmlOrigin.
    Raises MissionError with all that is wrong (BT040, BT120 to BT129).
    """
    return _Reader(main).read(source)


class _Reader:
    def __init__(self, main: str) -> None:
        self._main = main
        self._read = XmlFiles()

    def read(self, source: Source) -> Tree:
        read = self._read
        read.add(source)
        self._stop_where_wrong()
        file = read.files[0]
        heads = [head for each in read.files for head in each.heads]
        read.problems += repeated(heads) if heads else [empty_file(file)]
        self._stop_where_wrong()
        # the declarations of a file override those of the files that it includes
        read.read_trees(read.models)
        trees = read.trees
        read.problems += read.circle_problems()
        main = self._main_tree(trees, {head.name: head for head in heads})
        self._stop_where_wrong()
        written = {head.name: head.written for head in heads}
        is_usual = main == MAIN_TREE or not written[main]
        subtrees = tuple(tree for tree in trees.items() if tree[0] != main)
        tree = Tree(trees[main], subtrees, "" if is_usual else main, tuple(read.known_models()))
        asked = (written[main] or main) if self._main else ""
        return tree.replace(origin=_origin(file, tree, asked), warnings=tuple(read.warnings))  # type: ignore[no-any-return]

    def _stop_where_wrong(self) -> None:
        if self._read.problems:
            raise MissionError(self._read.problems)

    def _main_tree(self, trees: dict[str, Node], heads: dict[str, TreeHead]) -> str:
        """The name of the main tree; anything if there is no single one."""
        read = self._read
        file = read.files[0]
        asked = self._main or file.attributes.get(MAIN, "")
        name = read.names.get(asked, asked)
        if name in trees:
            return name
        if asked:
            read.problems.append(no_tree(file.root_span, asked, trees))
            return ""
        if len(trees) == 1 or MAIN_TREE in trees:
            return MAIN_TREE if MAIN_TREE in trees else next(iter(trees))
        used = read.used
        tops = [name for name in trees if name not in used] or list(trees)
        own = [name for name in tops if heads[name] in file.heads]
        if len(own) == 1:  # the other files are libraries
            return own[0]
        if len(tops) > 1:
            listed = ", ".join(f"'{name}'" for name in tops)
            places = tuple((heads[name].span, "this may be it") for name in tops[:5])
            read.problems.append(diagnostic("BT125", file.root_span, places, names=listed, first=tops[0]))
        return tops[0]


def empty_file(file: XmlFile) -> Diagnostic:
    """That a file has no tree (BT122)."""
    advice = 'Add one: <BehaviorTree ID="MainTree">'
    if file.models:
        advice = "It only describes nodes. For trees with them: btc check TREE.xml --models FILE.xml"
    arguments = {"problem": "contains no BehaviorTree", "advice": advice}
    return diagnostic("BT122", file.root_span, (), None, what="<root>", **arguments)


def no_tree(span: Span, name: str, trees: Collection[str]) -> Diagnostic:
    """That none of the trees has this name (BT126)."""
    near = nearest(name, trees)
    help = f"Similar: {', '.join(near)}" if near else f"There are: {', '.join(list(trees)[:8])}"
    return diagnostic("BT126", span, name=name, help=help)


def _origin(file: XmlFile, tree: Tree, asked: str) -> XmlOrigin:
    """What the main file holds beside the tree; `asked` is the ID of the main tree where the caller chose it."""
    attributes, source = dict(file.attributes), file.document.source
    if asked:
        attributes[MAIN] = asked
    return XmlOrigin(
        file.dialect,
        tree.root,
        tree.subtrees,
        tuple(attributes.items()),
        file.items(),
        file.origins,
        file.head(),
        file.foot(),
        os.path.basename(source.name) if source.name not in ("-", "<text>") else "",
        digest_of(source.text),
    )
