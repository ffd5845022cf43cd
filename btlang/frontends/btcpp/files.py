"""XML files whose trees may use each other, perhaps with the files that they include; their models count for all."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.diagnostics.files import MOST_DEEP, TOO_DEEP, included_path, read_included, real_path
from btlang.frontends.btcpp.file import TreeHead, XmlFile
from btlang.frontends.btcpp.models import MODEL_KINDS, nav2_models, subtree_defaults
from btlang.frontends.btcpp.packages import package_of, package_root
from btlang.frontends.btcpp.scan import Document, scanned
from btlang.frontends.btcpp.scopes import Scopes
from btlang.frontends.btcpp.spelling import MODEL, TO_4
from btlang.text.source import Source, Span
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, NodeModel, Tree
from btlang.tree.visit import in_order_of_use

_NO_NODES = CATALOGUE.keys() | TO_4.keys() | {"root", "BehaviorTree", MODEL, *MODEL_KINDS}
"""Tags that are no ids of nodes that somebody made."""
_ID = re.compile(r"""\bID\s*=\s*["']([^"'<>\n]+)["']""")
_ROS_FOLDERS = "AMENT_PREFIX_PATH"  # where ROS 2 has its packages


NOT_INCLUDED = "BT128"


class XmlFiles:
    """The files that were added, each before those that it includes; what is wrong with them, and what is only odd.

    A file that is included and is one of `sources` isn't read again. Unless it `follows_includes`, none is read.
    `dialect` is that of files that could be of either version.
    """

    def __init__(self, sources: Iterable[Source] = (), *, follows_includes: bool = True, dialect: int = 3) -> None:
        self._sources = {real_path(source.name): source for source in sources}
        self.files: list[XmlFile] = []
        self.problems: list[Diagnostic] = []
        self.warnings: list[Diagnostic] = []
        self._read: set[str] = set()
        self._includes: dict[str, list[str]] = {}  # by real path, that of each file, too
        self._kinds: dict[str, str] = {}  # of nodes, as models and tags declare them
        self._follows_includes = follows_includes
        self._dialect = dialect
        self.tree_models: dict[str, NodeModel] = {}
        """Of each tree that has a model, by its name; once the trees are read."""
        self._unread: set[str] = set()  # IDs in files that are no XML

    def add(self, source: Source) -> None:
        """Reads a file and what it includes, unless that is done."""
        real = real_path(source.name)
        if real not in self._read:
            self._read_file(source, (real,), self._dialect)

    @property
    def models(self) -> dict[str, NodeModel]:
        """The models by the id of a node, those of the first file that has one."""
        return {node_id: model for file in reversed(self.files) for node_id, model in file.models.items()}

    @property
    def scopes(self) -> Scopes:
        """What belongs together, once all files are added."""
        return Scopes(self._includes)

    @property
    def names(self) -> dict[str, str]:
        """The names of the trees that can be read, by the ID that other files call them; the first counts."""
        return {head.id: head.name for file in reversed(self.files) for head in reversed(file.heads)}

    @property
    def trees(self) -> dict[str, Node]:
        """The trees by name, once they are read."""
        return {name: root for file in self.files for name, root in file.trees}

    @property
    def unread(self) -> frozenset[str]:
        """The names of trees that can't be read, and the IDs in files that are no XML, which may define them."""
        names = (head.name for file in self.files for head in file.heads if not head.is_sound)
        return frozenset((*self._unread, *names))

    @property
    def used(self) -> set[str]:
        """The names of the trees that others use."""
        return {node.port("ID") for file in self.files for nodes in file.uses.values() for node in nodes}

    def read_trees(
        self,
        models: Mapping[str, NodeModel],
        own_names: Callable[[XmlFile], Mapping[str, str]] = lambda file: file.names,
        own_models: Callable[[XmlFile], Mapping[str, NodeModel]] = lambda _: {},
    ) -> None:
        """Reads the trees of all files; in each, an ID means the file's own trees and models before others."""
        kinds = self._kinds = {node_id: model.kind for node_id, model in models.items() if model.kind != SUBTREE}
        names = self.names
        self.tree_models = self._tree_models(models, own_names)
        defaults = subtree_defaults(self.tree_models)
        for file in self.files:
            meant = {**names, **own_names(file)}
            own = {meant.get(each.id, each.id): each for each in own_models(file).values() if each.kind == SUBTREE}
            file.read_trees(meant, kinds, {**defaults, **subtree_defaults(own)} if own else defaults)
            self.problems += file.problems

    def _tree_models(
        self, models: Mapping[str, NodeModel], own_names: Callable[[XmlFile], Mapping[str, str]]
    ) -> dict[str, NodeModel]:
        """The model of each tree that has one, by its name: a model is about the tree that its file means by the ID."""
        names, first, found = self.names, self.models, dict[str, NodeModel]()
        for file in self.files:
            for node_id, model in file.models.items():
                if model.kind == SUBTREE and models.get(node_id) is first[node_id]:
                    found.setdefault(own_names(file).get(node_id) or names.get(node_id, node_id), model)
        others = {node_id: model for node_id, model in models.items() if model is not first.get(node_id)}
        found.update((names.get(node_id, node_id), model) for node_id, model in others.items() if model.kind == SUBTREE)
        return found

    def known_models(self) -> list[NodeModel]:
        """The models of the files, then kinds that tags declare, then what is known of the Nav2 nodes that are used;
        once the trees are read.
        """
        known = self.models
        for node_id, kind in self._kinds.items():
            known.setdefault(node_id, NodeModel(kind, node_id))
        tags = {element[0] for file in self.files for element in file.document.elements}
        bare = {node_id for node_id, model in known.items() if not model.ports}
        strange = sorted((tags - _NO_NODES - self.trees.keys() - known.keys()) | bare)
        if strange:
            for node_id, model in nav2_models(strange).items():
                if node_id not in known or known[node_id].kind == model.kind:
                    known[node_id] = model
        return list(known.values())

    def nodes(self) -> Iterator[Node]:
        """Every node of every tree."""
        for root in (root for file in self.files for _, root in file.trees):
            yield from Tree(root).walk()

    def places(self) -> dict[str, Span]:
        """The first tag that names each kind of node."""
        found: dict[str, tuple[Document, int]] = {}
        for document in (file.document for file in self.files):
            for at, (tag, *_) in enumerate(document.elements):
                for node_id in (tag, document.attributes(at).get("ID", "")):
                    found.setdefault(node_id, (document, at))
        return {node_id: document.span(at) for node_id, (document, at) in found.items()}

    def circles(self) -> list[list[str]]:
        """The names of trees that contain each other, each circle once."""
        heads = {head.name: head for file in self.files for head in file.heads}
        uses = {
            name: [used for node in nodes if (used := node.port("ID")) in heads]
            for file in self.files for name, nodes in file.uses.items()
        }  # fmt: skip
        return in_order_of_use(uses)[1]

    def circle_problems(self) -> list[Diagnostic]:
        """BT124 for each circle, at the first of its trees."""
        spans = {head.name: head.span for file in self.files for head in file.heads}
        found = [(circle[0], " contains ".join(f"'{name}'" for name in (*circle, circle[0])))
                 for circle in self.circles()]  # fmt: skip
        return [diagnostic("BT124", spans[name], name=name, circle=circle) for name, circle in found]

    def _read_file(self, source: Source, within: tuple[str, ...], dialect: int) -> None:
        """Reads a file and what it includes; `within` are the files around it, its own last, `dialect` is theirs."""
        self._read.add(within[-1])
        try:
            file = XmlFile(scanned(source), dialect, within[-1])
        except MissionError as error:
            self.problems += error.diagnostics
            self._unread.update(_ID.findall(source.text))
            return
        self.problems += file.problems
        self.warnings += file.warnings
        file.problems.clear()
        file.problems.clear()
        self.files.append(file)
        self._includes[file.path] = []
        for attributes, span in file.includes if self._follows_includes else ():
            if "path" not in attributes:
                self.problems.append(diagnostic("BT123", span, tag="include", attribute="path", advice=""))
                continue
            self._include(attributes, span, within, file.dialect)

    def _include(self, attributes: dict[str, str], span: Span, within: tuple[str, ...], dialect: int) -> None:
        path, source = attributes["path"], span.source
        package = attributes.get("ros_pkg")
        own = _in_own_package(path, package or "", source)
        if own:
            path, package = own, None
        _, real = included_path(path, source)
        if (package or real not in self._sources) and (beside := self._in_sources(path, package or "")):
            real = beside
        elif package is not None and source.roots:
            folder = _package_folder(package)
            if folder is None:
                self._not_included(span, path=path, reason=_no_package(package))
                return
            # an installed package may be included from anywhere
            source = Source("", folder=folder, hides_includes=source.hides_includes)
            _, real = included_path(path, source)
        self._includes[within[-1]].append(real)
        if real in within:
            circle = " -> ".join(map(os.path.basename, (*within[within.index(real) :], real)))
            self._not_included(span, path=path, reason=f"it includes itself: {circle}")
        elif len(within) >= MOST_DEEP:
            self._not_included(span, path=path, reason=TOO_DEEP)
        elif real in self._read:
            pass
        elif real in self._sources:
            self._read_file(self._sources[real], (*within, real), dialect)
        else:
            try:
                included = read_included(path, source)
            except MissionError as error:
                [problem] = error.diagnostics
                if problem.code != "BT001":
                    self.problems.append(problem)
                    return
                self._not_included(span, path=path, reason=dict(problem.arguments)["reason"])
                return
            self._read_file(included, (*within, real), dialect)

    def _in_sources(self, path: str, package: str) -> str:
        """The one source that is installed at a path, in the folder of its package; "" if that isn't certain.

        An installed file is included as `install/PACKAGE/share/PACKAGE/trees/dock.xml`, or by the path in its package.
        """
        package, folders = _split_installed(path, package)
        if not package:
            return ""
        paths = {real: real.split(os.sep) for real in self._sources}
        ends_so = (real for real, parts in paths.items() if parts[-len(folders) :] == folders)
        found = [real for real in ends_so if package in paths[real] or package_of(os.path.dirname(real)) == package]
        return found[0] if len(found) == 1 else ""

    def _not_included(self, span: Span, *, path: str, reason: str) -> None:
        self.problems.append(diagnostic(NOT_INCLUDED, span, path=path, reason=reason))


