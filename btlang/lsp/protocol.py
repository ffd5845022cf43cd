"""The protocol as pygls speaks it, with our own documents, UTF-16 alone, and an answer to each broken request."""

from __future__ import annotations

import os
from collections.abc import Awaitable, Callable
from functools import wraps
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInternalError, JsonRpcInvalidParams
from pygls.protocol import LanguageServerProtocol
from pygls.protocol.language_server import lsp_method

from btlang.diagnostics.diagnostic import MissionError
from btlang.support.worker import WorkerEnded


class RequestFailed(JsonRpcException):
    """The error of a request that is correct, but can't be done: a text has mistakes, for example."""

    CODE = types.LSPErrorCodes.RequestFailed
    MESSAGE = "The request failed"


class ContentModified(JsonRpcException):
    """The error of a request about a text that has changed meanwhile: its places would be wrong."""

    CODE = types.LSPErrorCodes.ContentModified
    MESSAGE = "The text has changed"


def answering(handler: Callable[..., Awaitable[Any]]) -> Callable[..., Awaitable[Any]]:
    """Make errors of a handler answers in one line, without a traceback."""

    @wraps(handler)
    async def answer(*given: Any) -> Any:
        try:
            return await handler(*given)
        except MissionError as error:
            problem = next((each for each in error.diagnostics if each.is_error), error.diagnostics[0])
            raise RequestFailed(problem.message) from None
        except WorkerEnded:
            raise RequestFailed("This text takes too long to read.") from None
        except JsonRpcException:
            raise
        except Exception as error:
            if os.environ.get("BTC_DEBUG"):
                raise
            raise JsonRpcInternalError(f"A bug in btlang: {type(error).__name__}: {error}") from None

    return answer


class Protocol(LanguageServerProtocol):
    """The protocol of our server, which keeps documents itself: pygls splits lines where the protocol doesn't."""

    _server: Any

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Return the message; None for one that is answered here because it is malformed."""
        try:
            return super().structure_message(data)
        except JsonRpcException:
            if "id" in data and "method" in data:
                error = JsonRpcInvalidParams(f"The parameters of {data['method']} are malformed")
                self._send_response(data["id"], error=error.to_response_error())
                return None
            if "method" in data:
                return None  # a notification has no answer
            raise

    def handle_message(self, message: Any) -> None:
        """Handle a message; positions are in UTF-16 units, whatever else a client offers."""
        if message is None:
            return
        if getattr(message, "method", "") == types.INITIALIZE and message.params.capabilities.general is not None:
            message.params.capabilities.general.position_encodings = None
        super().handle_message(message)

    @lsp_method(types.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(self, params: types.DidOpenTextDocumentParams) -> None:
        """Open a document."""
        self._server.documents.open(params.text_document)

    @lsp_method(types.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(self, params: types.DidChangeTextDocumentParams) -> None:
        """Change an open document."""
        self._server.documents.change(params.text_document, params.content_changes)

    @lsp_method(types.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(self, params: types.DidCloseTextDocumentParams) -> None:
        """Close a document."""
        self._server.documents.close(params.text_document.uri)
