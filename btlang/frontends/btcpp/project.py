"""Several XML files as one project: their trees may use each other, and their models count for all of them."""

from __future__ import annotations

import operator
import os
from collections.abc import Collection, Iterable, Iterator, Mapping
from functools import cache

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.files import real_path
from btlang.frontends.btcpp.file import TreeHead, XmlFile
from btlang.frontends.btcpp.files import XmlFiles, same_id
from btlang.frontends.btcpp.packages import are_related, roots_of
from btlang.frontends.btcpp.reader import MAIN, empty_file, no_tree
from btlang.frontends.btcpp.scopes import Scopes
from btlang.frontends.btcpp.spelling import MAIN_TREE
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, NodeModel
from btlang.tree.visit import fold

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    Defined = TypeVar("Defined")


class XmlProject(Record):
    """The trees by name, their heads, the names of those that files start with, and the models by the id of a node.

    Where files describe a node differently, `models` has the first model, `own_models` by the name of a file the ones
    that are nearest to it, and `described` all of them, each with its place. `tree_models` are those of trees by name.
    `dialects` is that of each file. `unread` are names of trees and IDs of nodes that are, or may be, in what can't be
    read. `problems` are errors and warnings of reading; `circular` are the names of trees that contain themselves;
    `scopes` say what files, by their real paths, belong together.
    """

    trees: dict[str, Node]
    heads: dict[str, TreeHead]
    mains: frozenset[str]
    models: dict[str, NodeModel]
    own_models: dict[str, Mapping[str, NodeModel]]
    described: dict[str, list[tuple[NodeModel, Span]]]
    tree_models: dict[str, NodeModel]
    dialects: dict[str, int]
    unread: frozenset[str]
    problems: tuple[Diagnostic, ...]
    circular: frozenset[str]
    scopes: Scopes

    def model(self, node: Node) -> NodeModel | None:
        """The model of a node that counts where the node is."""
        if node.id == SUBTREE:
            return self.tree_models.get(node.port("ID"))
        own = self.own_models.get(node.span.source.name, {}) if node.span is not None else {}
        return own.get(node.id) or self.models.get(node.id)

    def certain_trees(self) -> dict[str, Node]:
        """The trees, in which a SubTree node names none that only has the ID: that of a package on which its own does
        not depend, which may be another one when the program runs.
        """
        files = {name: real_path(head.span.source.name) for name, head in self.heads.items()}
        roots = roots_of(files.values())

        @cache
        def is_certain(own: str, used: str) -> bool:
            return not self.scopes.are_apart(own, used) or are_related(own, used, roots)

        def named(node: Node) -> Node:
            used = files.get(node.port("ID")) if node.id == SUBTREE else None
            if used is None or node.span is None or is_certain(real_path(node.span.source.name), used):
                return node
            ports = tuple((name, text) for name, text in node.ports if name != "ID")
            return node.replace(ports=ports)  # type: ignore[no-any-return]

        def joined(node: Node, inner: list[Node]) -> Node:
            own = named(node)
            is_same = all(map(operator.is_, node.children, inner))
            return own if is_same else own.replace(children=tuple(inner))

        return {name: fold(root, _children, joined) for name, root in self.trees.items()}

    def is_joined(self, file: str) -> bool:
        """Whether a file includes another one, or is included."""
        return self.scopes.is_joined(real_path(file))

    def may_share(self, file: str, other: str) -> bool:
        """Whether the models of the other file may be meant in a file that includes others, or is included: it is in
        the same program, or has models alone.
        """
        path, place = real_path(file), real_path(other)
        is_apart = self.scopes.is_joined(path) and self.scopes.are_apart(path, place)
        return not is_apart or all(head.span.source.name != other for head in self.heads.values())


