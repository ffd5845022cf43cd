"""The features of the language server: each request of the protocol, and what answers it."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

from lsprotocol import types
from pygls.exceptions import FeatureRequestError
from pygls.lsp.server import LanguageServer

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.words import RobotWords
from btlang.lsp import conversion
from btlang.lsp.documents import Document
from btlang.lsp.open_documents import OpenDocuments
from btlang.lsp.protocol import Protocol, answering
from btlang.lsp.readers import hovered, layout, renamed

DRAW = "btlang.drawTree"
"""The request for the picture of a tree, which the protocol doesn't have; docs/editors.md describes it."""
_WATCHED = "**/*.{txt,toml,xml,btproj}"
_TRIGGERS = [" ", '"', "["]


class Server(LanguageServer):
    """The server of one client."""

    documents: OpenDocuments

    def report_server_error(self, error: Exception, source: type[Exception]) -> None:
        """Write what goes wrong beside requests, which are answered, to the log of the client."""
        if source is not FeatureRequestError:
            self._write_log(str(error))

    def shutdown(self) -> None:
        """End, with the process that reads documents."""
        self.documents.end()
        super().shutdown()  # type: ignore[no-untyped-call]

    def publish(self, uri: str, version: int | None, document: Document | None) -> None:
        """Send the messages about a document; None takes them away."""
        found = [] if document is None else conversion.diagnostics(document)
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, found, version))

    def _write_log(self, text: str) -> None:
        self.window_log_message(types.LogMessageParams(types.MessageType.Error, text))


def make_server(words: RobotWords, version: str) -> Server:
    """Make a server that reads documents with these words."""
    server = Server(conversion.NAME, version, protocol_cls=Protocol)
    server.documents = OpenDocuments(words, server.publish, server._write_log)
    for method, handler, options in _FEATURES:
        server.feature(method, options)(_bound(handler, server.documents))
    server.feature(DRAW)(answering(partial(_draw, server.documents)))
    server.feature(types.INITIALIZED)(lambda _: _watch(server))
    for method in (types.TEXT_DOCUMENT_DID_SAVE, types.WORKSPACE_DID_CHANGE_WATCHED_FILES):
        server.feature(method)(lambda _: server.documents.files_changed())
    return server


def _bound(handler: Callable[..., Awaitable[Any]], documents: OpenDocuments) -> Callable[[Any], Awaitable[Any]]:
    async def answer(params: Any) -> Any:
        document = documents[params.text_document.uri]
        return await handler(documents, document, params)

    return answering(answer)


def _watch(server: Server) -> None:
    """Ask the client to report changes of files, if it can."""
    workspace = server.client_capabilities.workspace
    watching = workspace.did_change_watched_files if workspace is not None else None
    if watching is not None and watching.dynamic_registration:
        watched = types.DidChangeWatchedFilesRegistrationOptions([types.FileSystemWatcher(_WATCHED)])
        registration = types.Registration("files", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, watched)
        server.client_register_capability(types.RegistrationParams([registration]))


async def _complete(
    documents: OpenDocuments, document: Document, params: types.CompletionParams
) -> types.CompletionList:
    at = document.positions.offset(params.position)
    return conversion.completion_list(document, await documents.completions(document, at), at)


async def _hover(documents: OpenDocuments, document: Document, params: types.HoverParams) -> types.Hover | None:
    found = await documents.ask(document, hovered, document.positions.offset(params.position))
    return None if found is None else conversion.hover(document, found)


async def _code_actions(_: OpenDocuments, document: Document, params: types.CodeActionParams) -> list[types.CodeAction]:
    only = params.context.only
    if only is not None and not any(types.CodeActionKind.QuickFix.startswith(kind) for kind in only):
        return []
    return conversion.code_actions(document, params.range)


async def _symbols(documents: OpenDocuments, document: Document, _: Any) -> list[types.DocumentSymbol]:
    return conversion.symbols(document, (await documents.analysis(document))["outline"])


async def _fold(documents: OpenDocuments, document: Document, _: Any) -> list[types.FoldingRange]:
    return conversion.folding_ranges(document, (await documents.analysis(document))["folds"])