def _split_installed(path: str, package: str) -> tuple[str, list[str]]:
    """Return the package that installs a path, "" for none, and the folders and the file in it."""
    folders = path.replace("\\", "/").split("/")
    if not package and "share" in folders[:-2]:
        share = len(folders) - 1 - folders[::-1].index("share")
        return folders[share + 1], folders[share + 2 :]
    return package, folders


def _in_own_package(path: str, package: str, source: Source) -> str:
    """Return the relative path of what the package of a source installs, in the folder of that package, or ""."""
    package, folders = _split_installed(path, package)
    _, real = included_path(".", source)
    root = package_root(real) if package and ".." not in folders else ""
    own = os.path.join(root, *folders)
    if not root or package_of(root) != package or not os.path.isfile(own):
        return ""
    return os.path.relpath(own, real)


def read_files(sources: Sequence[Source], *, follows_includes: bool = False) -> XmlFiles:
    """These files with their trees, and with those that they include and that can be read if that is asked for.

    A file may have only models. Raises MissionError (BT120 to BT129), where a file has an ID twice, too: those of
    several files may be of several robots.
    """
    read = XmlFiles(sources, follows_includes=follows_includes)
    for source in sources:
        read.add(source)
    read.problems = [problem for problem in read.problems if problem.code != NOT_INCLUDED]
    read.problems += [problem for file in read.files for problem in repeated(file.heads)]
    if not read.problems:
        read.read_trees(read.models)
    if read.problems:
        raise MissionError(read.problems)
    return read


def repeated(heads: Iterable[TreeHead]) -> Iterator[Diagnostic]:
    """BT127 for trees whose name another one has."""
    found: dict[str, TreeHead] = {}
    for head in heads:
        if found.setdefault(head.name, head) is not head:
            yield same_id(head, found[head.name])


def same_id(head: TreeHead, first: TreeHead) -> Diagnostic:
    """BT127: a tree has the ID of an earlier one."""
    return diagnostic("BT127", head.span, ((first.span, "the first one"),), name=head.id)


def _package_folder(package: str) -> str | None:
    """The folder of a ROS 2 package, None where it is not installed."""
    for prefix in os.environ.get(_ROS_FOLDERS, "").split(os.pathsep):
        found = os.path.join(prefix, "share", package)
        if prefix and os.path.isdir(found) and package == os.path.basename(package) and package.strip("."):
            return found
    return None


def _no_package(package: str) -> str:
    where = "not in any folder of" if os.environ.get(_ROS_FOLDERS) else "because there is no"
    return f"the ROS package {package} is not found, {where} {_ROS_FOLDERS}"
