"""Requests: who may make them (log-in, sessions, tokens), and JSON from outside within limits."""

from __future__ import annotations

import asyncio
import json
import time
from contextlib import suppress
from http.cookies import CookieError, SimpleCookie
from urllib.parse import urlsplit

from itsdangerous import BadSignature, Signer
from starlette.requests import ClientDisconnect, HTTPConnection, Request
from starlette.responses import Response

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.accounts import Accounts, Identity
from btlang.server.accounts.passwords import BusyError, Throttle, Verifier
from btlang.task.store.records import is_whole
from btlang.text.formatting import one_line
from btlang.text.json_text import load_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any


COOKIE = "__Host-btlang"
"""The name of the cookie. Its prefix makes browsers take it from this host over TLS alone, and send it nowhere else."""
CSRF = "x-csrf-token"
_KNOWN = 10.0  # seconds for which somebody who was looked up is known
_MOST_KNOWN = 2000


class AccessError(Exception):
    """A refusal: the HTTP status, a reason in words, and the seconds to wait before the next try."""

    def __init__(self, status: int, reason: str, wait: float = 0.0) -> None:
        super().__init__(reason)
        self.status, self.reason, self.wait = status, reason, wait


class Access:
    """The access of requests, decided by the accounts.

    `key` signs CSRF tokens. `cookie` is the name of the cookie of sessions.

    The disk is only touched in threads, and not for somebody who was here a moment ago: it may be slow, and everybody
    may stop the robot at any time.
    """

    def __init__(
        self, accounts: Accounts, key: str, cookie: str = COOKIE, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.accounts, self.cookie, self._clock = accounts, cookie, clock
        self._known: dict[str, tuple[Identity, float]] = {}
        self._verifier = Verifier()
        self._signer = Signer(key, salt="csrf")
        self._by_account, self._by_address, self._by_both = Throttle(clock), Throttle(clock), Throttle(clock)

    async def log_in(self, name: str, password: str, address: str) -> tuple[Identity, str]:
        """Log a user in; return who it is, and the secret for a cookie.

        Raises AccessError, an unknown user's after as long as others.
        """
        both = f"{address} {name}"
        wait = max(self._by_account.wait(name), self._by_address.wait(address))
        if wait:
            raise AccessError(429, f"Too many wrong passwords. Try again in {wait:.0f} s.", wait)
        user = await asyncio.to_thread(self.accounts.user, name) if name and is_whole(name) else None
        try:
            fits = await self._verifier.fits(password, None if user is None else user.password)
        except BusyError:
            raise AccessError(503, "Too many people log in at this moment.", 1.0) from None
        if not fits or user is None:
            self._by_account.wrong(name)
            self._by_address.wrong(address)
            self._by_both.wrong(both)
            await self.note(one_line(name)[:100], address, "log in", "wrong")
            raise AccessError(401, "The name or the password is wrong.")
        self._by_account.right(name)
        # what others got wrong at this address counts on: an account of one's own mustn't make guessing free
        self._by_address.forgive(address, self._by_both.right(both))
        secret = await asyncio.to_thread(self.accounts.log_in, user.name, address)
        await self.note(user.name, address, "log in", "ok")
        identity = await self._identity(secret)
        if identity is None:
            raise AccessError(401, "The name or the password is wrong.")
        return identity, secret

    async def note(self, user: str, address: str, what: str, outcome: str) -> None:
        """Add to the trail, as soon as the disk takes it."""
        with suppress(MissionError):
            await asyncio.to_thread(self.accounts.log, user, address, what, outcome)

    def forget(self) -> None:
        """Look everybody up again: something has changed."""
        self._known.clear()

    async def identify(self, headers: Mapping[str, str], *, changes: bool) -> Identity:
        """Identify who sends a request: by a token (Authorization: Bearer) or a cookie; with a cookie, what `changes`
        anything needs the CSRF token too. Raises AccessError (401, 403).
        """
        kind, _, token = headers.get("authorization", "").partition(" ")
        if kind:
            identity = await self._identity(token.strip()) if kind.casefold() == "bearer" else None
            if identity is None or identity.is_session:
                raise AccessError(401, "This token isn't valid.")
            return identity
        identity = await self._identity(_cookie(headers.get("cookie", ""), self.cookie))
        if identity is None or not identity.is_session:
            raise AccessError(401, "Log in first.")
        if changes and not (is_same_site(headers) and self._is_csrf(identity, headers.get(CSRF, ""))):
            raise AccessError(403, "This request doesn't come from the page of this server.")
        return identity

    async def by_token(self, token: str) -> Identity | None:
        """Return who brings a token, None for nobody."""
        identity = await self._identity(token)
        return None if identity is None or identity.is_session else identity

    def csrf(self, identity: Identity) -> str:
        """Return what a page sends with each request that changes something."""
        return self._signer.get_signature(identity.id).decode()

    def close(self) -> None:
        """End its threads."""
        self._verifier.close()

    async def _identity(self, secret: str) -> Identity | None:
        known = self._known.get(secret)
        if known is not None and self._clock() < known[1]:
            return known[0]
        found = await asyncio.to_thread(self.accounts.identity, secret) if secret and is_whole(secret) else None
        if len(self._known) >= _MOST_KNOWN:
            self._known.clear()
        if found is not None:
            self._known[secret] = found, self._clock() + _KNOWN
        return found

    def _is_csrf(self, identity: Identity, given: str) -> bool:
        try:
            return bool(self._signer.unsign(f"{identity.id}.{given}".encode()))
        except (BadSignature, UnicodeEncodeError):
            return False


def is_same_site(headers: Mapping[str, str]) -> bool:
    """Return whether a browser sent a request from a page of this host. Programs send no Origin."""
    origin = headers.get("origin")
    return origin is None or (origin != "null" and urlsplit(origin).netloc == headers.get("host"))


def address_of(connection: HTTPConnection) -> str:
    """Return where somebody is who sends a request, or has a socket."""
    return connection.client.host if connection.client is not None else ""


def _cookie(header: str, name: str) -> str:
    try:
        morsel = SimpleCookie(header).get(name)
    except CookieError:
        return ""
    return morsel.value if morsel is not None else ""


MOST_BYTES = 1_000_000
"""The limit of the body of a request."""
_PATIENCE = 15.0  # seconds for it


class JsonResponse(Response):
    """A response in ASCII: half a character of UTF-16, which a client may have sent, has no other encoding."""

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        return json.dumps(content, separators=(",", ":")).encode()


async def json_object(request: Request) -> dict[str, Any]:
    """Return the body, which has to be an object. Raises AccessError (400, 413, 415)."""
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
    """Read the JSON object of a request. Raises AccessError (400)."""
    try:
        data = load_json(text)
    except ValueError:
        raise AccessError(400, "That isn't JSON.") from None
    if not isinstance(data, dict):
        raise AccessError(400, "That isn't a JSON object.")
    return data


def text_in(data: dict[str, Any], name: str) -> str:
    """Return a field that has to be a text. Raises AccessError (400)."""
    value = data.get(name)
    if not isinstance(value, str):
        raise AccessError(400, f"'{name}' must be a text.")
    return value
