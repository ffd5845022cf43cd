"""Trees in XML for editors: what is wrong with them, their outline, and where the models of their nodes are."""

from __future__ import annotations

import re
from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.editing.references import Reference
from btlang.frontends.btcpp.file import XmlFile
from btlang.frontends.btcpp.files import XmlFiles
from btlang.lsp.documents import Snapshot
from btlang.projects.checking import check_trees
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source, Span
from btlang.tree.catalogue import SUBTREE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_TREE = "BehaviorTree"


def tree_problems(source: Source, snapshot: Snapshot) -> list[Diagnostic]:
    """Return what `btc check` says of a file. Raises MissionError for words that can't be used."""
    words = snapshot.words
    return check_trees([source], world_vocabulary(words.keywords, words.world, words.language))


def analyse_tree(source: Source, _: Snapshot) -> dict[str, Any]:
    """Return the `outline` of a file, and its `references`."""
    files = XmlFiles()
    files.add(source)
    file = next((each for each in files.files if each.document.source is source), None)
    if file is None:  # it is no XML
        return {}
    return {"outline": list(_outline(file)), "references": list(_references(file, files))}


def _outline(file: XmlFile) -> Iterator[dict[str, Any]]:
    """Yield the trees and the models in the form of btlang.editing.document.outline."""
    document = file.document
    for head in file.heads:
        span, elements = head.span, document.elements
        end = elements[head.end][2] if head.end < len(elements) else len(document.source.text)
        end = len(document.source.text[:end].rstrip())
        yield {"name": head.id, "start": span.start, "end": span.end, "of": (span.start, end), "kind": "definition"}
    for node_id in file.models:
        span = file.model_span(node_id)
        yield {"name": node_id, "start": span.start, "end": span.end, "of": (span.start, span.end), "kind": "fact"}


def _references(file: XmlFile, files: XmlFiles) -> Iterator[Reference]:
    """Yield the ids of nodes that have a model, and of the trees that SubTree nodes call."""
    models = {node_id: each.model_span(node_id) for each in reversed(files.files) for node_id in each.models}
    trees = {head.id: head.span for each in reversed(files.files) for head in each.heads}
    for index in range(len(file.document.elements)):
        span, attributes = file.document.span(index), file.document.attributes(index)
        tag = file.document.elements[index][0]
        named = attributes.get("ID", tag)
        target = (trees if tag in (SUBTREE, _TREE) else models).get(named)
        written = re.search(rf'(?<=<){re.escape(named)}|(?<=["\']){re.escape(named)}(?=["\'])', span.text)
        if target is not None and written is not None:
            inner = _name_in(target, named)
            yield Reference(span.start + written.start(), span.start + written.end(), inner)


def _name_in(target: Span, name: str) -> Span:
    """Return the characters of a start tag that are a name."""
    at = target.text.find(name, 1)
    return Span(target.source, target.start + at, target.start + at + len(name)) if at > 0 else target
