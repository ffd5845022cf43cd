"""What is read of a document, in a process of its own: messages, and all that an editor shows beside the text.

Everything is data: places are characters, or in other files positions as the protocol counts them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from btlang.api import format_mission
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.diagnostics.files import read_source
from btlang.editing.document import messages, outline
from btlang.editing.focus import decisive_places, without_statements
from btlang.editing.help import hover, tokens
from btlang.editing.reading import TextReading
from btlang.editing.references import Reference, quoted_files, references
from btlang.editing.rename import rename
from btlang.editing.structure import folds, reading_brackets, statement_tree
from btlang.lsp.documents import MISSION, TABLES, TEST, TREE, Snapshot
from btlang.lsp.positions import TextPositions
from btlang.lsp.tables import analyse_tables, table_problems
from btlang.lsp.trees import analyse_tree, tree_problems
from btlang.pictures.tree_picture import to_svg
from btlang.support.record import Record
from btlang.support.test_files import ENDING
from btlang.testing.test_file import check_tests, find_tests, format_tests
from btlang.text.source import Source, Span
from btlang.vocabulary.shipped import shipped

_MOST_KEPT = 4  # readings of missions
_MOST_READINGS = 3  # without what is wrong, other statements may be wrong
_SHIPPED = "keywords/"
_TEST_FOLDER = "tests"
NOTHING: Mapping[str, Any] = {
    "outline": [], "tokens": [], "folds": [], "brackets": [], "references": [], "tests": [], "decisive": [],
}  # fmt: skip
"""What is shown beside a text of which nothing is known."""
_kept: dict[str, tuple[int, TextReading]] = {}
"""The latest readings by the URI, each with the revision of the files on disk."""


class DocumentKind(Record):
    """What is done with the documents of a kind: `problems` finds their messages, `analyse` what is shown beside the
    text, `format` gives another layout.
    """

    problems: Callable[[Source, Snapshot], Sequence[Diagnostic]]
    analyse: Callable[[Source, Snapshot], dict[str, Any]]
    format: Callable[[Source, Snapshot], str] | None = None


def diagnose(snapshot: Snapshot) -> list[dict[str, Any]]:
    """Return the messages about a document, as btlang.editing.document.messages."""
    source = _source(snapshot)
    try:
        problems = _KINDS[snapshot.kind].problems(source, snapshot)
    except MissionError as error:
        problems = error.diagnostics
    return messages(problems, source)


def analyse(snapshot: Snapshot) -> dict[str, Any]:
    """Return what is shown beside a text.

    `outline` is as in btlang.editing.document, `tokens` as in btlang.editing.help, `folds` and `brackets` as in
    btlang.editing.structure, `references` have `start`, `end` and the `target`, `tests` are names with their places,
    and `decisive` is as in btlang.editing.focus.
    """
    source = _source(snapshot)
    try:
        found = _KINDS[snapshot.kind].analyse(source, snapshot)
    except MissionError:  # the messages say it
        found = {}
    whole = {**NOTHING, **found}
    if snapshot.kind != MISSION:
        whole["references"] = [*whole["references"], *quoted_files(source)]
    whole["folds"] = _folds(snapshot.text, whole["outline"])
    whole["references"] = [_reference(each, source) for each in whole["references"]]
    return whole


def _folds(text: str, parts: Sequence[dict[str, Any]]) -> list[tuple[int, int]]:
    """Return the lines that fold: those of blocks, and of the parts of the outline, whose lines may not be indented."""
    lines = Source(text)
    inside = ((lines.position(part["of"][0])[0] - 1, lines.position(part["of"][1])[0] - 1) for part in parts)
    return sorted({*folds(text), *((first, last) for first, last in inside if first < last)})


def layout(snapshot: Snapshot) -> str:
    """Return the text in the usual layout. Raises MissionError if it has mistakes."""
    format = _KINDS[snapshot.kind].format
    return format(_source(snapshot), snapshot) if format is not None else snapshot.text


def hovered(snapshot: Snapshot, at: int) -> dict[str, Any] | None:
    """Return what was understood at a character, with the `tree` of the statement. Raises MissionError."""
    if snapshot.kind not in (MISSION, TREE):
        return None
    read = _understood(_reading(snapshot))
    found: dict[str, Any] | None = hover(read.source, at, snapshot.words, read)["found"]
    return None if found is None else {**found, "tree": statement_tree(read, at)}


def drawn(snapshot: Snapshot) -> dict[str, Any]:
    """Return the tree of what is understood as an `svg` picture, "" if nothing is; `is_whole` if that is everything."""
    if snapshot.kind not in (MISSION, TREE):
        return {"svg": "", "is_whole": True}
    whole = _reading(snapshot)
    read = _understood(whole)
    return {
        "svg": "" if read.mission is None else to_svg(read.mission.tree, read.mission.vocabulary),
        "is_whole": read is whole,
    }


def renamed(snapshot: Snapshot, at: int, name: str | None = None) -> dict[str, Any]:
    """Return what btlang.editing.rename does. Raises MissionError."""
    return rename(_source(snapshot), at, snapshot.words, name)


def _source(snapshot: Snapshot) -> Source:
    """Return the text of a document, that of its reading if it is a mission. One without a file names no others."""
    return _reading(snapshot).source if snapshot.kind == MISSION else snapshot.words.source(snapshot.text)


def _reading(snapshot: Snapshot) -> TextReading:
    """Return the reading of a mission, which is kept for what is asked next."""
    source = snapshot.words.source(snapshot.text)
    kept = _kept.pop(snapshot.uri, None)
    if kept is None or kept[0] != snapshot.revision or not kept[1].is_of(source, snapshot.words):
        kept = snapshot.revision, TextReading(source, snapshot.words)
    while len(_kept) >= _MOST_KEPT:
        del _kept[next(iter(_kept))]
    _kept[snapshot.uri] = kept
    return kept[1]


def _understood(read: TextReading) -> TextReading:
    """Return the reading of a text in English without the statements that are wrong, if it has any; the rest stays in
    its place.
    """
    part = read
    for _ in range(_MOST_READINGS):
        if part.mission is not None or part.sort != "english":
            return part
        wrong = [each.span.start for each in part.problems if each.is_error and each.span.source is part.source]
        text = without_statements(part.source.text, wrong)
        if text == part.source.text:
            break
        part = TextReading(read.source.with_text(text), read.words)
    return part if part.mission is not None else read


def _analyse_mission(_: Source, snapshot: Snapshot) -> dict[str, Any]:
    whole = _reading(snapshot)
    read = _understood(whole)
    found: dict[str, Any] = {}
    if read.mission is not None:
        found["outline"] = outline(read.mission, read.source)
    if read.sort == "english":
        found["decisive"] = decisive_places(whole.lexer)
        found["tokens"] = tokens(whole.source, snapshot.words, lexer=whole.lexer)["tokens"]
        found["references"] = references(read)
        found["brackets"] = [each.as_dict() for each in reading_brackets(read)]
    found["tests"] = [{"name": "", "start": 0, "end": 0, "file": path} for path in _tests_beside(snapshot.words.file)]
    return found


def _tests_beside(path: str) -> list[str]:
    """Return the files with the tests of a mission: `patrol.test.txt` beside it, or in the folder `tests`."""
    if not path:
        return []
    folder, name = os.path.split(path)
    name = f"{os.path.splitext(name)[0]}{ENDING}"
    beside = (os.path.join(folder, name), os.path.join(folder, _TEST_FOLDER, name))
    return [each for each in beside if os.path.isfile(each)]


def _analyse_tests(source: Source, _: Snapshot) -> dict[str, Any]:
    named = find_tests(source)
    ends = [*(span.start for _, span in named[1:]), len(source.text)]
    tests = [{"name": name, "start": span.start, "end": span.end, "file": ""} for name, span in named]
    parts = [
        {**test, "of": (test["start"], len(source.text[:end].rstrip())), "kind": "rule"}
        for test, end in zip(tests, ends, strict=False)  # of a file without tests, the end alone
    ]
    return {"tests": tests, "outline": parts}


def _format_mission(source: Source, snapshot: Snapshot) -> str:
    words = snapshot.words
    return format_mission(source, keywords=words.keywords, world=words.world, language=words.language)


def _reference(reference: Reference, source: Source) -> dict[str, Any]:
    """Return a reference as data: its `target` has a `file`, "" for the text itself, and a `place`.

    This is two characters in the text itself, elsewhere four numbers: line and column of start and end.
    """
    target = reference.target
    if target.source.name == source.name:
        found: dict[str, Any] = {"file": "", "place": (target.start, target.end)}
    else:
        found = {"file": _path(target.source.name), "place": _place(target)}
    return {"start": reference.start, "end": reference.end, "target": found}


def _path(name: str) -> str:
    """Return the path of a file by the name that messages give it."""
    path = shipped("keywords", *name.removeprefix(_SHIPPED).split("/")) if name.startswith(_SHIPPED) else name
    return os.path.abspath(path)


def _place(target: Span) -> tuple[int, int, int, int]:
    text = target.source.text
    if not text and target.end:  # words from the cache don't have it
        try:
            text = read_source(_path(target.source.name)).text
        except MissionError:
            return 0, 0, 0, 0
    positions = TextPositions(text)
    start, end = positions.position(target.start), positions.position(target.end)
    return start.line, start.character, end.line, end.character


_KINDS: Mapping[str, DocumentKind] = {
    MISSION: DocumentKind(lambda _, snapshot: _reading(snapshot).problems, _analyse_mission, _format_mission),
    TEST: DocumentKind(lambda source, _: check_tests(source), _analyse_tests, lambda source, _: format_tests(source)),
    TABLES: DocumentKind(table_problems, analyse_tables),
    TREE: DocumentKind(tree_problems, analyse_tree),
}
