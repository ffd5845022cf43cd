"""Which files a project has: those that are named, and in folders the trees in XML, for pages missions, too."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import read_source, real_path
from btlang.frontends.table import XML_ENDINGS
from btlang.text.source import Source, Span

_ROOT = re.compile(r"\s*(?:<\?.*?\?>\s*|<!--.*?-->\s*|<!DOCTYPE[^>]*>\s*)*<root[\s/>]", re.DOTALL)

_TELLING = re.compile(
    r"<(?:BehaviorTree|TreeNodesModel|include)\b|BTCPP_format|main_tree_to_execute|<root\s*/?>\s*(?:</|$)"
)

_IGNORED = frozenset(("COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"))
"""Files in folders that aren't sources: colcon puts them into `build`, `install` and `log`, where copies are."""


def find_tree_files(folder: str) -> list[str]:
    """Return the files of trees and models in a folder and below it, without hidden ones.

    Raises MissionError (BT001).
    """
    found = [path for path in find_files_below(folder, XML_ENDINGS) if _may_have_trees(path)]
    if not found:
        raise empty_folder_error(folder, "there are no trees in XML in this folder")
    return found


def empty_folder_error(folder: str, reason: str) -> MissionError:
    """Make the error BT001 for a folder in which nothing of what is wanted is."""
    return MissionError([diagnostic("BT001", Span(Source("", folder), 0, 0), file=folder, reason=reason)])


def find_named_files(paths: Sequence[str], inside: Callable[[str], Iterable[str]] = find_tree_files) -> Iterator[str]:
    """Yield the files, each once, with those inside folders in their place. Raises what `inside` raises."""
    done: set[str] = set()
    for path in paths:
        for file in inside(path) if os.path.isdir(path) else [path]:
            real = file if file == "-" else real_path(file)
            if real not in done:
                done.add(real)
                yield file


def find_files_below(folder: str, endings: tuple[str, ...]) -> Iterator[str]:
    """Yield the files with these endings in a folder and below it, without hidden ones and what builds leave out."""
    for inside, folders, files in os.walk(folder):
        if inside != folder and not _IGNORED.isdisjoint(files):
            folders.clear()
            continue
        folders[:] = sorted(name for name in folders if name[:1] != ".")
        for name in sorted(files):
            if name.endswith(endings) and name[:1] != ".":
                yield os.path.normpath(os.path.join(inside, name))


def begins_as_tree(source: Source) -> bool:
    """Return whether the outermost tag is that of BehaviorTree.CPP."""
    return _ROOT.match(source.text) is not None


def _may_have_trees(path: str) -> bool:
    """Return whether a file begins as a tree, and has what belongs there: other programs have a <root>, too.

    What can't be read is reported later.
    """
    try:
        source = read_source(path)
        return begins_as_tree(source) and _TELLING.search(source.text) is not None
    except MissionError:
        return True
