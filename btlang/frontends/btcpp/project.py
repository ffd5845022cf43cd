"""Several XML files as one project: their trees may use each other, and their models count for all of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.btcpp.file import TreeHead, XmlFile
from btlang.frontends.btcpp.files import XmlFiles, same_id
from btlang.frontends.btcpp.reader import MAIN, empty_file, no_tree
from btlang.frontends.btcpp.spelling import MAIN_TREE
from btlang.record import Record
from btlang.tree.model import NodeModel
from btlang.tree.node import Node


class XmlProject(Record):
    """The trees by name, their heads, the names of those that files start with, and the models by the id of a node.

    `dialects` is that of each file. `unread` are the IDs of trees whose files have mistakes. `problems` are errors and
    warnings of reading; where `is_round`, trees contain themselves.
    """

    trees: dict[str, Node]
    heads: dict[str, TreeHead]
    mains: frozenset[str]
    models: dict[str, NodeModel]
    dialects: dict[str, int]
    unread: frozenset[str]
    problems: tuple[Diagnostic, ...]
    is_round: bool = False


def read_project(read: XmlFiles, palettes: XmlFiles, main: str = "") -> XmlProject:
    """The project of these files; of `palettes` only the models count, before those of the files.

    A tree with the ID of one in another file is reported (BT127), unless both files start with them and no tree uses
    them. `main` is the ID of a tree that must be there.
    """
    sound = [file for file in read.files if file.is_sound]
    unread = frozenset(head.written for file in read.files if not file.is_sound for head in file.heads)
    heads, again = _named(sound)
    models = {**read.models, **palettes.models}
    read.read_trees(models)
    names, trees, used = read.names, read.trees, read.used
    circles = read.circles()
    problems = [*read.problems, *_once(read.warnings), *palettes.problems, *circles]
    problems += [empty_file(file) for file in sound if not (file.heads or file.models or file.includes)]
    mains = frozenset(own for file in sound if (own := _main_of(file, names)) in trees)
    for name, first in again.items():
        if not {name, first} <= mains or not used.isdisjoint((name, first)):
            problems.append(same_id(heads[name], heads[first]))
    known = dict.fromkeys((*names, *trees, *unread))  # no set: they are listed
    for file in sound:
        asked = main or file.attributes.get(MAIN, "")
        if asked and asked not in known:
            problems.append(no_tree(file.root_span, asked, known))
    dialects = {file.document.source.name: file.dialect for file in read.files}
    return XmlProject(trees, heads, mains, models, dialects, unread, tuple(problems), bool(circles))


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


def _named(files: list[XmlFile]) -> tuple[dict[str, TreeHead], dict[str, str]]:
    """The heads of all trees by unique names; and for those whose ID was taken, that ID by their new name."""
    heads: dict[str, TreeHead] = {}
    again: dict[str, str] = {}
    for file in files:
        for at, head in enumerate(file.heads):
            name, number = head.name, 2
            while name in heads:
                name, number = f"{head.name} ({number})", number + 1
            if name != head.name and head.written:
                again[name] = head.name
            heads[name] = file.heads[at] = head.replace(name=name)
    return heads, again


def _main_of(file: XmlFile, names: dict[str, str]) -> str:
    """The name of the tree that a file starts with, "" where it doesn't say."""
    written = file.attributes.get(MAIN, MAIN_TREE)
    own = {head.written: head.name for head in file.heads}
    return own.get(written) or (names.get(written, "") if MAIN in file.attributes else "")
