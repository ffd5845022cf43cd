"""JSON from outside: how much of it is read, and what is refused; and answers in JSON."""

from __future__ import annotations

import asyncio
import json

from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response

from btlang.server.access import AccessError
from btlang.text.json_text import load_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST_BYTES = 1_000_000
"""Of the body of a request."""
_PATIENCE = 15.0  # seconds for it


class JsonResponse(Response):
    """In ASCII: half a character of UTF-16, which a client may have sent, has no other encoding."""

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        return json.dumps(content, separators=(",", ":")).encode()


async def json_object(request: Request) -> dict[str, Any]:
    """The body, which has to be an object. Raises AccessError (400, 413, 415)."""
    if request.headers.get("content-encoding", "identity") != "identity":  # a few bytes may become gigabytes
        raise AccessError(415, "The body must not be compressed.")
    if request.headers.get("content-type", "").partition(";")[0].strip().casefold() != "application/json":
        raise AccessError(415, "The body must be application/json.")  # which no form of another site can send
    body = bytearray()
    try:
        async with asyncio.timeout(_PATIENCE):
            async for part in request.stream():
                body += part
                if len(body) > MOST_BYTES:
                    raise AccessError(413, f"The body must have at most {MOST_BYTES:,} bytes.")
    except TimeoutError:
        raise AccessError(408, "The body takes too long.") from None
    except ClientDisconnect:
        raise AccessError(400, "The body isn't complete.") from None
    return read_object(bytes(body))


def read_object(text: bytes | str) -> dict[str, Any]:
    """Raises AccessError (400)."""
    try:
        data = load_json(text)
    except ValueError:
        raise AccessError(400, "That isn't JSON.") from None
    if not isinstance(data, dict):
        raise AccessError(400, "That isn't a JSON object.")
    return data


def text_in(data: dict[str, Any], name: str) -> str:
    """A field that has to be a text. Raises AccessError (400)."""
    value = data.get(name)
    if not isinstance(value, str):
        raise AccessError(400, f"'{name}' must be a text.")
    return value