def read_project(read: XmlFiles, palettes: XmlFiles, main: str = "") -> XmlProject:
    """The project of these files; of `palettes` only the models count, before those of the files.

    A file may use the trees and models of all others, the nearest first. A tree with the ID of another one is reported
    (BT127) where a program has both, or where nothing decides which of them a file means. `main` is the ID of a tree
    that must be there.
    """
    files = read.files
    heads = _named(files)
    unread = read.unread
    models = {**read.models, **palettes.models}
    nearest = _Nearest(read, files, palettes.models)
    read.read_trees(models, nearest.names, nearest.models)
    trees = read.trees
    problems = [*read.problems, *_once(read.warnings), *palettes.problems, *read.circle_problems()]
    wrong = {problem.span.source for problem in read.problems}
    empty = (file for file in files if not (file.heads or file.describes_nodes or file.includes))
    problems += [empty_file(file) for file in empty if file.document.source not in wrong]
    mains = {file.path: own for file in files if (own := _main_of(file, read.names | nearest.names(file))) in trees}
    for name, first in nearest.repeated(mains, read.used).items():
        problems.append(same_id(heads[name], heads[first]))
    known = dict.fromkeys((*read.names, *trees, *unread))  # no set: they are listed
    for file in files:
        asked = main or file.attributes.get(MAIN, "")
        if asked and asked not in known:
            problems.append(no_tree(file.root_span, asked, known))
    described: dict[str, list[tuple[NodeModel, Span]]] = {}
    for file in (*palettes.files, *read.files):
        for node_id, model in file.models.items():
            described.setdefault(node_id, []).append((model, file.model_span(node_id)))
    return XmlProject(
        trees,
        heads,
        frozenset(mains.values()) | _starts(files, read),
        models,
        {file.document.source.name: nearest.models(file) for file in files},
        described,
        read.tree_models,
        {file.document.source.name: file.dialect for file in read.files},
        unread,
        tuple(problems),
        frozenset(name for circle in read.circles() for name in circle),
        read.scopes,
    )


class _Nearest:
    """What each of the files means by an ID that several files define."""

    def __init__(self, read: XmlFiles, files: list[XmlFile], palette: Mapping[str, NodeModel]) -> None:
        self._scopes: Scopes = read.scopes
        self._files = {file.path: file for file in files}
        self._trees = _defined({file.path: file.names for file in files})
        described = {file.path: file.models for file in read.files}
        self._described = {
            node_id: by_file
            for node_id, by_file in _defined(described).items()
            if node_id not in palette and any(model != next(iter(by_file.values())) for model in by_file.values())
        }
        self._nearest: dict[tuple[str, str, bool], list[str]] = {}
        self._names: dict[str, dict[str, str]] = {}
        self._models: dict[str, dict[str, NodeModel]] = {}

    def names(self, file: XmlFile) -> dict[str, str]:
        """The names of the trees by such IDs, and of its own ones."""
        if file.path not in self._names:
            self._names[file.path] = {**self._near(file, self._trees, file.names), **file.names}
        return self._names[file.path]

    def models(self, file: XmlFile) -> Mapping[str, NodeModel]:
        """The models of nodes that files describe differently, by id."""
        if file.path not in self._models:
            own = {node_id: model for node_id, model in file.models.items() if node_id in self._described}
            self._models[file.path] = {**self._near(file, self._described, own), **own}
        return self._models[file.path]

    def _near(
        self, file: XmlFile, defined: Mapping[str, dict[str, Defined]], own: Collection[str]
    ) -> dict[str, Defined]:
        """What the nearest file says of each ID that is named in a file and isn't its own."""
        left = defined.keys() - own
        if not left:
            return {}
        named = {file.attributes.get(MAIN, "")}
        for tag, flat, *_ in file.document.elements:
            named.add(tag)
            named.update(flat[1::2] if "ID" in flat else ())
        return {each: defined[each][self._files_near(file, each, defined)[0]] for each in left & named}

    def _files_near(self, file: XmlFile, each: str, defined: Mapping[str, dict[str, Defined]]) -> list[str]:
        """The files nearest to one that define an ID; for files that no include joins, only the folder decides."""
        place = file.path if self._scopes.is_joined(file.path) else os.path.dirname(file.path)
        key = place, each, defined is self._trees
        if key not in self._nearest:
            self._nearest[key] = self._scopes.nearest(file.path, defined[each])
        return self._nearest[key]

    def repeated(self, mains: Mapping[str, str], used: set[str]) -> dict[str, str]:
        """The names of trees that can be confused with an earlier one, each with the name of that.

        Main trees of one program can't, unless they are used: they are run one by one.
        """
        found: dict[str, str] = {}
        starts = set(mains.values())
        for file in self._files.values():
            own: dict[str, str] = {}
            for head in file.heads:
                first = own.setdefault(head.id, head.name)
                if first != head.name:
                    found[head.name] = first
        for program in self._scopes.programs:
            firsts: dict[str, str] = {}
            for path in (path for path in self._files if path in program):
                for tree_id, name in self._files[path].names.items():
                    first = firsts.setdefault(tree_id, name)
                    apart = {name, first} <= starts and used.isdisjoint((name, first))
                    if first != name and not apart:
                        found.setdefault(name, first)
        for file in self._files.values():
            for tree_id in self._foreign(file):
                by_file = self._trees[tree_id]
                first, *others = self._files_near(file, tree_id, self._trees)
                for path in others:
                    # which of several folders is installed isn't known here, and variants of a program run one by one
                    is_variant = len(self._files[path].names.keys() & self._files[first].names.keys()) > 1
                    if os.path.dirname(path) == os.path.dirname(first) and not is_variant:
                        found.setdefault(by_file[path], by_file[first])
        return found

    def _foreign(self, file: XmlFile) -> set[str]:
        """The IDs in a file that mean a tree of another file, where several define it."""
        names = {name: tree_id for tree_id, name in self.names(file).items() if tree_id not in file.names}
        used = {node.port("ID") for nodes in file.uses.values() for node in nodes}
        used.add(self.names(file).get(file.attributes.get(MAIN, ""), ""))
        return {names[name] for name in used if name in names}


