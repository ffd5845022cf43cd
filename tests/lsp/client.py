"""A client of `btc lsp` over standard input and output, which checks every message against the protocol's types."""

from __future__ import annotations

import asyncio
import json
import logging
import os
import subprocess
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Iterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from lsprotocol import types
from pygls.io_ import run_async
from pygls.lsp.client import LanguageClient
from pygls.protocol import LanguageServerProtocol, default_converter

from tests.forked import Process, popen
from tests.lsp.texts import changed, position_of, unit_of

ROOT = Path(__file__).parent.parent.parent
PATIENCE = 60.0  # seconds, on a busy machine


class CheckedProtocol(LanguageServerProtocol):
    """Messages have to be what the protocol's types say: nothing is left over that these don't know."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """The message as an object of the protocol, which is the same message again."""
        if "jsonrpc" not in data:
            return data
        message = super().structure_message(data)
        again = json.loads(json.dumps(message, default=self._serialize_message))
        wrong: list[Any] = self._server.wrong  # type: ignore[attr-defined]
        if _without_none(again) != _without_none(data):
            wrong.append((data, again))
        return message


def _without_none(part: Any) -> Any:
    if isinstance(part, dict):
        return {key: _without_none(value) for key, value in part.items() if value is not None}
    return [_without_none(each) for each in part] if isinstance(part, list) else part


class Client(LanguageClient):
    """A client with the messages that the server publishes, by URI, and what it writes to its log."""

    def __init__(self, is_checked: bool) -> None:
        protocol = CheckedProtocol if is_checked else LanguageServerProtocol
        super().__init__("tests", "1", protocol_cls=protocol, converter_factory=default_converter)
        self.published: dict[str, list[types.PublishDiagnosticsParams]] = {}
        self.log: list[str] = []
        self.wrong: list[Any] = []
        self.started: Any = None
        self._process: Process
        self._news = asyncio.Event()
        self.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(lambda params: self._publish(params))
        self.feature(types.WINDOW_LOG_MESSAGE)(lambda params: self.log.append(params.message))
        self.feature(types.WINDOW_SHOW_MESSAGE)(lambda params: self.log.append(params.message))

    def _publish(self, params: types.PublishDiagnosticsParams) -> None:
        self.published.setdefault(params.uri, []).append(params)
        self._news.set()

    async def start_forked(self, options: Sequence[str], errors: int) -> None:
        """Starts the server as `start_io` does, but forked: most of its start is the import of the protocol's types."""
        words = [sys.executable, "-m", "btlang", "lsp", *options]
        environment, pipe = {**os.environ, "PYTHONPATH": str(ROOT)}, subprocess.PIPE
        process = popen(words, env=environment, stdin=pipe, stdout=pipe, stderr=errors)
        loop, reader = asyncio.get_running_loop(), asyncio.StreamReader()
        await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), process.stdout)
        transport, flow = await loop.connect_write_pipe(asyncio.streams.FlowControlMixin, process.stdin)
        self.protocol.set_writer(asyncio.StreamWriter(transport, flow, None, loop))
        options_of_reading = {"stop_event": self._stop_event, "protocol": self.protocol, "logger": logging.getLogger()}
        reading = run_async(reader=reader, error_handler=self.report_server_error, **options_of_reading)  # type: ignore[arg-type]
        self._async_tasks.append(asyncio.create_task(reading))
        self._process = process

    async def stop(self) -> None:
        """Waits until the server has ended."""
        await asyncio.to_thread(self._process.wait)
        self._stop_event.set()
        await asyncio.gather(*self._async_tasks)

    @property
    def process_id(self) -> int:
        """That of the server."""
        return self._process.pid

    def open(self, uri: str, text: str, language: str = "btlang") -> str:
        """Opens a document."""
        self.text_document_did_open(types.DidOpenTextDocumentParams(types.TextDocumentItem(uri, language, 1, text)))
        return uri

    def change(self, uri: str, version: int, *changes: tuple[tuple[int, int, int, int], str] | str) -> None:
        """Changes ranges, or the whole text, one after the other."""
        made: list[types.TextDocumentContentChangeEvent] = []
        for change in changes:
            if isinstance(change, str):
                made.append(types.TextDocumentContentChangeWholeDocument(change))
            else:
                (line, column, end_line, end_column), text = change
                place = types.Range(types.Position(line, column), types.Position(end_line, end_column))
                made.append(types.TextDocumentContentChangePartial(place, text))
        item = types.VersionedTextDocumentIdentifier(version, uri)
        self.text_document_did_change(types.DidChangeTextDocumentParams(item, made))

    async def messages(self, uri: str, version: int | None = 1, count: int = 1) -> list[types.Diagnostic]:
        """The messages about a version of a document, the latest of so many that are published."""
        async with asyncio.timeout(PATIENCE):
            while True:
                found = [each for each in self.published.get(uri, ()) if each.version == version]
                if len(found) >= count:
                    return list(found[-1].diagnostics)
                self._news.clear()
                await self._news.wait()

    async def settled(self, uri: str) -> list[types.Diagnostic]:
        """The messages about a document once all of it was read: the outline waits for that."""
        await self.text_document_document_symbol_async(types.DocumentSymbolParams(types.TextDocumentIdentifier(uri)))
        return list(self.published[uri][-1].diagnostics)

    async def ask(self, ask: Callable[[Any], Awaitable[Any]], params: Any) -> Any:
        """What a request is answered."""
        async with asyncio.timeout(PATIENCE):
            return await ask(params)

    async def actions(self, uri: str, range: types.Range) -> list[types.CodeAction]:
        """The corrections that are offered in a range."""
        context = types.CodeActionContext([])
        params = types.CodeActionParams(types.TextDocumentIdentifier(uri), range, context)
        return list(await self.ask(self.text_document_code_action_async, params))

    def position(self, text: str, at: int) -> tuple[int, int]:
        """The position of a character."""
        return position_of(text, at)

    def apply(self, text: str, edit: types.WorkspaceEdit | None) -> str:
        """The text with an edit of its document alone."""
        assert edit is not None
        assert edit.changes is not None
        [edits] = edit.changes.values()
        for each in sorted(edits, key=lambda each: (each.range.start.line, each.range.start.character), reverse=True):
            text = changed(text, _numbers(each.range), each.new_text)
        return text

    def colours(self, text: str, data: Sequence[int]) -> Iterator[tuple[str, str]]:
        """The words of a text with the types of their tokens."""
        provider: Any = self.started.capabilities.semantic_tokens_provider
        line = column = 0
        for down, right, length, kind, _ in zip(*(iter(data),) * 5, strict=True):
            line, column = line + down, right if down else column + right
            words = text_at(text, types.Range(types.Position(line, column), types.Position(line, column + length)))
            yield words, provider.legend.token_types[kind]


