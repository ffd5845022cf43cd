"""An XML file of BehaviorTree.CPP, with the files that it includes, to a tree."""

from __future__ import annotations

import os
from collections.abc import Collection, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.frontends.btcpp.file import TreeHead, XmlFile
from btlang.frontends.btcpp.files import XmlFiles
from btlang.frontends.btcpp.kept import digest_of
from btlang.frontends.btcpp.models import MODEL_KINDS, nav2_models, subtree_defaults
from btlang.frontends.btcpp.origin import XmlOrigin
from btlang.frontends.btcpp.spelling import MAIN_TREE, MODEL, TO_4
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.model import NodeModel
from btlang.tree.node import Node, Tree
from btlang.tree.visit import in_order_of_use

_NO_NODES = CATALOGUE.keys() | TO_4.keys() | {"root", "BehaviorTree", MODEL, *MODEL_KINDS}
"""Tags that are no ids of nodes that somebody made."""
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
        self._problems: list[Diagnostic] = []
        self._files: list[XmlFile] = []

    def read(self, source: Source) -> Tree:
        found = XmlFiles()
        found.add(source)
        self._problems, self._files = found.problems, found.files
        self._stop_where_wrong()
        file = self._files[0]
        heads = self._distinct()
        names = {head.written or head.name: name for name, head in heads.items()}
        # what a file tells counts for more than what those tell that it includes
        models = {node_id: model for each in self._files[::-1] for node_id, model in each.models.items()}
        kinds = {node_id: model.kind for node_id, model in models.items() if model.kind != SUBTREE}
        defaults = subtree_defaults(models.values())
        self._stop_where_wrong()
        for each in self._files:
            each.read_trees(names, kinds, defaults)
            self._problems += each.problems
        trees = dict(tree for each in self._files for tree in each.trees)
        self._check_uses(trees, heads)
        main = self._main_tree(trees, heads, names)
        self._stop_where_wrong()
        is_usual = main == MAIN_TREE or not heads[main].written
        subtrees = tuple(tree for tree in trees.items() if tree[0] != main)
        tree = Tree(trees[main], subtrees, "" if is_usual else main, tuple(_known(models, kinds, trees, self._files)))
        asked = (heads[main].written or main) if self._main else ""
        return tree.replace(origin=_origin(file, tree, asked), warnings=tuple(found.warnings))  # type: ignore[no-any-return]

    def _stop_where_wrong(self) -> None:
        if self._problems:
            raise MissionError(self._problems)

    def _distinct(self) -> dict[str, TreeHead]:
        """The trees by name; a name that stands twice is wrong."""
        heads: dict[str, TreeHead] = {}
        for file in self._files:
            for head in file.heads:
                first = heads.setdefault(head.name, head)
                if first is not head:
                    note = ((first.span, "the first one"),)
                    self._problems.append(diagnostic("BT127", head.span, note, name=head.name))
        if not heads:
            self._problems.append(empty_file(self._files[0]))
        return heads

    def _main_tree(self, trees: dict[str, Node], heads: dict[str, TreeHead], names: dict[str, str]) -> str:
        """The name of the main tree; anything where none can be told."""
        file = self._files[0]
        asked = self._main or file.attributes.get(MAIN, "")
        name = names.get(asked, asked)
        if name in trees:
            return name
        if asked:
            self._problems.append(no_tree(file.root_span, asked, trees))
            return ""
        if len(trees) == 1 or MAIN_TREE in trees:
            return MAIN_TREE if MAIN_TREE in trees else next(iter(trees))
        used = {node.port("ID") for each in self._files for nodes in each.uses.values() for node in nodes}
        tops = [name for name in trees if name not in used] or list(trees)
        if len(tops) > 1:
            listed = ", ".join(f"'{name}'" for name in tops)
            places = tuple((heads[name].span, "this may be it") for name in tops[:5])
            self._problems.append(diagnostic("BT125", file.root_span, places, names=listed, first=tops[0]))
        return tops[0]

    def _check_uses(self, trees: dict[str, Node], heads: dict[str, TreeHead]) -> None:
        """None may contain itself. One that is not there may stand in another file, as Nav2's do."""
        named = {name: nodes for each in self._files for name, nodes in each.uses.items()}
        uses = {name: [used for node in nodes if (used := node.port("ID")) in trees] for name, nodes in named.items()}
        for circle in in_order_of_use(uses)[1]:
            told = " contains ".join(f"'{name}'" for name in (*circle, circle[0]))
            self._problems.append(diagnostic("BT124", heads[circle[0]].span, name=circle[0], circle=told))


def empty_file(file: XmlFile) -> Diagnostic:
    """That a file has no tree (BT122)."""
    advice = 'Add one: <BehaviorTree ID="MainTree">'
    if file.models:
        advice = "It only describes nodes. For trees with them: btc check TREE.xml --models FILE.xml"
    told = {"problem": "contains no BehaviorTree", "advice": advice}
    return diagnostic("BT122", file.root_span, (), None, what="<root>", **told)


def no_tree(span: Span, name: str, trees: Collection[str]) -> Diagnostic:
    """That none of the trees has this name (BT126)."""
    near = nearest(name, trees)
    told = f"Similar: {', '.join(near)}" if near else f"There are: {', '.join(list(trees)[:8])}"
    return diagnostic("BT126", span, name=name, help=told)


def _known(
    models: dict[str, NodeModel], kinds: dict[str, str], trees: dict[str, Node], files: Sequence[XmlFile]
) -> list[NodeModel]:
    """The models of the files, then kinds that tags tell, then what is known of Nav2's nodes that are used."""
    told = dict(models)
    for node_id, kind in kinds.items():
        told.setdefault(node_id, NodeModel(kind, node_id))
    tags = {element[0] for file in files for element in file.document.elements}
    bare = {node_id for node_id, model in told.items() if not model.ports}
    strange = sorted((tags - _NO_NODES - trees.keys() - told.keys()) | bare)
    if strange:
        for node_id, model in nav2_models(strange).items():
            if node_id not in told or told[node_id].kind == model.kind:
                told[node_id] = model
    return list(told.values())


def _origin(file: XmlFile, tree: Tree, asked: str) -> XmlOrigin:
    """What the main file tells beside the tree; `asked` is the ID of the main tree where the caller chose it."""
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
