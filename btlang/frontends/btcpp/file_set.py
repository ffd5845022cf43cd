"""Several XML files whose trees may use each other: their models count for all of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.frontends.btcpp.file import TreeHead, XmlFile
from btlang.frontends.btcpp.models import subtree_defaults
from btlang.frontends.btcpp.scan import scanned
from btlang.record import Record
from btlang.text.source import Source, Span
from btlang.tree.catalogue import SUBTREE
from btlang.tree.model import NodeModel
from btlang.tree.node import Node, Tree


class FileSet(Record):
    """The files with their trees, and the models of all of them: those of the first file that has one.

    `kinds` are those that models and tags tell, by the id of a node; `warnings` are of what has no effect.
    """

    files: tuple[XmlFile, ...]
    models: tuple[NodeModel, ...]
    kinds: dict[str, str]
    warnings: tuple[Diagnostic, ...] = ()

    def nodes(self) -> Iterator[Node]:
        """Every node of every tree."""
        for file in self.files:
            for _, root in file.trees:
                yield from Tree(root).walk()

    def place(self, node_id: str) -> Span | None:
        """The first tag that names a kind of node."""
        for file in self.files:
            document = file.document
            for at, (tag, *_) in enumerate(document.elements):
                if node_id in (tag, document.attributes(at).get("ID")):
                    return document.span(at)
        return None


def read_files(sources: Iterable[Source]) -> FileSet:
    """Reads these files and none that they include; one may have only models. Raises MissionError (BT120 to BT129)."""
    files: list[XmlFile] = []
    problems: list[Diagnostic] = []
    for source in sources:
        try:
            file = XmlFile(scanned(source))
        except MissionError as error:
            problems += error.diagnostics
            continue
        files.append(file)
        problems += file.problems
        file.problems.clear()
        problems += _repeated(file)
    if problems:
        raise MissionError(problems)
    names = {head.written or head.name: head.name for file in files for head in file.heads}
    models = {model.id: model for file in reversed(files) for model in file.models.values()}
    kinds = {id: model.kind for id, model in models.items() if model.kind != SUBTREE}
    for file in files:
        file.read_trees(names, kinds, subtree_defaults(models.values()))
        problems += file.problems
    if problems:
        raise MissionError(problems)
    warnings = tuple(warning for file in files for warning in file.warnings)
    return FileSet(tuple(files), tuple(models.values()), kinds, warnings)


def _repeated(file: XmlFile) -> Iterator[Diagnostic]:
    """BT127 for trees of one file with the same ID; those of several files may be of several robots."""
    first: dict[str, TreeHead] = {}
    for head in file.heads:
        if first.setdefault(head.name, head) is not head:
            yield diagnostic("BT127", head.span, ((first[head.name].span, "the first one"),), name=head.name)