def text_at(text: str, range: types.Range) -> str:
    """The characters of a range."""
    units = text.encode("utf-16-le")
    start, end = unit_of(text, *_numbers(range)[:2]), unit_of(text, *_numbers(range)[2:])
    return units[2 * start : 2 * end].decode("utf-16-le")


def _numbers(range: types.Range) -> tuple[int, int, int, int]:
    return range.start.line, range.start.character, range.end.line, range.end.character


@asynccontextmanager
async def client(*options: str, is_checked: bool = True) -> AsyncIterator[Client]:
    """A client of a server of its own, which ends cleanly, wrote nothing to standard error, and sent what it may."""
    made = Client(is_checked)
    with TemporaryFile() as errors:
        await made.start_forked(options, errors.fileno())
        capabilities = types.ClientCapabilities()
        async with asyncio.timeout(PATIENCE):
            made.started = await made.initialize_async(types.InitializeParams(capabilities=capabilities))
        made.initialized(types.InitializedParams())
        yield made
        async with asyncio.timeout(PATIENCE):
            await made.shutdown_async(None)
            made.exit(None)
            await made.stop()
        errors.seek(0)
        assert errors.read() == b""
    assert made.wrong == []
    assert made.log == []


def run(test: Coroutine[Any, Any, None]) -> None:
    """Runs a test."""
    asyncio.run(test)
