"""The files of a project with their trees, and the keys that these read and set, as pages need them."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.engine.instance import blackboard_key
from btlang.engine.script.tokens import READS, SETS, find_name_uses
from btlang.frontends.btcpp.file import XmlFile
from btlang.frontends.btcpp.files import read_files
from btlang.frontends.btcpp.models import nav2_models
from btlang.frontends.btcpp.origin import XmlOrigin
from btlang.frontends.btcpp.reader import MAIN
from btlang.frontends.btcpp.spelling import MAIN_TREE
from btlang.frontends.table import frontend_of
from btlang.projects.files import begins_as_tree, empty_folder_error, find_files_below, find_named_files
from btlang.support.record import Record
from btlang.support.test_files import is_test_file
from btlang.text.source import Source
from btlang.tree.catalogue import CATALOGUE, KEY, SCRIPT, SUBTREE, port_content
from btlang.tree.node import Node, NodeModel, Tree
from btlang.tree.visit import subtree_names
from btlang.vocabulary.lexicon import Lexicon


class KeyReader:
    """A reader of keys: it knows the directions of ports by the models of a project and by the words."""

    def __init__(self, models: Mapping[str, NodeModel], vocabulary: Lexicon) -> None:
        self._models, self._vocabulary = models, vocabulary

    def keys(self, root: Node) -> dict[str, set[str]]:
        """Return `READS` and `SETS` by key, in the order of the tree."""
        found: dict[str, set[str]] = {}
        for node in Tree(root).walk():
            for port, text in node.ports:
                for key, uses in self._of_port(node, port, text):
                    found.setdefault(key, set()).update(uses)
        return found

    def _of_port(self, node: Node, port: str, text: str) -> list[tuple[str, set[str]]]:
        holds = port_content(node.id, port)
        if holds == SCRIPT:
            return list(find_name_uses(text).items())
        if holds == KEY:
            return [(text.strip("{} "), {SETS})]
        key = blackboard_key(port, text)
        if key is None or port[:1] == "_":
            return []
        return [(key, {"output": {SETS}, "inout": {READS, SETS}}.get(self._direction(node, port), {READS}))]

    def _direction(self, node: Node, port: str) -> str:
        """Return the direction of a port of a SubTree by the model of its tree."""
        id = node.port("ID") if node.id == SUBTREE else node.id
        kind = CATALOGUE.get(id)
        if kind is not None and port in kind.ports:
            return kind.ports[port].direction
        model = self._models.get(id) or nav2_models([id]).get(id)
        declared = next((each.direction for each in model.ports if each.name == port), "") if model is not None else ""
        if declared:
            return declared
        return "output" if any(port in entry.outputs for entry in self._vocabulary.entries.get(id, ())) else "input"


_ENDINGS = (".xml", ".txt")


class TreeChapter(Record):
    """A tree of a file. `text` is the mission that it was written as, "" for another tree; `runs_first`: its file
    starts with it.
    """

    file: str
    name: str
    tree: Tree
    vocabulary: Lexicon
    text: str = ""
    description: str = ""
    runs_first: bool = False

    @property
    def uses(self) -> list[str]:
        """The IDs of the trees that it uses and that aren't its own, each once."""
        own = dict(self.tree.subtrees)
        names = [name for root in (self.tree.root, *own.values()) for name in subtree_names(root)]
        return [name for name in dict.fromkeys(names) if name not in own]


class DocumentedProject(Record):
    """The names of the files, the chapters in their order, the models by id and by file, and the files left out."""

    files: tuple[str, ...]
    chapters: tuple[TreeChapter, ...]
    models: Mapping[str, NodeModel]
    described: Mapping[str, tuple[NodeModel, ...]] = {}
    left_out: tuple[str, ...] = ()

    def used(self, name: str, file: str) -> TreeChapter | None:
        """Return the tree that a use in a file means: that of the same file before others."""
        found = [chapter for chapter in self.chapters if chapter.name == name]
        return next((chapter for chapter in found if chapter.file == file), found[0] if found else None)

    def users(self, used: TreeChapter) -> list[TreeChapter]:
        """Return the trees that use one."""
        return [one for one in self.chapters if any(self.used(name, one.file) is used for name in one.uses)]


def read_documents(
    paths: Sequence[str], vocabulary: Lexicon, compiled: Callable[[Source], Mission]
) -> DocumentedProject:
    """Read files, and in folders those that are trees in XML or missions; both are recognized by their content.

    Raises MissionError for a file that is named, or begins as a tree, and can't be read, and where nothing is found.
    """
    base = _common_folder(paths)
    trees: list[tuple[str, Source]] = []
    chapters: list[TreeChapter] = []
    names, left_out = list[str](), list[str]()
    for path in find_named_files(paths, _below):
        name = os.path.relpath(path, base).replace(os.sep, "/") if path != "-" else "-"
        source = read_source(path)
        if frontend_of(source) == "xml":
            if path in paths or begins_as_tree(source):
                trees.append((name, source))
                names.append(name)
            continue
        try:
            chapters.append(_mission(name, source, compiled(source)))
            names.append(name)
        except MissionError:
            if path in paths:
                raise
            left_out.append(name)
    if not names:
        raise empty_folder_error(paths[0], "there are no trees in XML and no missions in it that can be read")
    read = read_files([source for _, source in trees])
    models, described = read.models, dict[str, tuple[NodeModel, ...]]()
    for (name, _), file in zip(trees, read.files, strict=True):
        chapters += _trees(name, file, models.values(), vocabulary)
        described[name] = tuple(file.models.values())
    chapters.sort(key=lambda chapter: names.index(chapter.file))
    return DocumentedProject(tuple(names), tuple(chapters), models, described, tuple(left_out))


def _below(folder: str) -> Iterator[str]:
    return (file for file in find_files_below(folder, _ENDINGS) if not is_test_file(file))


def _common_folder(paths: Sequence[str]) -> str:
    folders = [path if os.path.isdir(path) else os.path.dirname(path) for path in paths if path != "-"]
    return os.path.commonpath([os.path.abspath(folder or os.curdir) for folder in folders] or [os.curdir])


def _mission(name: str, source: Source, mission: Mission) -> TreeChapter:
    tree = mission.tree
    title = tree.name or os.path.splitext(os.path.basename(name))[0]
    text = source.text if mission.syntax is not None else ""
    return TreeChapter(name, title, tree, mission.vocabulary, text, runs_first=True)


def _trees(name: str, file: XmlFile, models: Collection[NodeModel], vocabulary: Lexicon) -> Iterator[TreeChapter]:
    described = {model.id: model.text for model in models if model.kind == SUBTREE}
    first = file.attributes.get(MAIN, MAIN_TREE)
    for head, (tree_name, root) in zip(file.heads, file.trees, strict=True):
        origin = file.origins[tree_name]
        kept = XmlOrigin(file.dialect, root, (), (), (tree_name,), {tree_name: origin})
        about = dict(origin.attributes).get("_description", "") or described.get(head.written, "")
        is_first = len(file.heads) == 1 or first in (head.written, tree_name)
        tree = Tree(root, models=tuple(models), origin=kept)
        yield TreeChapter(name, head.id, tree, vocabulary, "", about, is_first)


def nodes_of(tree: Tree) -> dict[str, list[Node]]:
    """Return the nodes of a tree and its own subtrees, by id."""
    found: dict[str, list[Node]] = {}
    for node in tree.walk():
        found.setdefault(node.id, []).append(node)
    return found