async def _hint(documents: OpenDocuments, document: Document, params: types.InlayHintParams) -> list[types.InlayHint]:
    return conversion.inlay_hints(document, (await documents.analysis(document))["brackets"], params.range)


async def _colour(documents: OpenDocuments, document: Document, _: Any) -> types.SemanticTokens:
    return conversion.semantic_tokens(document, (await documents.analysis(document))["tokens"])


async def _lens(documents: OpenDocuments, document: Document, _: Any) -> list[types.CodeLens]:
    return conversion.code_lenses(document, (await documents.analysis(document))["tests"])


async def _define(
    documents: OpenDocuments, document: Document, params: types.DefinitionParams
) -> types.Location | None:
    analysis = await documents.analysis(document)
    found = conversion.reference_at(analysis["references"], document.positions.offset(params.position))
    return None if found is None else conversion.location(document, found["target"])


async def _refer(documents: OpenDocuments, document: Document, params: types.ReferenceParams) -> list[types.Location]:
    """Return the references in all open documents to what is named at a place."""
    analysis = await documents.analysis(document)
    found = conversion.reference_at(analysis["references"], document.positions.offset(params.position))
    if found is None:
        return []
    target = conversion.location(document, found["target"])
    places: list[types.Location] = []
    for other in documents.all():
        for each in (await documents.analysis(other))["references"]:
            place = types.Location(other.uri, other.positions.range(each["start"], each["end"]))
            is_declaration = place == target
            if conversion.location(other, each["target"]) == target and not is_declaration:
                places.append(place)
    return [target, *places] if params.context.include_declaration else places


async def _prepare_rename(
    documents: OpenDocuments, document: Document, params: types.PrepareRenameParams
) -> types.PrepareRenamePlaceholder:
    found = await documents.ask(document, renamed, document.positions.offset(params.position))
    return types.PrepareRenamePlaceholder(document.positions.range(found["start"], found["end"]), found["words"])


async def _rename(documents: OpenDocuments, document: Document, params: types.RenameParams) -> types.WorkspaceEdit:
    at = document.positions.offset(params.position)
    found = await documents.ask(document, renamed, at, params.new_name)
    return conversion.workspace_edit(document, found["changes"])


async def _format(documents: OpenDocuments, document: Document, _: Any) -> list[types.TextEdit] | None:
    """Return the changes of the layout; None where the text has mistakes, which its messages say."""
    try:
        text = await documents.ask(document, layout)
    except MissionError:
        return None
    return conversion.formatting(document, text)


async def _draw(documents: OpenDocuments, params: Any) -> dict[str, Any]:
    return await documents.drawing(documents[params.textDocument.uri])


_FEATURES: tuple[tuple[str, Callable[..., Awaitable[Any]], Any], ...] = (
    (types.TEXT_DOCUMENT_COMPLETION, _complete, types.CompletionOptions(trigger_characters=_TRIGGERS)),
    (types.TEXT_DOCUMENT_HOVER, _hover, None),
    (
        types.TEXT_DOCUMENT_CODE_ACTION, _code_actions,
        types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix]),
    ),
    (types.TEXT_DOCUMENT_DOCUMENT_SYMBOL, _symbols, None),
    (types.TEXT_DOCUMENT_FOLDING_RANGE, _fold, None),
    (types.TEXT_DOCUMENT_INLAY_HINT, _hint, None),
    (types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, _colour, conversion.LEGEND),
    (types.TEXT_DOCUMENT_CODE_LENS, _lens, None),
    (types.TEXT_DOCUMENT_DEFINITION, _define, None),
    (types.TEXT_DOCUMENT_REFERENCES, _refer, None),
    (types.TEXT_DOCUMENT_PREPARE_RENAME, _prepare_rename, None),
    (types.TEXT_DOCUMENT_RENAME, _rename, types.RenameOptions(prepare_provider=True)),
    (types.TEXT_DOCUMENT_FORMATTING, _format, None),
)  # fmt: skip
