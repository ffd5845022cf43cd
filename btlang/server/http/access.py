"""Requests: who may make them (log-in, sessions, tokens), and JSON from outside within limits."""

from __future__ import annotations

import asyncio
import json
import time
from collections import Counter, OrderedDict
from contextlib import suppress
from http.cookies import CookieError, SimpleCookie
from math import inf
from urllib.parse import urlsplit

from itsdangerous import BadSignature, Signer
from starlette.requests import ClientDisconnect, HTTPConnection, Request
from starlette.responses import Response

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.accounts import Accounts, Identity, User
from btlang.server.accounts.passwords import BusyError, Throttle, Verifier
from btlang.server.accounts.signed import Devices, SignedSessions
from btlang.task.store.database import StoreError
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
UNREADABLE = "The server can't read or write its data: the disk may be full."
"""The text in place of that of a StoreError, which has paths."""
_KNOWN = 10.0  # seconds for which somebody who was looked up is known
_MOST_KNOWN = 2000
_MANY = 50  # wrong passwords of strangers for one account, from all addresses together, that cost nothing
_MOST_PAIRS = 10_000  # users with an address at which they have logged in


_FRESH = 300.0  # seconds for which a page that knew the password may change accounts
_MOST_FRESH = 2000
CONFIRM = "confirm"
"""The code of a refusal after which a page asks for the password again."""


