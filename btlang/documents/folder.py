"""Writes the pages about a project to a folder, to a file, or to standard output."""

from __future__ import annotations

import os
from collections.abc import Sequence

from btlang.backends.files import put, write_file
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import read_source, unwritable
from btlang.documents.pages import INDEX, MADE, PageWriter
from btlang.documents.project import DocumentedProject


def write_pages(project: DocumentedProject, paths: Sequence[str], out: str | None) -> bool:
    """Write the pages about what was read at these paths; a page of somebody else isn't replaced.

    One file becomes a page on standard output, or in a file whose name ends in `.md`; all else becomes a folder. False
    where that needs a folder and none is named. Raises MissionError (BT009).
    """
    writer = PageWriter(project)
    is_single = len(paths) == 1 and not os.path.isdir(paths[0])
    if out is None or (out.endswith(".md") and not os.path.isdir(out)):
        if not is_single:
            return False
        [file] = project.files
        if out is not None:
            _check(out)
        put(writer.page(file, pictures=False), out)
        return True
    contents = {writer.pages[file]: writer.page(file) for file in project.files}
    contents |= {INDEX: writer.index(), **dict(writer.pictures())}
    try:
        os.makedirs(out, exist_ok=True)
    except OSError as error:
        raise MissionError([unwritable(out, error)]) from None
    found = {os.path.join(out, name): content for name, content in contents.items()}
    for path in found:
        if path.endswith(".md"):
            _check(path)
    for path, content in found.items():
        write_file(path, content)
    return True


def _check(path: str) -> None:
    """Raise MissionError (BT009) where a page is there that was not made here."""
    if os.path.isfile(path) and not read_source(path).text.startswith(MADE):
        raise MissionError(
            [unwritable(path, "a page is there that btc didn't make; choose another folder, or remove it")]
        )
