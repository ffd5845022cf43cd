"""Which files `btc check` reads: those that are named, and the trees in folders."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import read_source, real_path
from btlang.text.source import Source, Span

_ENDINGS = (".xml", ".btproj")
_ROOT = re.compile(r"\s*(?:<\?.*?\?>\s*|<!--.*?-->\s*|<!DOCTYPE[^>]*>\s*)*<root[\s/>]", re.DOTALL)


def tree_files(folder: str) -> list[str]:
    """The files of trees and models in a folder and below it, without hidden ones. Raises MissionError (BT001)."""
    found = [path for path in _walk(folder) if path.endswith(_ENDINGS) and _has_trees(path)]
    if not found:
        reason = "there are no trees in XML in this folder"
        raise MissionError([diagnostic("BT001", Span(Source("", folder), 0, 0), file=folder, reason=reason)])
    return found


def named_files(paths: Sequence[str]) -> Iterator[str]:
    """The files, each once, with those of folders in their place. Raises MissionError (BT001)."""
    done: set[str] = set()
    for path in paths:
        for file in tree_files(path) if os.path.isdir(path) else [path]:
            real = file if file == "-" else real_path(file)
            if real not in done:
                done.add(real)
                yield file


def _walk(folder: str) -> Iterator[str]:
    for inside, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if name[:1] != ".")
        yield from (os.path.normpath(os.path.join(inside, name)) for name in sorted(files) if name[:1] != ".")


def _has_trees(path: str) -> bool:
    """Whether the outermost tag is that of BehaviorTree.CPP; what can't be read is told later."""
    try:
        return _ROOT.match(read_source(path).text) is not None
    except MissionError:
        return True