class AccessError(Exception):
    """A refusal: the HTTP status, a reason in words, the seconds to wait before the next try, and a code for pages."""

    def __init__(self, status: int, reason: str, wait: float = 0.0, code: str = "") -> None:
        super().__init__(reason)
        self.status, self.reason, self.wait, self.code = status, reason, wait, code


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
        self.device_cookie = f"{cookie}-device"
        """The name of the cookie of browsers in which somebody has logged in."""
        self._known: dict[str, tuple[Identity, float]] = {}
        self._fresh: OrderedDict[str, float] = OrderedDict()  # until when, by the ids of sessions
        self._strangers, self._friends = Verifier(), Verifier(1)
        self._signer, self._signed, self._devices = Signer(key, salt="csrf"), SignedSessions(key), Devices(key)
        self._pairs = OrderedDict.fromkeys(accounts.addresses())
        self._by_account, self._by_address, self._own = Throttle(clock, _MANY), Throttle(clock), Throttle(clock)

    async def log_in(self, name: str, password: str, address: str, device: str = "") -> tuple[Identity, str]:
        """Log a user in; return who it is, and the secret for a cookie. `device` is the cookie of the browser.

        Raises AccessError, see `_verify`.
        """
        user = await self._verify(name, password, address, device, "log in")
        self._pairs[name, address] = None
        if len(self._pairs) > _MOST_PAIRS:
            self._pairs.popitem(last=False)
        try:
            secret = await asyncio.to_thread(self.accounts.log_in, user.name, address)
        except StoreError:  # the disk is full: nobody may be kept from stopping a robot
            secret = self._signed.begin(user)
        await self.note(user.name, address, "log in", "ok")
        identity = await self._identity(secret)
        if identity is None:
            raise AccessError(401, "The name or the password is wrong.")
        self._make_fresh(identity)
        return identity, secret

    async def confirm(self, identity: Identity, password: str, address: str, device: str = "") -> None:
        """Let a session change accounts for some minutes, if the password is right. Raises as `log_in` does."""
        await self._verify(identity.user, password, address, device, "confirm the password")
        self._make_fresh(identity)

    def require_fresh(self, identity: Identity) -> None:
        """Raise AccessError (403) unless the password was given in this session some minutes ago at most."""
        if self._clock() > self._fresh.get(identity.id, -inf):
            raise AccessError(403, "Confirm your password first.", code=CONFIRM)

    def _make_fresh(self, identity: Identity) -> None:
        self._fresh[identity.id] = self._clock() + _FRESH
        self._fresh.move_to_end(identity.id)
        if len(self._fresh) > _MOST_FRESH:
            self._fresh.popitem(last=False)

    async def _verify(self, name: str, password: str, address: str, device: str, what: str) -> User:
        """Return the user of a name and a password; `what` is what the trail says of a wrong one.

        What somebody gets wrong keeps out those alone who can't be told from them: a browser in which the user has
        logged in before has a count of its own, and so has an address. Raises AccessError, an unknown user's after as
        long as others.
        """
        number = self._devices.number(device, name)
        is_friend = bool(number) or (name, address) in self._pairs
        own = (self._own, f"{number or address} {name}")
        counts = [own] if is_friend else [own, (self._by_address, address), (self._by_account, name)]
        wait = max(throttle.wait(key) for throttle, key in counts)
        if wait:
            raise AccessError(429, f"Too many wrong passwords. Try again in {wait:.0f} s.", wait)
        for throttle, key in counts:  # before it is known: else as many guesses are free as come at once
            throttle.wrong(key)
        user = await asyncio.to_thread(self.accounts.user, name) if name and is_whole(name) else None
        try:
            verifier = self._friends if is_friend else self._strangers
            fits = await verifier.fits(password, None if user is None else user.password)
        except BusyError:
            for throttle, key in counts:
                throttle.forgive(key, 1)
            raise AccessError(503, "Too many people log in at this moment.", 1.0) from None
        if not fits or user is None:
            await self.note(one_line(name)[:100], address, what, "wrong")
            raise AccessError(401, "The name or the password is wrong.")
        # what others got wrong at this address counts on: an account of one's own mustn't make guessing free
        wrong = self._own.right(own[1])
        for throttle, key in counts[1:]:
            throttle.forgive(key, wrong)
        return user

    def device(self, cookie: str, user: str) -> str:
        """Return the cookie of a browser in which a user has logged in."""
        return self._devices.add(cookie, user)

    async def note(self, user: str, address: str, what: str, outcome: str) -> None:
        """Add to the trail, as soon as the disk takes it."""
        with suppress(MissionError):
            await asyncio.to_thread(self.accounts.log, user, address, what, outcome)

    async def still(self, identity: Identity) -> Identity:
        """Return the same identity as it is now. Raises AccessError (401) if it was revoked."""
        now = await asyncio.to_thread(self.accounts.still, identity)
        if now is None:
            raise AccessError(401, "Log in again: this access was revoked.")
        return now

    async def identify(self, headers: Mapping[str, str], *, changes: bool, scheme: str = "http") -> Identity:
        """Identify who sends a request: by a token (Authorization: Bearer) or a cookie; with a cookie, what `changes`
        anything needs the CSRF token too, and a page of the same host. Raises AccessError (401, 403).

        Who was here a moment ago isn't looked up again: `still` does that.
        """
        kind, _, token = headers.get("authorization", "").partition(" ")
        if kind:
            identity = await self._identity(token.strip()) if kind.casefold() == "bearer" else None
            if identity is None or identity.is_session:
                raise AccessError(401, "This token isn't valid.")
            return identity
        identity = await self._identity(cookie_in(headers, self.cookie))
        if identity is None or not identity.is_session:
            raise AccessError(401, "Log in first.")
        if changes and not (is_same_site(headers, scheme) and self._is_csrf(identity, headers.get(CSRF, ""))):
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
        self._strangers.close()
        self._friends.close()

    async def _identity(self, secret: str) -> Identity | None:
        known = self._known.get(secret)
        if known is not None and self._clock() < known[1]:
            return known[0]
        found = await asyncio.to_thread(self._look_up, secret) if secret and is_whole(secret) else None
        if len(self._known) >= _MOST_KNOWN:
            self._known.clear()
        if found is not None:
            self._known[secret] = found, self._clock() + _KNOWN
        return found

    def _look_up(self, secret: str) -> Identity | None:
        return self._signed.identity(secret, self.accounts) or self.accounts.identity(secret)

    def _is_csrf(self, identity: Identity, given: str) -> bool:
        try:
            return bool(self._signer.unsign(f"{identity.id}.{given}".encode()))
        except (BadSignature, UnicodeEncodeError):
            return False


