"""Requests of administrators: users, their tokens, and the trail of what people did."""

from __future__ import annotations

import asyncio
from functools import partial

from starlette.requests import Request
from starlette.responses import Response

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.accounts import Accounts, Identity, UserRole, check_account_name
from btlang.server.accounts.passwords import hash_password, random_password
from btlang.server.http.access import Access, AccessError, JsonResponse, address_of, cookie_in, json_object, text_in
from btlang.task.commands.checks import choose_member
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from typing import Any

    Route = tuple[str, str, Callable[[Request], Awaitable[Response]]]

_ENTRIES, MOST_ENTRIES = 100, 1000
"""The entries of the trail in an answer: by default, and at most."""
_LONGEST_FILTER = 200
_OF_OTHERS = ("role", "password", "logout", "remove")
_ACTS = {
    "add": "add the user '{name}' as {role}", "role": "give '{name}' the role {role}",
    "password": "set a new password for '{name}'", "logout": "log out '{name}' everywhere",
    "remove": "remove the user '{name}'", "token": "make the token '{token}' of '{name}'",
    "revoke": "revoke the token '{token}' of '{name}'",
}  # fmt: skip
"""What can be changed, as the trail describes it."""


class UserRequests:
    """Requests about users, for administrators alone.

    `identify` returns who sends a request. `look` sends away those who lost access.
    """

    def __init__(
        self,
        access: Access,
        identify: Callable[[Request], Awaitable[Identity]],
        look: Callable[[], Awaitable[None]],
    ) -> None:
        self._access, self._identify, self._look = access, identify, look

    def routes(self) -> list[Route]:
        """Return the method, the path and the function of each request."""
        return [
            ("GET", "/api/users", self._show),
            ("POST", "/api/users", self._change),
            ("GET", "/api/trail", self._trail),
            ("POST", "/api/confirm", self._confirm),
        ]

    async def _show(self, request: Request) -> Response:
        await self._administrator(request)
        return JsonResponse({"ok": True, "users": await asyncio.to_thread(_users, self._access.accounts)})

    async def _trail(self, request: Request) -> Response:
        await self._administrator(request)
        words, limit = request.query_params.get("filter", ""), request.query_params.get("limit", str(_ENTRIES))
        if len(words) > _LONGEST_FILTER:
            raise AccessError(400, f"'filter' must have at most {_LONGEST_FILTER} characters.")
        if not (limit.isascii() and limit.isdigit() and len(limit) < 5 and 1 <= int(limit) <= MOST_ENTRIES):
            raise AccessError(400, f"'limit' must be a number from 1 to {MOST_ENTRIES}.")
        find = partial(self._access.accounts.entries, only_failures=request.query_params.get("failures") == "true")
        entries = await asyncio.to_thread(find, int(limit), words)
        return JsonResponse({"ok": True, "entries": [entry.as_dict() for entry in entries]})

    async def _confirm(self, request: Request) -> Response:
        identity = await self._administrator(request)
        password = text_in(await json_object(request, identity.user), "password")
        device = cookie_in(request.headers, self._access.device_cookie)
        await self._access.confirm(identity, password, address_of(request), device)
        return JsonResponse({"ok": True})

    async def _change(self, request: Request) -> Response:
        identity = await self._administrator(request)
        data = await json_object(request, identity.user)
        if not identity.is_session:  # else a token that leaks would make accounts, which stay once it is revoked
            raise AccessError(403, "Programs can't change users: do it in the page, or with 'btc user'.")
        self._access.require_fresh(identity)
        act, name = text_in(data, "act"), text_in(data, "name")
        if act not in _ACTS:
            raise AccessError(400, f"'act' must be one of these: {', '.join(_ACTS)}.")
        if act in _OF_OTHERS and name == identity.user:
            raise AccessError(409, "Your own account can only be changed by another administrator, or with 'btc user'.")
        role = choose_member(UserRole, text_in(data, "role"), "role", act) if act in ("add", "role") else None
        token = text_in(data, "token") if act in ("token", "revoke") else ""
        what = one_line(_describe(act, name, role, token))
        try:
            made = await asyncio.to_thread(_change, self._access.accounts, act, name, role, token)
        except MissionError:
            await self._access.note(identity.user, address_of(request), what[:200], "refused")
            raise
        await self._access.note(identity.user, address_of(request), what, "ok")
        await self._look()
        return JsonResponse({"ok": True, **made})

    async def _administrator(self, request: Request) -> Identity:
        identity = await self._identify(request)
        if identity.role is not UserRole.ADMINISTRATOR:
            await self._access.note(identity.user, address_of(request), request.url.path, "refused")
            raise AccessError(403, f"Only {UserRole.ADMINISTRATOR}s may do this.")
        return identity


def _users(accounts: Accounts) -> list[dict[str, Any]]:
    return [
        {
            "name": user.name, "role": user.role.value, "created": user.created,
            "tokens": [
                {"name": token.name, "created": token.created, "used": token.used}
                for token in accounts.tokens(user.name)
            ],
        }
        for user in accounts.users()
    ]  # fmt: skip


def _change(accounts: Accounts, act: str, name: str, role: UserRole | None, token: str) -> dict[str, str]:
    """Do what an act of `btc user` does; return the secret that it makes. Raises MissionError."""
    password = random_password()
    if act == "add":
        assert role is not None
        check_account_name(name, act)
        accounts.add(name, role, hash_password(password))
        return {"password": password}
    if act == "password":
        accounts.set_password(name, hash_password(password))
        return {"password": password}
    if act == "token":
        check_account_name(token, act)
        return {"token": accounts.add_token(name, token)}
    if act == "role":
        assert role is not None
        accounts.set_role(name, role)
    elif act == "revoke":
        accounts.revoke(name, token)
    elif act == "logout":
        accounts.log_out(name)
    else:
        accounts.remove(name)
    return {}


def _describe(act: str, name: str, role: UserRole | None, token: str) -> str:
    """Describe a change for the trail."""
    return _ACTS[act].format(name=name, role=role, token=token)
