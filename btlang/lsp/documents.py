"""Documents that a client has open: their texts, and how these change."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence

from lsprotocol.types import TextDocumentContentChangeEvent, TextDocumentContentChangePartial
from pygls.uris import to_fs_path

from btlang.editing.words import RobotWords
from btlang.frontends.table import XML_ENDINGS
from btlang.lsp.positions import TextPositions
from btlang.support.record import Record
from btlang.support.test_files import is_test_file

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MISSION, TEST, TABLES, TREE = "mission", "test", "tables", "tree"
"""What a document may be: a mission (or a tree in JSON), tests, a TOML file, or a tree in XML."""


class Snapshot(Record):
    """A version of a document, as it is sent to the process that reads it.

    `revision` counts the changes of files on disk, which may be files that the text names.
    """

    kind: str
    uri: str
    text: str
    words: RobotWords
    revision: int


class Replacement(Record):
    """A change of a text: the characters `start` to `end` (exclusive) became `length` others."""

    start: int
    end: int
    length: int

    def moved(self, at: int) -> int:
        """Return where a character is after the change; one that was replaced is at its start."""
        return at if at <= self.start else max(at, self.end) - self.end + self.start + self.length

    def touches(self, start: int, end: int) -> bool:
        """Return whether the change is in these characters, or beside them."""
        return self.start <= end and start <= self.end


class Document:
    """An open document. `messages` are those that the client has, `decisive` the places of `decisive_places`; both have
    their places in the present text.
    """

    def __init__(self, uri: str, language: str, version: int, text: str) -> None:
        self.uri, self.version, self.text = uri, version, text
        self.path = to_fs_path(uri) or ""
        self.kind = _kind(self.path or uri, language)
        self.positions = TextPositions(text)
        self.messages: list[dict[str, Any]] = []
        self.decisive: list[int] | None = None
        self.changed: tuple[int, int] | None = None
        """The characters that have changed since they, or the whole document, were read."""
        self.analysis: dict[str, Any] | None = None
        """What btlang.lsp.readers.analyse says of the present text, None if it wasn't asked yet."""
        self.due = 0.0
        """When the document is read as a whole, by the clock of the event loop."""

    def change(self, version: int, changes: Sequence[TextDocumentContentChangeEvent]) -> None:
        """Apply what a client reports."""
        self.version, self.analysis = version, None
        for change in changes:
            start, end = 0, len(self.text)
            if isinstance(change, TextDocumentContentChangePartial):
                start, end = self.positions.offsets(change.range)
            self._replace(Replacement(start, end, len(change.text)), change.text)

    def snapshot(self, words: RobotWords, revision: int) -> Snapshot:
        """Return the present version."""
        return Snapshot(self.kind, self.uri, self.text, words, revision)

    def _replace(self, made: Replacement, text: str) -> None:
        self.text = self.text[: made.start] + text + self.text[made.end :]
        self.positions = TextPositions(self.text)
        self.decisive = None if self.decisive is None else [made.moved(at) for at in self.decisive]
        kept = (each for each in self.messages if each["start"] is None or not made.touches(each["start"], each["end"]))
        self.messages = [_moved(each, made) for each in kept]
        start, end = self.changed or (made.start, made.start)
        self.changed = min(made.moved(start), made.start), max(made.moved(end), made.start + made.length)


def _moved(message: dict[str, Any], made: Replacement) -> dict[str, Any]:
    """Return a message with all of its places moved; what it offers for what has changed is left out."""
    if message["start"] is None:
        return message
    message = {**message, "start": made.moved(message["start"]), "end": made.moved(message["end"])}
    if message["fix"] is not None and _is_changed([message["fix"]], made):
        message["fix"] = None
    if _is_changed(message["readings"], made):
        message["readings"] = []
    for name in ("readings", "notes"):
        message[name] = [_moved_place(place, made) for place in message[name]]
    message["fix"] = message["fix"] and _moved_place(message["fix"], made)
    return message


def _is_changed(places: Iterable[dict[str, Any]], made: Replacement) -> bool:
    return any(place["start"] is None or made.touches(place["start"], place["end"]) for place in places)


def _moved_place(place: dict[str, Any], made: Replacement) -> dict[str, Any]:
    if place["start"] is None:
        return place
    return {**place, "start": made.moved(place["start"]), "end": made.moved(place["end"])}


def _kind(name: str, language: str) -> str:
    ending = os.path.splitext(name)[1].lower()
    if ending in XML_ENDINGS or language == "xml":
        return TREE
    if ending == ".toml" or language == "toml":
        return TABLES
    return TEST if is_test_file(name) else MISSION