def is_same_site(headers: Mapping[str, str], scheme: str = "http") -> bool:
    """Return whether a browser sent a request from a page of this host. Programs send no Origin.

    With the `scheme` of a request over TLS, the page has to have come over TLS, too: others may have written one that
    hasn't. Without TLS, a proxy may have ended it.
    """
    origin = headers.get("origin")
    if origin is None:
        return True
    kind, _, place = origin.partition("://")
    is_safe = kind == "https" or scheme not in ("https", "wss")
    return bool(place) and place == headers.get("host") and is_safe


def host_of(place: str) -> str:
    """Return the host in an origin or in the head of a request, "" for none."""
    try:
        return urlsplit(place if "://" in place else f"//{place}").hostname or ""
    except ValueError:
        return ""


def admit(connection: HTTPConnection, user: str) -> None:
    """Count a connection as one of a user who has logged in. Raises AccessError (429) if the user has too many."""
    known = connection.scope.get("state", {}).get("connection")
    if known is not None and not known.admit(user):
        raise AccessError(429, "You have too many connections.", 1.0)


def address_of(connection: HTTPConnection) -> str:
    """Return where somebody is who sends a request, or has a socket."""
    return connection.client.host if connection.client is not None else ""


def cookie_in(headers: Mapping[str, str], name: str) -> str:
    """Return the cookie of a name, "" for none."""
    try:
        morsel = SimpleCookie(headers.get("cookie", "")).get(name)
    except CookieError:
        return ""
    return morsel.value if morsel is not None else ""


MOST_BYTES = 1_000_000
"""The limit of the body of a request."""
SMALL = 131_072
"""The bytes of a body that anybody may send."""
_MOST_LARGE = 8  # bodies that are larger, of one user at a time
_PATIENCE = 15.0  # seconds for it


class JsonResponse(Response):
    """A response in ASCII: half a character of UTF-16, which a client may have sent, has no other encoding."""

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        return json.dumps(content, separators=(",", ":")).encode()


_large: Counter[str] = Counter()  # bodies that are on their way, by user


async def json_object(request: Request, user: str = "") -> dict[str, Any]:
    """Return the body, which has to be an object; that of a stranger, without a `user`, has to be small.

    Raises AccessError (400, 408, 413, 415, 429).
    """
    if request.headers.get("content-encoding", "identity") != "identity":  # a few bytes may become gigabytes
        raise AccessError(415, "The body must not be compressed.")
    if request.headers.get("content-type", "").partition(";")[0].strip().casefold() != "application/json":
        raise AccessError(415, "The body must be application/json.")  # which no form of another site can send
    is_large = False

    def hold(size: int) -> None:
        nonlocal is_large
        if size > SMALL and not is_large:
            if _large[user] >= _MOST_LARGE:
                raise AccessError(429, "You send too much at once.", 1.0)
            _large[user] += 1
            is_large = True

    try:
        body = await read_body(request, MOST_BYTES if user else SMALL, _PATIENCE, hold)
    finally:
        if is_large:
            _large[user] -= 1
            if not _large[user]:
                del _large[user]
    return read_object(body)


async def read_body(
    request: Request, most: int, patience: float, hold: Callable[[int], object] = lambda size: None
) -> bytes:
    """Return the body, of at most so many bytes, which has to be there within some seconds.

    `hold` is called with the size so far, and may refuse it. Raises AccessError (400, 408, 413).
    """
    body = bytearray()
    try:
        async with asyncio.timeout(patience):
            async for part in request.stream():
                body += part
                if len(body) > most:
                    raise AccessError(413, f"The body must have at most {most:,} bytes.")
                hold(len(body))
    except TimeoutError:
        raise AccessError(408, "The body takes too long.") from None
    except ClientDisconnect:
        raise AccessError(400, "The body isn't complete.") from None
    return bytes(body)


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
