"""Targets that a tree can be written as. A target is a line in `TARGETS`, and a function that is imported when used."""

from __future__ import annotations

import os
from collections.abc import Mapping
from importlib import import_module

from btlang.support.record import Record
from btlang.tree.node import Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Literal, TypeAlias

    TextTarget: TypeAlias = Literal[
        "xml", "english", "json", "python", "py_trees", "dot", "svg", "markdown", "tree", "keywords"
    ]
    BinaryTarget: TypeAlias = Literal["png"]


class Target(Record):
    """A target; `make` names its function, "module:function" of (tree, vocabulary, **options) to str or bytes.

    A file that ends in one of the `suffixes` is of this target where none is named. `options` are the options that the
    function takes from whoever asks, `given` those that a btlang.api.Mission fills in: "world" and "facts". What `runs`
    has to be whole for `btc compile`; people may also read a part whose other trees are in other files.
    """

    make: str
    about: str
    suffixes: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    binary: bool = False
    runs: bool = False


TARGETS = {
    "xml": Target(
        "btlang.backends.btcpp.writer:to_xml",
        "XML of BehaviorTree.CPP, for Groot2 and Nav2; --dialect 3 for version 3",
        (".xml",),
        options=("dialect", "onto"),
        runs=True,
    ),
    "english": Target(
        "btlang.backends.english:to_english", "a mission in English", (".txt",), given=("facts", "needs")
    ),
    "json": Target("btlang.backends.json_tree:to_json", "the tree as JSON, for programs", (".json",), runs=True),
    "python": Target(
        "btlang.backends.python_module:to_python",
        "a Python module that runs the tree with btlang",
        (".py",),
        given=("world", "facts"),
        runs=True,
    ),
    "py_trees": Target(
        "btlang.backends.py_trees.module:to_module", "a Python module that builds it with py_trees", runs=True
    ),
    "dot": Target("btlang.backends.dot:to_dot", "a graph for Graphviz", (".dot", ".gv")),
    "svg": Target("btlang.pictures.tree_picture:to_svg", "a picture of the tree", (".svg",)),
    "png": Target("btlang.pictures.tree_picture:to_png", "a picture of the tree", (".png",), binary=True),
    "markdown": Target(
        "btlang.documents.pages:to_markdown", "a page about the tree; of a folder, pages with pictures", (".md",)
    ),
    "tree": Target("btlang.backends.targets:to_plain", "one line per node: Id port=value"),
    "keywords": Target(
        "btlang.backends.keywords:to_keywords", "keyword entries for the commands that btlang does not know", (".toml",)
    ),
}


def target_of(path: str) -> str:
    """Return the name of the target that a file of this name is of, "" if its ending is that of none."""
    ending = os.path.splitext(path)[1].lower()
    return next((name for name, target in TARGETS.items() if ending in target.suffixes), "")


def compile_to(
    tree: Tree, vocabulary: Lexicon, name: str, given: Mapping[str, Any] = {}, **options: Any
) -> str | bytes:
    """Write the tree as a target, with the options that aren't None and what the target uses of what is `given`.

    Raises ValueError for an unknown name or option, MissionError if the target can't express the tree.
    """
    target = TARGETS.get(name)
    if target is None:
        raise ValueError(f"there is no target {name!r}; the targets are {', '.join(TARGETS)}")
    chosen = {option: value for option, value in options.items() if value is not None}
    unknown = [option for option in chosen if option not in target.options]
    if unknown:
        raise ValueError(f"the target {name} takes no {unknown[0]}")
    chosen |= {key: given[key] for key in target.given if key in given}
    module, _, function = target.make.partition(":")
    made: str | bytes = getattr(import_module(module), function)(tree, vocabulary, **chosen)
    return made


def to_plain(tree: Tree, vocabulary: Lexicon) -> str:
    """Return the tree as `btc tree --plain` prints it."""
    from btlang.tree.dump import plain

    return plain(tree) + "\n"
