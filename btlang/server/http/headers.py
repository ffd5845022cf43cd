"""The heads of requests and answers: how long the first may be, and what browsers are told in the second."""

from __future__ import annotations

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from btlang.server.http.access import JsonResponse
from btlang.server.http.listener import MOST_HEAD

_HEADERS = {
    b"content-security-policy": b"default-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    b"x-frame-options": b"DENY",
    b"x-content-type-options": b"nosniff",
    b"referrer-policy": b"no-referrer",
    b"cross-origin-resource-policy": b"same-origin",
    b"cross-origin-opener-policy": b"same-origin",
    b"cache-control": b"no-store",
}


class Headers:
    """The middleware that adds headers to every answer, also to one that went wrong, and limits the head of a
    request.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def said(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = list(message.get("headers", ()))
                known = {name for name, _ in given}
                own = [(name, value) for name, value in _HEADERS.items() if name not in known]
                message = {**message, "headers": [*given, *own]}
            await send(message)

        head = [text for header in scope.get("headers", ()) for text in header]
        too_long = sum(map(len, head)) > MOST_HEAD  # the limit of h11 is for what comes in parts
        await (_too_long if too_long else self._app)(scope, receive, said)


async def _too_long(scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close"})
    else:
        text = "The head of this request is too long."
        await JsonResponse({"ok": False, "text": text, "code": ""}, 431)(scope, receive, send)
