"""The open documents of a client, and when they are read: in part at each key, as a whole once typing rests."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, TypeVar

from lsprotocol import types

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.document import messages
from btlang.editing.focus import Focus, focus_on, provisional_problems
from btlang.editing.help import complete
from btlang.editing.words import RobotWords
from btlang.lsp.documents import MISSION, TABLES, TEST, Document
from btlang.lsp.protocol import ContentModified, RequestFailed
from btlang.lsp.readers import NOTHING, analyse, diagnose, drawn
from btlang.lsp.tables import complete_tables
from btlang.support.gc_pause import gc_paused
from btlang.support.worker import Worker, WorkerEnded
from btlang.testing.statements import OPENERS

T = TypeVar("T")

_QUICK = 0.003  # seconds behind a key until what is around it is read: several changes may come at once
_REST = 0.3  # seconds without a key until all of a text is read
_PATIENCE = 20.0  # seconds for one text
_MOST_QUICK = 6_000  # characters that are read at each key


class OpenDocuments:
    """The documents that a client has open. `publish` sends the messages of one, `log` a line for the user's log."""

    def __init__(
        self, words: RobotWords, publish: Callable[[str, int | None, Document | None], None], log: Callable[[str], None]
    ) -> None:
        self._words, self._publish, self._log = words, publish, log
        self._open: dict[str, Document] = {}
        self._checks: dict[str, asyncio.Task[None]] = {}
        self._quick: dict[str, asyncio.TimerHandle] = {}
        self._worker, self._turn = Worker(), asyncio.Lock()
        self._revision = 0

    def __getitem__(self, uri: str) -> Document:
        """Return an open document. Raises RequestFailed."""
        if uri not in self._open:
            raise RequestFailed(f"{uri} isn't open")
        return self._open[uri]

    def all(self) -> list[Document]:
        """List the open documents."""
        return list(self._open.values())

    def words(self, document: Document) -> RobotWords:
        """Return the words that a document is read with."""
        return self._words.for_file(document.path)

    # -- what clients report

    def open(self, item: types.TextDocumentItem) -> None:
        """Open a document, or open it again."""
        document = Document(item.uri, item.language_id, item.version, item.text)
        self._open[item.uri] = document
        self._check(document)

    def change(
        self, item: types.VersionedTextDocumentIdentifier, changes: Sequence[types.TextDocumentContentChangeEvent]
    ) -> None:
        """Change a document. Nothing is read before the next key could come."""
        document = self[item.uri]
        document.change(item.version, changes)
        loop = asyncio.get_running_loop()
        document.due = loop.time() + _REST
        waiting = self._quick.pop(item.uri, None)
        if waiting is not None:
            waiting.cancel()
        self._quick[item.uri] = loop.call_later(_QUICK, self._read_around_change, document)
        self._check(document)

    def close(self, uri: str) -> None:
        """Close a document, and take its messages away."""
        document = self._open.pop(uri, None)
        waiting = self._quick.pop(uri, None)
        if waiting is not None:
            waiting.cancel()
        if document is not None:
            self._publish(uri, None, None)

    def files_changed(self) -> None:
        """Read all documents again: files changed that they may name."""
        self._revision += 1
        for document in self._open.values():
            document.analysis = None
            self._check(document)

    def end(self) -> None:
        """End the process that reads, and all that waits for it."""
        for task in self._checks.values():
            task.cancel()
        self._worker.close()

    # -- what is asked of them

    async def do(self, document: Document, work: Callable[..., T], *given: object) -> T:
        """Return what the process of readers makes of a document. Raises MissionError and WorkerEnded."""
        async with self._turn:
            return await self._worker.do(
                _PATIENCE, work, document.snapshot(self.words(document), self._revision), *given
            )

    async def ask(self, document: Document, work: Callable[..., T], *given: object) -> T:
        """Return the same for a client. Raises ContentModified as well, if the text has changed meanwhile."""
        text = document.text
        found = await self.do(document, work, *given)
        if document.text != text:
            raise ContentModified
        return found

    async def analysis(self, document: Document) -> dict[str, Any]:
        """Return what btlang.lsp.readers.analyse says of the present text, once typing rests."""
        while document.analysis is None:
            if self._open.get(document.uri) is not document:
                raise RequestFailed(f"{document.uri} was closed")
            await self._check(document)
        return document.analysis

    async def drawing(self, document: Document) -> dict[str, Any]:
        """Return what btlang.lsp.readers.drawn does, of a long text once typing rests."""
        if len(document.text) > _MOST_QUICK:
            await self.analysis(document)
        return await self.ask(document, drawn)

    async def completions(self, document: Document, at: int) -> list[dict[str, Any]]:
        """Return completions at a character, without reading all of a long mission."""
        if document.kind == TABLES:
            return complete_tables(document.text, at)["completions"]  # type: ignore[no-any-return]
        if document.kind == TEST:
            return _complete_test(document.text, at)
        if document.kind != MISSION:
            return []
        words = self.words(document)
        focus = self._focus(document, at, at)
        text = document.text if focus is None else focus.text
        if focus is None and len(text) > _MOST_QUICK:
            return (await self.ask(document, _complete, at))["completions"]  # type: ignore[no-any-return]
        with gc_paused:
            return complete(words.source(text), words, at, document.text)["completions"]  # type: ignore[no-any-return]

    # -- reading

    def _check(self, document: Document) -> asyncio.Task[None]:
        """Read a document as a whole, unless that is under way."""
        task = self._checks.get(document.uri)
        if task is None or task.done():
            task = self._checks[document.uri] = asyncio.get_running_loop().create_task(self._read_all(document.uri))
            task.add_done_callback(self._log_failure)
        return task

    def _log_failure(self, task: asyncio.Task[None]) -> None:
        error = None if task.cancelled() else task.exception()
        if error is not None:
            self._log(f"A bug in btlang: {type(error).__name__}: {error}")

    async def _read_all(self, uri: str) -> None:
        """Read a document until its latest version was read."""
        loop = asyncio.get_running_loop()
        while (document := self._open.get(uri)) is not None:
            await asyncio.sleep(max(0.0, document.due - loop.time()))
            read = document.text, self._revision, document
            if document.due > loop.time():
                continue
            found: list[dict[str, Any]] = []
            analysis: dict[str, Any] | None = None
            try:
                found = await self.do(document, diagnose)
                if not self._is_current(uri, read):
                    continue
                document.messages, document.changed = found, None
                self._publish(uri, document.version, document)
                analysis = await self.do(document, analyse)
            except WorkerEnded:
                self._log(f"{uri} takes too long to read.")
                analysis = analysis or {}
            if self._is_current(uri, read):
                document.analysis = {**NOTHING, **analysis}
                document.decisive = list(document.analysis["decisive"])
                return

    def _is_current(self, uri: str, read: tuple[str, int, Document]) -> bool:
        document = self._open.get(uri)
        return document is read[2] and (document.text, self._revision) == read[:2]

    def _focus(self, document: Document, start: int, end: int) -> Focus | None:
        """Return what is read at a key; None if that takes long, or the text wasn't read as a whole yet."""
        if document.kind != MISSION or document.decisive is None:
            return None
        focus = focus_on(document.text, start, end, document.decisive)
        return focus if focus.size <= _MOST_QUICK else None

    def _read_around_change(self, document: Document) -> None:
        """Publish the messages that a change brings, those around it provisionally: all is read once typing rests."""
        changed, document.changed = document.changed, None
        if self._open.get(document.uri) is not document or changed is None:
            return
        focus = self._focus(document, *changed)
        if focus is not None:
            words = self.words(document)
            source = words.source(focus.text)
            with suppress(MissionError):
                found = messages(provisional_problems(source, words), source)
                inside = [each for each in found if _is_inside(each, focus)]
                kept = [each for each in document.messages if not _is_inside(each, focus)]
                document.messages = sorted([*kept, *inside], key=lambda each: each["start"] or 0)
        self._publish(document.uri, document.version, document)


def _is_inside(message: dict[str, Any], focus: Focus) -> bool:
    return message["start"] is not None and focus.start <= message["start"] < max(focus.end, focus.start + 1)


def _complete(snapshot: Any, at: int) -> dict[str, Any]:
    return complete(snapshot.words.source(snapshot.text), snapshot.words, at)


def _complete_test(text: str, at: int) -> list[dict[str, Any]]:
    """List the words that may begin a line of a test."""
    line = text[:at].rpartition("\n")[2]
    written = line.lstrip()
    if written and not written.isalpha():
        return []
    words = [("test", 'test "it goes to the lab":'), *OPENERS.items()] if line == written else OPENERS.items()
    return [
        {"text": f"{word} ", "start": at - len(written), "kind": "connective", "help": example, "spelling": False}
        for word, example in words
        if word.startswith(written)
    ]