def _defined(by_file: Mapping[str, Mapping[str, Defined]]) -> dict[str, dict[str, Defined]]:
    """By ID, what each file says of it, where several files do."""
    found: dict[str, dict[str, Defined]] = {}
    for path, defined in by_file.items():
        for each, value in defined.items():
            found.setdefault(each, {})[path] = value
    return {each: values for each, values in found.items() if len(values) > 1}


def _once(warnings: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Each warning about an ID (BT238) where the project has it first: it must be changed in all files at once."""
    seen: set[str] = set()
    for warning in warnings:
        if warning.code == "BT238":
            node_id = dict(warning.arguments)["id"]
            if node_id in seen:
                continue
            seen.add(node_id)
        yield warning


def _named(files: list[XmlFile]) -> dict[str, TreeHead]:
    """The heads of all trees by unique names."""
    heads: dict[str, TreeHead] = {}
    for file in files:
        for at, head in enumerate(file.heads):
            name, number = head.name, 2
            while name in heads:
                name, number = f"{head.name} ({number})", number + 1
            heads[name] = file.heads[at] = head.replace(name=name)
    return heads


def _starts(files: Iterable[XmlFile], read: XmlFiles) -> frozenset[str]:
    """Return the trees that programs begin with although no file says so: those that nothing uses in a file that
    includes others and isn't included itself.
    """
    alone = (file for file in files if MAIN not in file.attributes and read.scopes.is_start(file.path))
    return frozenset(name for file in alone for name in file.names.values() if name not in read.used)


def _main_of(file: XmlFile, names: dict[str, str]) -> str:
    """The name of the tree that a file starts with, "" where it doesn't say."""
    written = file.attributes.get(MAIN, MAIN_TREE)
    return file.names.get(written) or (names.get(written, "") if MAIN in file.attributes else "")


def _children(node: Node) -> tuple[Node, ...]:
    return node.children
